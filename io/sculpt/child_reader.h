// Sculpts in formats that a third-party library reads, read in a process of their own: a file that makes the library crash, hang or
// swallow all memory costs that process, and the caller an InputError.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "io/sculpt/read_mesh.h"

namespace cloudbake {

/// First argument of the child; `serveChildReader` takes the rest of its command line.
constexpr const char* kChildReaderCommand = "read-foreign-sculpt";

struct ChildLimits {
  double seconds = 120;           ///< of the clock, and of the processor
  uint64_t memory = 6ULL << 30;   ///< bytes of address space of the child
  uint64_t largest = 6ULL << 30;  ///< bytes of its answer
};

/// Runs `program read-foreign-sculpt …` and returns what readWithAssimp gave there; its warnings are added. Throws what it threw, and
/// InputError where the child crashed, took too long or answered nonsense, IoError where it could not be started.
Sculpt readInChild(const std::filesystem::path& program, const std::filesystem::path& file, const std::string& extension,
                   const ReadSettings& settings, Warnings& warnings, const ChildLimits& limits = {});

/// The child's side, with the command as argv[0]: reads, writes the answer to file descriptor 3, returns the exit code.
int serveChildReader(int argc, char** argv);

}  // namespace cloudbake
