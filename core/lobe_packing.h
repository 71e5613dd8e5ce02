// How two UV sets store the four floats of a vertex (docs/asset_format.md).
#pragma once

#include <array>
#include <cstdint>

#include "core/types.h"

namespace cloudbake {

struct LobeUvs {
  Vec2 first;   ///< TEXCOORD_n   = (o.x, o.y)
  Vec2 second;  ///< TEXCOORD_n+1 = (o.z, d)
};

/// v = M·(o·d) as one vector, o = v/‖v‖, d = ‖v‖. If v is zero, the lobe keeps its direction and its thickness becomes 0. Only the
/// linear part is used.
Lobe mappedLobe(const Lobe& lobe, const Affine& map);

/// Packs a lobe in scene space into the space of a mesh under a node: v = M⁻¹(o·d), o' = v/‖v‖, d' = ‖v‖; with d = 0,
/// o' = M⁻¹o normalised. `from_scene` is the inverse of the node's transform; only its linear part is used.
LobeUvs packLobe(const Lobe& lobe, const Affine& from_scene);

/// The inverse: v = M·(o'·d'), o = v/‖v‖, d = ‖v‖. `to_scene` is the node's transform.
Lobe unpackLobe(const LobeUvs& uvs, const Affine& to_scene);

// --- Packed assets: eight bytes of lobe ---

/// The integers of a lobe: o on the octahedron |x| + |y| + |z| = 1, unfolded to the square, and the root of d / d_max. As normalised
/// integers of glTF they stand for u / 32767, v / 32767 and root / 65535. Two bytes are left for the first number of the second set.
struct PackedLobe {
  int16_t u = 0, v = 0;
  uint16_t root = 0;
};
inline constexpr double kDirectionSteps = 32767, kDensitySteps = 65535;

/// The nearest integers. `density_max` is at least the lobe's d, and above 0.
PackedLobe quantisedLobe(const LobeUvs& uvs, float density_max);

/// The point (u, v) of the square −1 … 1 to which the octahedron's point towards a vector is unfolded. The middle of the square is +z.
std::array<double, 2> octahedronPlace(double x, double y, double z);
/// The point of the octahedron that the square's point (u, v) is folded to; o is this vector, normalised. −1 ≤ u, v ≤ 1.
std::array<double, 3> octahedronPoint(double u, double v);

/// (o, d) of the numbers that a packed asset stores: first = (u, v), second = (anything, root).
LobeUvs dequantisedLobe(const LobeUvs& stored, float density_max);

}  // namespace cloudbake
