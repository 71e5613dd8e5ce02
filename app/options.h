// Every option of every command, in one table: name, unit, range, default, help, and how it sets a field of Settings.
// The command line and the [bake] table of a cloud's TOML file read the same table.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/types.h"
#include "io/gltf.h"
#include "io/read_mesh.h"

namespace cloudbake {

/// A length: world units, or a share of the longest side of the shape ("2.5%").
struct Length {
  float value = 0;
  bool relative = false;  ///< value is a fraction of the longest side
  float resolve(float longest_side) const { return relative ? value * longest_side : value; }
};

/// Overrides of a cloud recipe; unset: as the recipe says.
struct GrowOverrides {
  std::optional<double> generations, step, step_scale, angle, angle_scale, thickness, thickness_scale, gravity;
};

/// The picture that `preview` draws.
struct ViewSettings {
  float sun_azimuth_degrees = 105, sun_elevation_degrees = 30;
  float camera_azimuth_degrees = 0, camera_elevation_degrees = 6;
  float field_of_view_degrees = 35;
  int width = 960, height = 640;
  float exposure = 1;
};

struct Settings {
  // integration field and surface
  int voxels = 100;
  std::optional<float> voxel_size;
  Length blend;
  std::optional<float> flat_base;
  std::optional<size_t> vertices;
  // bake
  BakeSettings bake;
  std::optional<float> exponent;    // unset: 3
  std::optional<Length> bias;       // unset: −0.3 % of the longest side
  std::optional<float> extinction;  // unset: 7 / longest side
  // what goes in and out
  std::filesystem::path input, output;
  ReadSettings read;
  GltfSettings gltf;
  std::optional<std::filesystem::path> rules, json;
  GrowOverrides grow;
  ViewSettings view;
  std::optional<size_t> truth_vertices;  // unset: 2000, or 200 where the truth is a march
  int threads = 0;                       // 0: all
  bool strict = false, quiet = false;
};

/// Commands that an option belongs to, as bits.
enum Command : unsigned { kGrow = 1, kBake = 2, kPreview = 4, kMeasure = 8 };

struct Option {
  const char* name;      ///< long name without dashes; in TOML with _ for -
  const char* unit;      ///< placeholder in the help, empty for a flag
  const char* fallback;  ///< default as text, empty where there is none
  const char* help;
  unsigned commands;
  bool in_toml;                                                                     ///< may stand in a [bake] table
  void (*set)(Settings& settings, const Option& option, const std::string& value);  ///< throws UsageError
};

/// The table, in the order of the help.
std::span<const Option> optionTable();

/// Sets an option from a [bake] table. Throws InputError naming file and line: an unknown key, or a value out of range.
void setFromToml(Settings& settings, std::string_view key, const std::string& value, const std::string& file, int line);

}  // namespace cloudbake
