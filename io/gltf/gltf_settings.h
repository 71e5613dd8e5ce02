// What a baked GLB may be asked to have.
#pragma once

#include <optional>

namespace cloudbake {

/// Whether to bind a white texture of two pixels to the two UV sets (and to lower sets that nothing uses), so that optimisers keep the sets
/// in place. White is neutral in every slot that is used.
enum class KeepAliveTexture {
  kAuto,   ///< use free core slots of each material; if too few are free, bind nothing and count kKeepAlive
  kForce,  ///< like kAuto, but use slots of KHR_materials_clearcoat if others are missing
  kOff
};

/// What triangles of a packed asset are stored as.
enum class PackForm {
  kList,    ///< lists of three indices, which every reader takes
  kStrip,   ///< strips, with a third to a half of the indices
  kMeshopt  ///< compressed with their vertices: EXT_meshopt_compression
};

struct GltfSettings {
  std::optional<int> uv_set;  ///< first of the two sets, 0 … 6; unset = the lowest n with n and n+1 free in every primitive
  bool attribute = false;     ///< also write _OCCLUSION (VEC4: o.x, o.y, o.z, d)
  KeepAliveTexture keep_alive_texture = KeepAliveTexture::kAuto;
  bool pack = false;  ///< lobes of 8 bytes; else of 16, four floats
  PackForm pack_form = PackForm::kList;
};

}  // namespace cloudbake
