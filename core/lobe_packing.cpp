// v = M⁻¹(o·d) keeps direction and thickness together. Under a non-uniform scale the direction and length of a chord change
// like one vector, so M restores both exactly. A thickness of zero gives no vector; then the direction alone is mapped.
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
