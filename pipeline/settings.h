// The settings of a run: one struct per consumer, made once by resolve (pipeline/resolve.h) and const from then on. What a run finds out
// about a shape (L, k, b, σ, the voxels chosen) goes into its results (pipeline/parameters.h, io/report/report.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bake/mesh/repair.h"
#include "core/types.h"
#include "io/file/read_settings.h"
#include "io/gltf/gltf.h"
#include "io/volume/vdb.h"

namespace cloudbake {

/// A length: world units, or a share of the longest side of the shape ("2.5%").
struct Length {
  float value = 0;
  bool relative = false;  ///< value is a fraction of the longest side
  float resolve(float longest_side) const { return relative ? value * longest_side : value; }
};

/// What a cloud is made from. The first three grow by rules.
enum class SourceKind { kPreset, kRecipe, kRules, kSpheres, kSculpt, kVolume };
/// The same as bits, for options that suit some of them.
enum InputBits : unsigned { kFromRules = 1, kFromSpheres = 2, kFromSculpt = 4, kFromVolume = 8, kAnyInput = 15 };
constexpr unsigned inputBit(SourceKind kind) {
  return kind == SourceKind::kVolume    ? kFromVolume
         : kind == SourceKind::kSculpt  ? kFromSculpt
         : kind == SourceKind::kSpheres ? kFromSpheres
                                        : kFromRules;
}
constexpr bool isGrown(SourceKind kind) { return (inputBit(kind) & (kFromRules | kFromSpheres)) != 0; }

/// Where a cloud comes from and how it is read.
struct SourceSettings {
  SourceKind kind = SourceKind::kSculpt;
  std::filesystem::path input;                                   ///< the file, or the name of a preset
  std::vector<std::pair<std::string, std::string>> recipe_keys;  ///< key and value, over what the recipe says
  ReadSettings read;
  VdbSettings volume;
  bool explain = false;       ///< --explain: report how the cloud grew
  bool spheres_only = false;  ///< --dry-run: stop after the spheres
};

/// What gives a mesh its volume: itself where it is closed, else what closes it; always a wrap; or nothing else than itself.
enum class CloseChoice { kAuto, kWrap, kReject };

/// What becomes of the mesh.
struct MeshSettings {
  std::optional<size_t> vertices;  ///< budget; unset: the surface's own, of a grown cloud also that of the scene
  std::optional<Length> remesh;    ///< edge length
  RepairSettings repair;
  bool repair_remesh = false;  ///< with the sculpt's own mean edge length, unless `remesh` gives another
  CloseChoice close = CloseChoice::kAuto;
  bool separate = false;  ///< bake every object alone
  bool inspect = false;   ///< look for what costs more to find than to bake
};

/// What the sweep integrates: by itself coverage where the mesh is closed.
enum class FieldChoice { kAuto, kCoverage, kLevelSet };

/// The lattices of the surface and of the integration field, and the shape of a grown cloud's level set.
struct FieldSettings {
  FieldChoice kind = FieldChoice::kAuto;
  int voxels = 100;                 ///< along the longest side
  std::optional<float> voxel_size;  ///< world units, in place of `voxels`
  std::optional<int> bake_voxels;   ///< of the integration field alone; unset: as the surface's
  Length blend;
  std::optional<float> flat_base;
  std::optional<Length> noise;
  std::optional<Length> noise_size;  ///< unset: half as much again as bumps need to hang on
  int noise_octaves = 3;
  uint64_t noise_seed = 1;
};

/// An error that a bake is to keep, against exact chords.
struct TargetError {
  double value = 0;               ///< degrees, or a share of 1
  bool is_transmittance = false;  ///< rms of the lobe's T against that of the exact lobe; else rms angle of the direction
};

/// The lobes, and what is written beside them.
struct LobeSettings {
  BakeSettings bake;
  std::optional<TargetError> target_error;
  bool fit = false, fit_exponent = false, fit_bias = false;
  std::optional<float> exponent;                            ///< unset: that of defaultShape (pipeline/parameters.h)
  std::optional<Length> bias;                               ///< likewise
  std::optional<std::pair<float, float>> extinction_range;  ///< unset: 7 / longest side; of a fit half to double of it
  std::optional<SunArc> sun_arc;
  int harmonic_order = 0;  ///< --basis; 0: lobes alone
  int lattice_cells = 16;  ///< along the longest side
  int smooth = 0;          ///< passes over the mesh, after bake and fit
};

/// What is written.
struct OutputSettings {
  std::filesystem::path file;  ///< -o: the asset or the picture; of a batch and of a curve the folder
  GltfSettings gltf;
  std::optional<std::filesystem::path> lattice, spheres, vdb;
};

/// The picture that `preview` draws.
struct PictureSettings {
  float sun_azimuth_degrees = 105, sun_elevation_degrees = 30;
  float camera_azimuth_degrees = 0, camera_elevation_degrees = 6;
  float field_of_view_degrees = 35;
  int width = 960, height = 640;
  float exposure = 1;
  bool plain = false;       ///< the lobe formula alone; else the published image chain
  double time_seconds = 0;  ///< of the chain's swirls
  std::optional<std::filesystem::path> channels, steps;
  bool lobes_only = false;  ///< not by spherical harmonics, where the asset has them
  bool draft = false;       ///< scenes: at less cost
  bool compare = false;     ///< a sheet beside the truth in place of a picture
  int suns = 0;             ///< with `compare`: figures for so many suns
  enum class Motion { kNone, kTurntable, kSunSweep, kAnimate } motion = Motion::kNone;
  int frame_count = 0;  ///< of the motion
  double frames_per_second = 12;
  std::optional<std::filesystem::path> frames;
};

/// Errors against exact chords that an asset may have.
struct ErrorBounds {
  std::optional<double> angle_degrees, transmittance_rms;  ///< rms of the direction, rms of the lobe's T
  bool any() const { return angle_degrees || transmittance_rms; }
};

/// How lobes are judged: by `measure`, by `check`, by the bounds of a batch.
struct JudgeSettings {
  std::optional<std::filesystem::path> against;  ///< check: the asset before another program
  ErrorBounds bounds;
  std::optional<size_t> truth_vertices;  ///< unset: 2000, or 200 where the truth is a march, in a batch and in a check
};

/// What is asked of a whole batch.
struct BatchSettings {
  std::vector<std::filesystem::path> inputs;        ///< the manifest or the folder; with `merge`, reports
  std::optional<std::filesystem::path> input_list;  ///< sculpts, a path per line; "-": from stdin
  std::optional<std::string> name;                  ///< template of the outputs' names
  std::optional<std::filesystem::path> cache, junit, html, depfile, depfile_target;
  std::optional<uint64_t> memory;  ///< bytes that the running assets may take together; unset: three quarters of the machine's
  bool fail_fast = false, force = false, prune = false, init = false, merge = false, dry_run = false;
  int shard = 0, shards = 0;  ///< 1-based; 0: all
};

/// How a run reports.
struct RunSettings {
  std::optional<std::filesystem::path> json;
  int threads = 0;  ///< 0: all
  bool strict = false, quiet = false;
};

struct Settings {
  SourceSettings source;
  MeshSettings mesh;
  FieldSettings field;
  LobeSettings lobe;
  OutputSettings output;
  PictureSettings picture;
  std::optional<std::filesystem::path> scene;  ///< of bakes: what an error is chosen for; of preview: what is drawn
  JudgeSettings judge;
  BatchSettings batch;
  RunSettings run;
};

}  // namespace cloudbake
