// How two UV sets store the four floats of a vertex (docs/asset_format.md).
#pragma once

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

}  // namespace cloudbake
