// A picture, as it is passed between stages: preview draws it, io encodes it.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/vec3.h"

namespace cloudbake {

/// RGB, rows from the top, pixels from the left. Colours are linear unless a name says otherwise. Any value ≥ 0 is allowed.
struct Image {
  int width = 0, height = 0;
  std::vector<Vec3> pixels;  ///< width·height

  Vec3& at(int x, int y) { return pixels[size_t(y) * size_t(width) + size_t(x)]; }
  const Vec3& at(int x, int y) const { return pixels[size_t(y) * size_t(width) + size_t(x)]; }
};

/// A black picture.
inline Image blankImage(int width, int height) { return {width, height, std::vector<Vec3>(size_t(width) * size_t(height))}; }

/// Means of 2 × 2 pixels; a last column or row that has no neighbour is left out.
Image halved(const Image& image);

/// The four numbers of a pixel in Image4: R, G, B, A.
using Rgba = std::array<float, 4>;

/// Four channels, rows from the top, pixels from the left. The function that makes such an image documents its channels.
struct Image4 {
  int width = 0, height = 0;
  std::vector<Rgba> pixels;  ///< width·height

  Rgba& at(int x, int y) { return pixels[size_t(y) * size_t(width) + size_t(x)]; }
  const Rgba& at(int x, int y) const { return pixels[size_t(y) * size_t(width) + size_t(x)]; }
};

/// A picture whose pixels all equal `fill`.
inline Image4 filledImage4(int width, int height, const Rgba& fill) {
  return {width, height, std::vector<Rgba>(size_t(width) * size_t(height), fill)};
}

}  // namespace cloudbake
