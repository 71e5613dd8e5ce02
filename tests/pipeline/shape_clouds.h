// Clouds of analytic shapes that several rooms of pipeline/ bake.
#pragma once

#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {

/// Radius 1.
inline const Cloud& ball() {
  static const Cloud cloud = cloudOf(ballMesh(1, 3));
  return cloud;
}

/// Its lobes are no ball's, so that a fit has something to gain.
inline const Cloud& torus() {
  static const Cloud cloud = cloudOf(torusMesh(1, 0.4F, 24, 12));
  return cloud;
}

}  // namespace cloudbake
