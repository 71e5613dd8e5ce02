// The library: it bakes triangles, a sculpt or a grown cloud to lobes and a GLB. It does what `cloudbake bake` and `cloudbake grow` do,
// without the command line.
//
//   #include <cloudbake.h>
//   const cloudbake::BakeResult baked = cloudbake::bake(mesh, {{"rays", "200"}, {"lobe", "fit"}});
//   baked.lobes[v], baked.info.shape, baked.info.extinction → lobeTransmittance (core/lobe_lighting.h)
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/lobe_lighting.h"
#include "core/types.h"

namespace cloudbake {

/// Options and their values as on the command line, without the leading dashes and in order; a flag has the value "true". `cloudbake bake
/// --help-all` lists them. The library accepts no option that names a file, such as json, lattice and scene.
using Options = std::vector<std::pair<std::string, std::string>>;

/// Something that was dropped, assumed or undefined, with its count and its first place.
struct BakeWarning {
  std::string kind;  ///< its name in reports, such as "open-edges"
  uint64_t count = 0;
  std::string first;
};

struct BakeResult {
  std::vector<Lobe> lobes;  ///< #V, in scene space, in the order of the vertices, part after part
  AssetInfo info;           ///< k, b, σ and the other metadata of the asset
  std::string glb;          ///< the asset, as docs/asset_format.md describes it
  std::vector<BakeWarning> warnings;
  std::string report;   ///< JSON, as --json writes it ("schema": "cloudbake-report-1")
  std::string summary;  ///< the lines that the program prints: warnings, then the report
};

/// Is called with the name of every stage when it ends: "read", "check", "field", "bake", "fit" … What it throws ends the bake.
using StageListener = std::function<void(const std::string& stage)>;

/// Bakes a triangle mesh: #V×3 positions (any unit, +Y up), #F×3 indices, normals #V×3 or none. The vertices keep their number and order
/// unless the options ask for a new mesh. Throws UsageError for a wrong option, InputError for an unusable mesh. Equal input and options
/// give the same bytes for any number of threads.
BakeResult bake(SurfaceMesh mesh, const Options& options = {}, const StageListener& on_stage = {});

/// Bakes a file: glTF, GLB, OBJ, PLY, STL, OFF, FBX, VDB and others. Throws as above, and IoError if the file cannot be read.
BakeResult bake(const std::filesystem::path& file, const Options& options = {}, const StageListener& on_stage = {});

/// Grows a cloud and bakes it: a preset by its name, a recipe (.toml), a list of rules (.txt), or points and radii (.ply, .csv). Options
/// are those of `cloudbake grow`. Throws as above.
BakeResult grow(const std::filesystem::path& preset_or_file, const Options& options = {}, const StageListener& on_stage = {});

/// Reads all parts of a baked GLB, in scene space. `name` names it in errors. Throws InputError if it is damaged or not a baked asset.
BakedMesh readAsset(std::string_view glb, const std::string& name = "asset.glb");

/// The version, such as "1.2.3".
const char* version();

}  // namespace cloudbake
