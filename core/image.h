// A picture as it crosses stages: preview draws it, io encodes it.
#pragma once

#include <cstddef>
#include <vector>

#include "core/vec3.h"

namespace cloudbake {

/// RGB, rows from the top, pixels from the left. Linear colours unless a name says otherwise; any value ≥ 0.
struct Image {
  int width = 0, height = 0;
  std::vector<Vec3> pixels;  ///< width·height

  Vec3& at(int x, int y) { return pixels[size_t(y) * size_t(width) + size_t(x)]; }
  const Vec3& at(int x, int y) const { return pixels[size_t(y) * size_t(width) + size_t(x)]; }
};

/// A black picture.
inline Image blankImage(int width, int height) { return {width, height, std::vector<Vec3>(size_t(width) * size_t(height))}; }

}  // namespace cloudbake
