// What the tests of pictures share.
#pragma once

#include <gtest/gtest.h>

#include "core/types.h"

namespace cloudbake {

/// `within` is a distance.
inline void expectNear(Vec3 a, Vec3 b, double within) { EXPECT_LT(length(a - b), within) << a.x << " " << a.y << " " << a.z; }

}  // namespace cloudbake
