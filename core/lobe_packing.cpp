// v = M⁻¹(o·d) keeps direction and thickness together: under a non-uniform scale a chord's direction and length change
// as one vector does, so M brings both back exactly. A thickness of zero has no vector; its direction travels alone.
#include "core/lobe_packing.h"

namespace cloudbake {

Lobe mappedLobe(const Lobe& lobe, const Affine& map) {
  const Vec3 direction = transformVector(map, lobe.direction);
  const auto unit = normalized(direction);
  if (!unit) return {lobe.direction, 0};
  return {*unit, lobe.thickness * length(direction)};
}

LobeUvs packLobe(const Lobe& lobe, const Affine& from_scene) {
  const Lobe local = mappedLobe(lobe, from_scene);
  return {{local.direction.x, local.direction.y}, {local.direction.z, local.thickness}};
}

Lobe unpackLobe(const LobeUvs& uvs, const Affine& to_scene) {
  return mappedLobe({{uvs.first.x, uvs.first.y, uvs.second.x}, uvs.second.y}, to_scene);
}

}  // namespace cloudbake
