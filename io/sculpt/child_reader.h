// Reads sculpts in formats of a third-party library in a child process. If a file makes the library crash, hang or use up all memory, only
// that process is lost, and the caller gets an InputError.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "io/sculpt/read_mesh.h"

namespace cloudbake {

/// First argument of the child. `serveChildReader` reads the rest of its command line.
constexpr const char* kChildReaderCommand = "read-foreign-sculpt";

/// At most two thirds of the memory are for the child, because its answer, which is there twice when it is read, is at most half of it.
struct ChildLimits {
  explicit ChildLimits(uint64_t all) : memory(all / 3 * 2), largest(all / 3) {}
  double seconds = 120;  ///< limit of elapsed time and of processor time
  uint64_t memory;       ///< limit of the child's data, bytes
  uint64_t largest;      ///< limit of its answer, bytes
};

/// Runs `program read-foreign-sculpt …` and returns the result of readWithAssimp in the child, adding its warnings. Throws what
/// readWithAssimp threw, MemoryError if the child would need more than the limits, InputError if it crashed, was killed, took too long or
/// gave an invalid answer, IoError if it could not be started, and changedWhileRead if the child has read another file, such as a texture,
/// with other bytes than settings.read_file gives.
Sculpt readInChild(const std::filesystem::path& file, const std::string& bytes, const std::string& extension, const ReadSettings& settings,
                   Warnings& warnings, const ChildLimits& limits);

/// The child's side, with the command as argv[0]. It takes the bytes of the sculpt from file descriptor 4, writes the answer to descriptor
/// 3 and returns the exit code.
int serveChildReader(int argc, char** argv);

}  // namespace cloudbake
