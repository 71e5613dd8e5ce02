// What one renderer adds to a picture, and how the layers of all renderers are combined: clouds before terrain, behind a ridge, under a
// slab.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "core/image.h"

namespace cloudbake {

/// One pixel of a layer.
struct LayerPixel {
  Vec3 color;                 ///< linear; not multiplied by the opacity
  float opacity = 0;          ///< 0 … 1
  float distance = INFINITY;  ///< along the ray, world units; infinite if there is nothing
};

/// Rows from the top, pixels from the left.
struct Layer {
  int width = 0, height = 0;
  std::vector<LayerPixel> pixels;  ///< width·height

  LayerPixel& at(int x, int y) { return pixels[size_t(y) * size_t(width) + size_t(x)]; }
  const LayerPixel& at(int x, int y) const { return pixels[size_t(y) * size_t(width) + size_t(x)]; }
};

/// An empty layer.
inline Layer blankLayer(int width, int height) { return {width, height, std::vector<LayerPixel>(size_t(width) * size_t(height))}; }

/// The haze between the camera and the layers.
struct FogSettings {
  float density = 0;                ///< of 1 − exp(−density·distance), per world unit, ≥ 0; 0 = no fog
  Vec3 color{0.22F, 0.37F, 0.55F};  ///< linear; the default is the horizon of the day's sky
};

/// All layers over the background, linear. In every pixel the nearest layer comes first, and equally far ones keep the order given. Each
/// layer's colour is faded to the fog by its distance; the background is not. Where every opacity is 0 the background stays exactly the
/// same. Throws std::invalid_argument if a layer has another size than the background, or if the density is negative or not finite.
Image composeLayers(std::span<const Layer> layers, const Image& background, const FogSettings& fog = {});

}  // namespace cloudbake
