// assimp's vectors and matrices as ours.
#pragma once

#include <assimp/matrix4x4.h>
#include <assimp/vector3.h>

#include "core/affine.h"

namespace cloudbake {

inline Vec3 toVec3(const aiVector3D& v) { return {v.x, v.y, v.z}; }

inline Affine toAffine(const aiMatrix4x4& m) {
  return {{{{m.a1, m.a2, m.a3}, {m.b1, m.b2, m.b3}, {m.c1, m.c2, m.c3}}}, {m.a4, m.b4, m.c4}};
}

}  // namespace cloudbake
