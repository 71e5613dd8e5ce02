// The files that one asset is made of, each read once.
#pragma once

#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "io/file/write_file.h"

namespace cloudbake {

/// What is wrong with a file that was found with other bytes, or not at all, after it had been read. The cure is to run again.
Error changedWhileRead(const std::filesystem::path& file);

/// Reads files, so that the hash of an input and what is made of it come from the same bytes, even if somebody saves the file meanwhile.
/// First read() is called for all files that the asset's key covers. Then seal() is called, and the readers of the asset call read().
/// Several threads may call it.
class InputFiles {
 public:
  /// `keeps_bytes`: if not, only hashes are kept before seal(), for inputs of many files. Each is then read twice.
  explicit InputFiles(FileReader reader, bool keeps_bytes = true) : reader_(std::move(reader)), keeps_bytes_(keeps_bytes) {}

  /// The bytes of a file. Before seal(), they are read at the first call and kept. Afterwards they are given away; a file that is asked for
  /// once more is read again, and must have the same bytes. A file that could not be read stays so. Throws what the reader threw, and
  /// changedWhileRead.
  std::string read(const std::filesystem::path& file);
  void seal() { is_sealed_ = true; }
  /// The files whose bytes were read for the first time after seal().
  std::vector<std::filesystem::path> late() const;

 private:
  struct Seen {
    std::string hash;
    std::optional<std::string> bytes;
    std::exception_ptr error = nullptr;
    bool is_late = false;
  };
  FileReader reader_;
  mutable std::mutex mutex_;
  std::map<std::filesystem::path, Seen> seen_;
  bool keeps_bytes_, is_sealed_ = false;
};

}  // namespace cloudbake
