// The unit and the axes of a file that another program's library reads.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/affine.h"
#include "io/file/read_settings.h"
#include "io/sculpt/fbx_models.h"

namespace cloudbake {

/// What a file says about its frame, or what is assumed. Axes: 0 x, 1 y, 2 z.
struct FileFrame {
  double metres_per_unit = 1;
  std::string unit_name = "metres";  ///< of the unit, if it is assumed
  bool says_unit = false, says_axes = false;
  int right = 0, up = 1;
  double right_sign = 1, up_sign = 1;
  bool is_left_handed = false;  ///< the third axis, towards the viewer, is the opposite one

  /// From the file's frame to metres, +Y up, right-handed.
  Affine toScene() const;
  /// The settings without the unit and the axis that this file keeps as it states them (frame_if_unstated).
  ReadSettings wanted(const ReadSettings& settings) const;
  /// Unit and axis of the settings take the place of the file's.
  FileFrame replacedBy(const ReadSettings& settings) const;
  /// For the report.
  std::string text(const ReadSettings& settings) const;
};

/// The frame that an FBX states in its GlobalSettings; centimetres and +Y up where it does not. Throws InputError if it is no frame.
FileFrame frameOfFbx(const std::filesystem::path& file, const FbxProperties& settings);

/// The frame of a Collada scene, of which `root` is the map that assimp 5.2 has put above it. Throws InputError if it is none.
FileFrame frameOfCollada(const std::filesystem::path& file, const Affine& root);

/// 3MF Core Specification 1.3, 3.4 and 3.1: a unit, else millimetres; +Z up. `model` is the XML. Throws InputError.
FileFrame frameOf3mf(const std::filesystem::path& file, std::string_view model);

/// ISO/ASTM 52915: a unit, else millimetres. It says nothing of an axis. Throws InputError.
FileFrame frameOfAmf(const std::filesystem::path& file, std::string_view xml);

}  // namespace cloudbake
