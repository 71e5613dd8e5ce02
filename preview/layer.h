// The layer that a renderer adds to a picture, and how the layers of all renderers are combined: clouds before terrain, behind a ridge,
// under a slab.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "core/image.h"
#include "core/keys.h"

namespace cloudbake {

/// One pixel of a layer.
struct LayerPixel {
  Vec3 color;                 ///< linear; not multiplied by the opacity
  float opacity = 0;          ///< 0 … 1
  float distance = INFINITY;  ///< along the ray, world units; infinite if there is nothing
};

/// Rows from the top, pixels from the left. A pixel has n·n samples, at pixelPlaces(n), which are stored together.
struct Layer {
  int width = 0, height = 0;
  std::vector<LayerPixel> pixels;  ///< width·height·samples()
  int samples_per_side = 1;        ///< n, ≥ 1

  int samples() const { return samples_per_side * samples_per_side; }
  LayerPixel& at(int x, int y, int sample = 0) { return pixels[indexOf(x, y, sample)]; }
  const LayerPixel& at(int x, int y, int sample = 0) const { return pixels[indexOf(x, y, sample)]; }
  /// The sample in the same part of the pixel as the given one of a layer with `other` samples to a side.
  int sampleFor(int sample, int other) const {
    const int column = sample % other * samples_per_side / other, row = sample / other * samples_per_side / other;
    return row * samples_per_side + column;
  }

 private:
  size_t indexOf(int x, int y, int sample) const { return (size_t(y) * size_t(width) + size_t(x)) * size_t(samples()) + size_t(sample); }
};

/// An empty layer.
inline Layer blankLayer(int width, int height, int samples_per_side = 1) {
  return {width, height, std::vector<LayerPixel>(size_t(width) * size_t(height) * size_t(samples_per_side * samples_per_side)),
          samples_per_side};
}

/// Where a ray meets surfaces that clouds are before and behind, near to far.
struct Cuts {
  static constexpr int kMost = 2;
  struct Cut {
    float distance = INFINITY;  ///< world units; a caller may have scaled it
    bool is_opaque = false;
  };
  std::array<Cut, kMost> cuts;
  int count = 0;

  /// Beyond this distance nothing is seen.
  float hiddenFrom() const {
    for (int i = 0; i < count; ++i)
      if (cuts[size_t(i)].is_opaque) return cuts[size_t(i)].distance;
    return INFINITY;
  }
  /// A distance of the part behind `part` cuts, despite rounding: not before the cut before it, and less than the cut behind it.
  float within(size_t part, float distance) const {
    if (part < size_t(count)) distance = std::min(distance, std::nextafter(cuts[part].distance, 0.0F));
    return part > 0 ? std::max(distance, cuts[part - 1].distance) : distance;
  }
};

/// The parts that a ray adds to a picture: before the first cut, between the cuts and behind the last one.
using CutPixels = std::array<LayerPixel, Cuts::kMost + 1>;

/// The cuts of a sample of a pixel, of layers that the clouds pass through. Throws std::invalid_argument for more than Cuts::kMost layers.
Cuts cutsAt(std::span<const Layer> surfaces, int x, int y, int sample, int samples_per_side);

/// The light that fog scatters around the sun: strength · max(0, v·l)^exponent of the key light's colour is added to the fog's.
struct FogScatter {
  float strength = 0;  ///< ≥ 0
  float exponent = 8;  ///< > 0, after "Elevated" (iq)
};
/// Unit vectors.
Vec3 scatteredLight(Vec3 view, Vec3 to_light, Vec3 light_color, const FogScatter& settings);
/// Its keys in a scene file.
const Keys<FogScatter>& scatterKeys();

/// The haze between the camera and the layers.
struct FogSettings {
  float density = 0;                ///< of 1 − exp(−density·distance), per world unit, ≥ 0; 0 = no fog
  Vec3 color{0.22F, 0.37F, 0.55F};  ///< linear; a scene that gives none has the horizon of its sky
};
/// Its keys in a scene file.
const Keys<FogSettings>& fogKeys();

/// All layers over the background, linear: the mean over the samples of each pixel. A layer with fewer samples than another has each of
/// them several times. In every sample the nearest layer comes first, and equally far ones keep the order given. Each layer's colour is
/// faded to the fog by its distance, whose colour `scattered` adds to, one per pixel, if it is not empty; the background is not. Where
/// every opacity is 0 the background stays exactly the same. Throws std::invalid_argument if a layer has another size than the background,
/// or if the density is negative or not finite.
Image composeLayers(std::span<const Layer> layers, const Image& background, const FogSettings& fog = {},
                    std::span<const Vec3> scattered = {});

}  // namespace cloudbake
