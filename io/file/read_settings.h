// Settings for reading sculpt files.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/memory_budget.h"
#include "io/file/write_file.h"

namespace cloudbake {

enum class UpAxis { kX, kY, kZ };

/// The turn that takes the up axis of a file to +Y, row by row.
constexpr std::array<std::array<int, 3>, 3> turnOf(UpAxis up) {
  if (up == UpAxis::kX) return {{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}};
  if (up == UpAxis::kZ) return {{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}}};
  return {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}

/// A moment of an animation.
struct AnimationMoment {
  std::string animation;  ///< its name; empty: the first one of the file
  double seconds = 0;     ///< since its first key
};

/// The frame is for files that state none or a wrong one. glTF's frame is fixed, so setting it for a glTF is an error, unless it is for the
/// files of a mixed folder that state none.
struct ReadSettings {
  std::optional<double> metres_per_unit{};  ///< > 0; unset = as stated in the file, else 1
  std::optional<UpAxis> up_axis{};          ///< unset = as stated in the file, else +Y
  bool frame_if_unstated = false;           ///< a unit or an axis that the file states is kept
  bool allow_outside = false;               ///< a file may refer to files outside its own folder
  std::optional<int> scene_index{};         ///< glTF: the scene to bake, ≥ 0; unset = the file's default scene
  std::optional<AnimationMoment> moment{};  ///< glTF, FBX: the pose of the sculpt; unset = as the file has it without an animation
  uint64_t memory_limit = kMemoryLimit;     ///< bytes; an estimate above this is an error
  /// A program whose main passes `kChildReaderCommand` to serveChildReader (io/sculpt/child_reader.h). Formats read by assimp are then read
  /// in a child process of this program. Empty: they are read in this process.
  std::filesystem::path child_program{};
  FileReader read_file = readFileBytes;  ///< reads the input and the files that it refers to
};

}  // namespace cloudbake
