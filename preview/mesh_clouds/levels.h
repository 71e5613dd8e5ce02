// Which level of detail of a cloud is drawn.
#pragma once

#include "preview/camera.h"
#include "preview/mesh_clouds/lit_mesh.h"

namespace cloudbake {

/// The longest side of the mesh's own box, times the largest stretch of an axis, so that no turn of the cloud changes it.
float longestStretched(const Instance& instance);

/// The pixels that the longest side of an instance would cover if all of it were where its box is nearest to the camera; infinite if the
/// camera is in the box, which is placedBox. The longest side is longestStretched, so that neither a turn of the cloud nor one of the
/// camera changes it.
float pixelsAcross(const Instance& instance, const Camera& camera);

/// The same for an instance whose box and longest side are known.
float pixelsAcross(const Box& placed, float longest_side, const Camera& camera);

/// The coarsest of the instance's levels whose switch_pixels are no fewer than those; the mesh itself if there is none.
const BakedMesh& levelAt(const Instance& instance, const Camera& camera);

/// Whether something of an instance may be in the picture: not all corners of its box are behind the camera or beyond one side.
bool isInView(const Instance& instance, const Camera& camera);
bool isInView(const Box& placed, const Camera& camera);

}  // namespace cloudbake
