// How files of sculpts are read.
#pragma once

#include <filesystem>
#include <optional>

namespace cloudbake {

enum class UpAxis { kX, kY, kZ };

/// For files that say nothing, or the wrong thing, about their frame. glTF's frame is fixed: setting one is an error there.
struct ReadSettings {
  std::optional<double> metres_per_unit;  ///< > 0; unset: as the file says, else 1
  std::optional<UpAxis> up_axis;          ///< unset: as the file says, else +Y
  bool allow_outside = false;             ///< a file may name others outside its own folder
  /// A program whose main hands `kChildReaderCommand` to serveChildReader (io/sculpt/child_reader.h): formats that assimp reads are read in
  /// a process of it. Empty: in this one.
  std::filesystem::path child_program{};
};

}  // namespace cloudbake
