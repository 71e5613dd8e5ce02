// Makes the ways to draw an asset that a plan chooses from: the asset with packed lobes, its levels of detail, and an impostor.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/types.h"
#include "pipeline/plan/choose.h"

namespace cloudbake {

/// rms of 8-bit values, as of Popping.
inline constexpr float kMostPackedChange = 1;

struct WaysSettings {
  bool packs = true;       ///< whether lobes may be packed, where that changes pictures by kMostPackedChange at most
  float half_lambert = 1;  ///< f of lerp(f, 1, n·l/2 + ½) in the scene
  bool impostors = true;   ///< whether the scene can have them
  uint64_t memory_limit = 0;
};

/// A way with its file.
struct MadeWay {
  std::string glb;  ///< the label of its level is not final
  BakedMesh mesh;   ///< as it is read from the file
  std::vector<SizeChange> changes;
  DrawnWay drawn() const;
};

/// From the finest to the coarsest: the asset, packed if that hardly shows; its levels; and an impostor of its mesh, if the scene can have
/// it and the asset is white. They are kept in the user's cache (pipeline/picture/cloud_cache.h) by the asset's bytes, so that the next
/// plan does not make them again. `glb`: the bytes of the baked asset `file`. Throws InputError if it is no baked asset.
std::vector<MadeWay> makeWays(const std::filesystem::path& file, const std::string& glb, const WaysSettings& settings);

}  // namespace cloudbake
