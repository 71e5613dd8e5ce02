// Every option of every command, in one table: name, unit, range, default, help, and how it sets a field of Settings.
// The command line and the [bake] table of a cloud's TOML file read the same table.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bake/mesh/repair.h"
#include "core/types.h"
#include "io/gltf/gltf.h"
#include "io/file/manifest.h"
#include "io/sculpt/read_mesh.h"
#include "io/volume/vdb.h"

namespace cloudbake {

/// A length: world units, or a share of the longest side of the shape ("2.5%").
struct Length {
  float value = 0;
  bool relative = false;  ///< value is a fraction of the longest side
  float resolve(float longest_side) const { return relative ? value * longest_side : value; }
};

/// The picture that `preview` draws.
struct ViewSettings {
  float sun_azimuth_degrees = 105, sun_elevation_degrees = 30;
  float camera_azimuth_degrees = 0, camera_elevation_degrees = 6;
  float field_of_view_degrees = 35;
  int width = 960, height = 640;
  float exposure = 1;
  bool plain = false;        ///< the lobe formula alone; else the published image chain
  double time_seconds = 0;   ///< of the chain's swirls
  std::optional<std::filesystem::path> channels, steps;
  bool lobes_only = false;   ///< not by spherical harmonics, where the asset has them
  bool draft = false;        ///< scenes: at less cost
  bool compare = false;      ///< a sheet beside the truth in place of a picture
  int suns = 0;              ///< with `compare`: figures for so many suns
  enum class Motion { kNone, kTurntable, kSunSweep, kAnimate } motion = Motion::kNone;
  int frame_count = 0;       ///< of the motion
  double frames_per_second = 12;
  std::optional<std::filesystem::path> frames;
};

/// What the sweep integrates: by itself coverage where the mesh is closed.
enum class FieldChoice { kAuto, kCoverage, kLevelSet };

/// What gives a mesh its volume: itself where it is closed, else what closes it; always a wrap; or nothing else than itself.
enum class CloseChoice { kAuto, kWrap, kReject };

/// An error that a bake is to keep, against exact chords.
struct TargetError {
  double value = 0;               ///< degrees, or a share of 1
  bool is_transmittance = false;  ///< rms of the lobe's T against that of the exact lobe; else rms angle of the direction
};

/// What is asked of a whole batch.
struct BatchSettings {
  std::vector<std::filesystem::path> inputs;        ///< the manifest or the folder; with `merge`, reports
  std::optional<std::filesystem::path> input_list;  ///< sculpts, a path per line; "-": from stdin
  std::optional<std::string> name;                  ///< template of the outputs' names
  std::optional<std::filesystem::path> cache, junit, html, depfile, depfile_target;
  std::optional<uint64_t> memory;  ///< bytes that the running assets may take together; unset: three quarters of the machine's
  bool fail_fast = false, force = false, prune = false, init = false, merge = false;
  int shard = 0, shards = 0;  ///< 1-based; 0: all
};

/// Errors against exact chords that an asset may have.
struct ErrorBounds {
  std::optional<double> angle_degrees, transmittance_rms;  ///< rms of the direction, rms of the lobe's T
  bool any() const { return angle_degrees || transmittance_rms; }
};

struct Settings {
  // integration field and surface
  std::optional<int> voxels;  // unset: 100
  std::optional<float> voxel_size;
  std::optional<int> bake_voxels;  // unset: as the surface's
  FieldChoice field = FieldChoice::kAuto;
  Length blend;
  std::optional<float> flat_base;
  std::optional<Length> noise;
  std::optional<Length> noise_size;  // unset: half as much again as bumps need to hang on
  int noise_octaves = 3;
  std::optional<size_t> vertices;
  std::optional<Length> remesh;  // edge length
  // what becomes of a sculpt
  RepairSettings repair;
  bool repair_remesh = false;  // with the sculpt's own mean edge length, unless `remesh` says another
  CloseChoice close = CloseChoice::kAuto;
  bool separate = false, inspect = false;
  // bake
  BakeSettings bake;  // method, sampler, quadrature and steps as resolveMethod sets them from what was given
  std::optional<Method> method;
  std::optional<Sampler> sampler;
  std::optional<Quadrature> quadrature;
  std::optional<int> rays, steps;
  std::optional<TargetError> target_error;
  std::optional<std::filesystem::path> scene;  // of bakes: what an error is chosen for; of preview: what is drawn
  std::optional<SceneView> scene_view;  // of a manifest; `scene` goes before it
  // lobe
  bool fit = false, fit_exponent = false, fit_bias = false;
  std::optional<float> exponent;                            // unset: 3; of a fit: 4
  std::optional<Length> bias;                               // unset: −0.3 % of the longest side; of a fit: 0
  std::optional<std::pair<float, float>> extinction_range;  // unset: 7 / longest side; of a fit: half to double
  std::optional<SunArc> sun_arc;
  int harmonic_order = 0;  // --basis; 0: lobes alone
  std::optional<std::filesystem::path> lattice;
  int lattice_cells = 16;  // along the longest side
  int smooth = 0;  // passes over the mesh, after bake and fit
  // what goes in and out
  std::filesystem::path input, output;
  ReadSettings read;
  VdbSettings volume;
  GltfSettings gltf;
  std::optional<std::filesystem::path> rules, from_spheres, spheres, vdb, json;
  std::vector<std::pair<std::string, std::string>> recipe_keys;  // key and value, over what the recipe says
  bool explain = false, dry_run = false;
  ViewSettings view;
  BatchSettings batch;
  ErrorBounds bounds;
  std::optional<std::filesystem::path> against;  // check: the asset before another program
  std::optional<size_t> truth_vertices;          // unset: 2000, or 200 where the truth is a march, in a batch and in a check
  int threads = 0;                               // 0: all
  bool strict = false, quiet = false;
};

/// Commands that an option belongs to, as bits.
enum Command : unsigned { kGrow = 1, kBake = 2, kPreview = 4, kMeasure = 8, kBatch = 16, kCheck = 32 };

struct Option {
  const char* name;      ///< long name without dashes; in TOML with _ for -
  const char* unit;      ///< placeholder in the help, empty for a flag
  const char* fallback;  ///< default as text, empty where there is none
  const char* help;
  unsigned commands;
  bool in_toml;                                                                     ///< may stand in a [bake] table
  void (*set)(Settings& settings, const Option& option, const std::string& value);  ///< throws UsageError
  const char* group = "Options";                                                    ///< heading in the help
};

/// What a cloud is made from, as far as options care.
enum class InputKind { kGrown, kSpheres, kSculpt, kVolume };

/// The option of that name, with _ or -, if it is one of a single asset: what a manifest may set. Else nothing.
const Option* findAssetOption(std::string_view name);
/// Whether an asset option means something to clouds of a kind: --blend does not to a sculpt, --voxels not to a VDB.
bool suits(const Option& option, InputKind kind);

/// Whether the name ends in .vdb, in any case.
bool isVdbFile(const std::filesystem::path& file);

/// The table, in the order of the help.
std::span<const Option> optionTable();

/// The values of an option that takes one of a few names, for completion; empty for numbers, files, free text and flags.
std::vector<std::string> optionChoices(const Option& option);

/// Fills `settings.bake` and checks that the options go together. Throws UsageError: an option of rays with a sweep, an odd N, a fit's
/// option without a fit, a setting that --target-error chooses itself.
void resolveMethod(Settings& settings);

/// Sets an option from a [bake] table. Throws InputError naming file and line: an unknown key, or a value out of range.
void setFromToml(Settings& settings, std::string_view key, const std::string& value, const std::string& file, int line);

}  // namespace cloudbake
