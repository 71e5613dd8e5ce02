// Names a change of lobes that no single hypothesis of pipeline/check/diagnose.h explains: thicknesses or directions alone, a part of the
// vertices, another order, another mesh.
#pragma once

#include <optional>
#include <span>

#include "io/gltf/asset/validate_asset.h"

namespace cloudbake {

/// The stored lobes of all vertices, and at some of them the right ones, in scene space.
struct ChangedLobes {
  std::span<const Lobe> stored;      ///< #V
  std::span<const size_t> vertices;  ///< some of them
  std::span<const Lobe> right;       ///< #vertices
  std::span<const double> errors;    ///< #vertices: rms of T between stored and right
  bool same_mesh = false;            ///< the mesh is known to be that of the bake
};

/// Causes: "permuted" (the lobes of other vertices), "thickness" (only d is wrong), "direction" (only o is wrong), "part" (only some of
/// the lobes are wrong), "stale" (none of these).
AssetFault nameChange(const ChangedLobes& lobes);

/// "thickness", if d is the same at all vertices and should not be; a scale could seem to explain that.
std::optional<AssetFault> nameConstant(const ChangedLobes& lobes);

}  // namespace cloudbake
