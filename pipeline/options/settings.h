// The settings of a run, one struct per consumer. resolve (pipeline/options/resolve.h) makes them once, and they are const from then on.
// Values that depend on the shape (L, k, b, σ, the chosen voxels) are results (pipeline/lobes/parameters.h, io/report/report.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bake/mesh/repair.h"
#include "core/impostor.h"
#include "core/memory_budget.h"
#include "core/types.h"
#include "io/file/read_settings.h"
#include "io/gltf/gltf_settings.h"
#include "io/volume/vdb.h"

namespace cloudbake {

/// A length in world units, or relative to the longest side of the shape ("2.5%").
struct Length {
  float value = 0;
  bool relative = false;  ///< value is a fraction of the longest side
  float resolve(float longest_side) const { return relative ? value * longest_side : value; }
};

/// The source of a cloud. The first three are grown by rules.
enum class SourceKind { kPreset, kRecipe, kRules, kSpheres, kSculpt, kVolume };
/// The same as bits, for options that apply to some kinds only.
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
  std::vector<std::pair<std::string, std::string>> recipe_keys;  ///< key and value; they override the recipe
  ReadSettings read;
  VdbSettings volume;
  uint64_t memory_limit = kMemoryLimit;  ///< bytes of the run; resolve passes it on to all settings with such a limit
  bool explain = false;                  ///< --explain: report how the cloud grew
  bool spheres_only = false;             ///< --dry-run: stop after the spheres
};

/// What bounds the volume of a mesh. kAuto: the mesh, closed by filling, flood or wrap if it is open; kWrap: a wrap; kReject: only the
/// mesh.
enum class CloseChoice { kAuto, kWrap, kReject };

/// The size of a level of detail.
struct LevelSize {
  double value = 0;  ///< vertices, or a share of those of the full asset, 0 … 1
  bool is_share = false;
  size_t vertices(size_t full) const { return size_t(is_share ? value * double(full) : value); }
};

/// How a mesh is changed, closed and inspected.
struct MeshSettings {
  std::optional<size_t> vertices;  ///< budget, with `refine` for what it adds; unset: no limit, except for a grown cloud with a scene
  std::optional<Length> remesh;    ///< edge length
  std::optional<double> refine;    ///< rms of T that blending may add, over 0 to 1; 0: a tenth of the error of own lobes (auto)
  RepairSettings repair;
  bool repair_remesh = false;  ///< to the sculpt's mean edge length, unless `remesh` gives another length
  CloseChoice close = CloseChoice::kAuto;
  bool separate = false;          ///< bake every object as if it were alone
  std::vector<LevelSize> levels;  ///< of detail, descending, all shares or all numbers
  bool inspect = false;           ///< look for defects that take longer to find than a bake takes
  uint64_t memory_limit = kMemoryLimit;
};

/// The field that the sweep integrates. kAuto: coverage if the mesh is closed, else the level set.
enum class FieldChoice { kAuto, kCoverage, kLevelSet };

/// The lattices of the surface and of the integration field, and the shape of a grown cloud's level set.
struct FieldSettings {
  FieldChoice kind = FieldChoice::kAuto;
  int voxels = 100;                 ///< along the longest side
  std::optional<float> voxel_size;  ///< world units; replaces `voxels`
  std::optional<int> bake_voxels;   ///< of the integration field only; unset: same as the surface, or fewer (parametersFor)
  Length blend;
  std::optional<float> flat_base;
  std::optional<Length> base_softness;   ///< unset: as `blend`
  std::optional<Length> base_bumps;      ///< height of what hangs from the flat base
  std::optional<Length> base_bump_size;  ///< unset: 5 times their height
  std::optional<Length> noise;
  std::optional<Length> noise_size;  ///< unset: 1.5 times the least size at which bumps stay attached
  std::optional<int> noise_octaves;  ///< unset: 3, or as many as the voxels hold
  uint64_t noise_seed = 1;
  uint64_t memory_limit = kMemoryLimit;
};

/// The error against exact chords that a bake must not exceed.
struct TargetError {
  double value = 0;               ///< degrees, or a fraction of 1
  bool is_transmittance = false;  ///< rms of the lobe's T against that of the exact lobe; else rms angle of the direction
};

/// Settings of the volume that lobes are fitted to or compared with, as far as they were given.
struct VolumeChoices {
  std::optional<float> view_extinction, asymmetry;
  std::optional<OctaveSettings> octaves;
  /// The rest is as in `base`.
  VolumeLight over(const VolumeLight& base) const {
    return {view_extinction.value_or(base.view_extinction), octaves.value_or(base.octaves), asymmetry.value_or(base.asymmetry)};
  }
};

/// The lobes, and what is baked in addition to them.
struct LobeSettings {
  BakeSettings bake;
  std::optional<TargetError> target_error;
  bool fit = true;            ///< else mean lobes, as with the method of rays and of separate objects unless they are asked for
  bool fit_to_volume = true;  ///< else to the transmittance, as with the method of rays; a search of k and b is then the default
  bool fit_exponent = false, fit_bias = false;
  VolumeChoices volume;
  std::optional<float> exponent;                            ///< unset: as in defaultShape (pipeline/lobes/parameters.h)
  std::optional<Length> bias;                               ///< likewise
  std::optional<std::pair<float, float>> extinction_range;  ///< unset: 7 / longest side; of a fit, half to double that
  std::optional<SunArc> sun_arc;
  int harmonic_order = 0;  ///< --basis; 0: lobes only
  int lattice_cells = 16;  ///< along the longest side
  int smooth = 0;          ///< passes over the mesh, after the bake and the fit
  uint64_t memory_limit = kMemoryLimit;
};

/// The output files.
struct OutputSettings {
  std::filesystem::path file;  ///< -o: the asset or the picture, or the folder of a batch or a curve
  GltfSettings gltf;
  std::optional<std::filesystem::path> lattice, spheres, vdb;
};

/// The picture that `preview` draws.
/// Where sun and camera are unless something else is said, degrees.
struct ViewAngles {
  float sun_azimuth, sun_elevation, camera_azimuth, camera_elevation;
};
/// Of the lobe formula alone, of comparisons and of the chain as published: sun from the right, seen from a little above.
inline constexpr ViewAngles kPlainView{105, 30, 0, 6};
/// Of the painted look: the sun is behind the cloud's right side, which is seen from below, as from the ground.
inline constexpr ViewAngles kPaintedView{130, 28, 0, -8};

struct PictureSettings {
  float sun_azimuth_degrees = kPaintedView.sun_azimuth, sun_elevation_degrees = kPaintedView.sun_elevation;
  float camera_azimuth_degrees = kPaintedView.camera_azimuth, camera_elevation_degrees = kPaintedView.camera_elevation;
  float field_of_view_degrees = 35;
  int width = 960, height = 640;
  bool is_sized = false;  ///< the page of `view` has this size, and does not fill the window
  float exposure = 1;
  bool plain = false;                   ///< the lobe formula alone; else the painted look
  double time_seconds = 0;              ///< of the picture
  std::optional<double> start_seconds;  ///< when motion and the page of `view` begin; unset: at time_seconds
  double time_offset_seconds = 0;       ///< by which clouds and aurora are ahead of the time
  bool is_live = false;                 ///< for the page of `view`
  std::optional<std::filesystem::path> channels, steps;
  bool lobes_only = false;  ///< light by the lobes, even if the asset has spherical harmonics
  bool draft = false;       ///< scenes: faster, at lower quality
  bool compare = false;     ///< draw a sheet that compares the asset with the truth
  int suns = 0;             ///< with `compare`: number of suns for the figures
  enum class Motion { kNone, kTurntable, kSunSweep, kAnimate } motion = Motion::kNone;
  int frame_count = 0;  ///< frames of the motion
  double frames_per_second = 12;
  std::optional<std::filesystem::path> frames;
  uint64_t memory_limit = kMemoryLimit;
};

/// The picture of a shadow that `shadow` writes.
struct ShadowPictureSettings {
  int size = 256;                   ///< pixels to a side
  std::optional<float> extinction;  ///< σ per world unit; unset: that of the asset
};

/// The atlas that `impostor` writes.
struct ImpostorSettings {
  int views = 9, frame = 64;  ///< frames to a side of the atlas, and pixels to a side of a frame
  ImpostorOf of = ImpostorOf::kVolume;
  float half_lambert = 1;  ///< of an impostor of the mesh: f of lerp(f, 1, n·l/2 + ½)
  bool six_way = false;
  bool measure = false;  ///< compares pictures
};

/// What `plan` plans for.
struct PlanSettings {
  double change = 2;                             ///< that pictures may have: rms of the 8-bit values over pixels that show clouds
  std::optional<double> vertices, bytes, draws;  ///< limits of cost
  std::vector<double> hours;                     ///< of day; empty: the scene's own sun
  std::vector<Vec3> path;                        ///< of the camera, which looks to all sides
  std::optional<std::pair<Vec3, Vec3>> region;   ///< the low and the high corner of the box that the camera is in
  bool measure = false;                          ///< draws and compares all pictures
};

/// How a sequence stores its keys: in one file, as morph targets or in a picture, or a file for each.
enum class SequenceOutput { kMorph, kPicture, kKeys };

/// The frames that `sequence` reads, and what it keeps of them.
struct SequenceSettings {
  std::optional<double> frames_per_second;  ///< unset: 24
  int pixels = 128;                         ///< that the longest side covers in the pictures that decide which frames are kept
  double change = 1;                        ///< that these pictures may have: rms of their 8-bit values over pixels that show the cloud
  Length detail{0.02F, true};               ///< what is narrower than two of it is left out of the mesh, though not of the lobes
  int fade = 4;                             ///< frames over which one segment takes the place of another
  bool loops = false;                       ///< the last frames fade into the first ones
  std::optional<int> frames;  ///< of a grown cloud (unset: 60) or of an animation (unset: as many as the frames per second make)
  std::string animation;      ///< of a file with several; empty: the first one
  struct Varied {
    std::string option;
    double from = 0, to = 0;
  };
  std::vector<Varied> varied;  ///< options that change over the frames of a grown cloud
  SequenceOutput output = SequenceOutput::kMorph;
};

/// The largest errors against exact chords that an asset may have.
struct ErrorBounds {
  std::optional<double> angle_degrees, transmittance_rms;  ///< rms of the direction, rms of the lobe's T
  std::optional<double> surface_rms{};                     ///< rms of T between the vertices too, evaluated per vertex or per pixel
  bool any() const { return angle_degrees || transmittance_rms || surface_rms; }
};

/// How `measure`, `check` and the bounds of a batch judge lobes.
struct JudgeSettings {
  std::optional<std::filesystem::path> against;    ///< check: the asset before another program
  std::optional<std::filesystem::path> lattice{};  ///< check: a lattice that belongs to the asset
  bool certificate = false;                        ///< check: only prove the certificate of a packed asset
  ErrorBounds bounds;
  std::optional<size_t> truth_vertices;  ///< unset: 2000; 200 if the truth is marched, in a batch and in a check
  uint64_t memory_limit = kMemoryLimit;
};

/// The state with which a batch continues after a crash (app/supervise.h). Assets have the names of their outputs.
struct BatchOrders {
  std::map<std::string, int> crashed;  ///< those with which a signal ended the program, with its number
  std::set<std::string> alone, done;   ///< those to run with nothing beside them; those that are done
};

/// The settings of a whole batch.
struct BatchSettings {
  std::vector<std::filesystem::path> inputs;        ///< the manifest or the folder; with `merge`, reports
  std::optional<std::filesystem::path> input_list;  ///< file with the path of a sculpt per line; "-": stdin
  std::optional<std::string> name;                  ///< template for the names of the outputs
  std::optional<std::filesystem::path> cache, junit, html, depfile, depfile_target;
  bool fail_fast = false, prune = false, init = false, merge = false, dry_run = false;
  bool live = false;  ///< with `html`: a page like that of `view` beside every asset
  BatchOrders orders;
  int shard = 0, shards = 0;  ///< 1-based; 0: all
};

/// How `view` serves its page.
struct ServeSettings {
  std::optional<int> port;                     ///< on the loopback interface; 0: any free one; unset with `watch`: kServePort
  std::optional<std::filesystem::path> watch;  ///< the file that is shown, and baked again when it changes
};
inline constexpr int kServePort = 8642;

/// How a run reports.
struct RunSettings {
  std::optional<std::filesystem::path> json;
  int threads = 0;                 ///< 0: all
  std::optional<uint64_t> memory;  ///< bytes, of the running assets of a batch together; unset: SourceSettings::memory_limit
  bool strict = false, quiet = false;
  bool force = false;  ///< also replace files of other programs, and bake assets that are up to date
};

struct Settings {
  SourceSettings source;
  MeshSettings mesh;
  FieldSettings field;
  LobeSettings lobe;
  OutputSettings output;
  PictureSettings picture;
  ShadowPictureSettings shadow;
  ImpostorSettings impostor;
  PlanSettings plan;
  SequenceSettings sequence;
  std::optional<std::filesystem::path> scene;  ///< which a bake or a kit is for, or which is drawn
  JudgeSettings judge;
  BatchSettings batch;
  ServeSettings serve;
  RunSettings run;
};

}  // namespace cloudbake
