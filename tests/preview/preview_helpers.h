// What the tests of preview/ share.
#pragma once

#include <gtest/gtest.h>

#include "core/types.h"

namespace cloudbake {

/// Each component by itself.
inline void expectNear(Vec3 found, Vec3 expected, double tolerance = 1e-5) {
  EXPECT_NEAR(found.x, expected.x, tolerance);
  EXPECT_NEAR(found.y, expected.y, tolerance);
  EXPECT_NEAR(found.z, expected.z, tolerance);
}

}  // namespace cloudbake
