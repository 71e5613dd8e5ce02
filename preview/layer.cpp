// T. Porter, T. Duff, "Compositing Digital Images" (SIGGRAPH 1984): "over" from front to back,
//   C = Σ T_i a_i c_i + T background,  T_i = Π_{j nearer than i} (1 − a_j),
// with every c_i seen through the fog of its distance d: c = lerp(colour, fog, 1 − exp(−density·d)).
#include "preview/layer.h"

#include <algorithm>
#include <stdexcept>

#include "core/parallel.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

// A pixel without a distance is behind all fog, if there is fog.
Vec3 foggedColor(const LayerPixel& pixel, const FogSettings& fog) {
  return fog.density > 0 ? lerp(pixel.color, fog.color, 1 - std::exp(-fog.density * pixel.distance)) : pixel.color;
}

// Reorders `pixels`.
Vec3 overBackground(std::vector<LayerPixel>& pixels, Vec3 background, const FogSettings& fog) {
  if (pixels.empty()) return background;
  std::stable_sort(pixels.begin(), pixels.end(), [](const LayerPixel& a, const LayerPixel& b) { return a.distance < b.distance; });
  Vec3 color;
  float transparency = 1;
  for (const LayerPixel& pixel : pixels) {
    color += foggedColor(pixel, fog) * (transparency * pixel.opacity);
    transparency *= 1 - pixel.opacity;
  }
  return color + background * transparency;
}

}  // namespace

Cuts cutsAt(std::span<const Layer> surfaces, int x, int y, int sample, int samples_per_side) {
  if (surfaces.size() > size_t(Cuts::kMost)) throw std::invalid_argument("cutsAt: too many surfaces");
  Cuts cuts;
  for (const Layer& surface : surfaces) {
    const LayerPixel& pixel = surface.at(x, y, surface.sampleFor(sample, samples_per_side));
    if (!(pixel.opacity > 0) || !std::isfinite(pixel.distance)) continue;
    cuts.cuts[size_t(cuts.count++)] = {pixel.distance, pixel.opacity >= 1};
  }
  std::stable_sort(cuts.cuts.begin(), cuts.cuts.begin() + cuts.count,
                   [](const Cuts::Cut& a, const Cuts::Cut& b) { return a.distance < b.distance; });
  return cuts;
}

Vec3 scatteredLight(Vec3 view, Vec3 to_light, Vec3 light_color, const FogScatter& settings) {
  if (!(settings.strength > 0)) return {};
  return light_color * (settings.strength * std::pow(std::max(0.0F, dot(view, to_light)), settings.exponent));
}

Image composeLayers(std::span<const Layer> layers, const Image& background, const FogSettings& fog, std::span<const Vec3> scattered) {
  if (!(fog.density >= 0) || !std::isfinite(fog.density)) throw std::invalid_argument("composeLayers: the fog's density is out of range");
  int most = 1;  // samples to a side
  for (const Layer& layer : layers) {
    if (layer.width != background.width || layer.height != background.height ||
        layer.pixels.size() != background.pixels.size() * size_t(layer.samples()))
      throw std::invalid_argument("composeLayers: a layer is not of the background's size");
    most = std::max(most, layer.samples_per_side);
  }

  if (!scattered.empty() && scattered.size() != background.pixels.size())
    throw std::invalid_argument("composeLayers: not one scattered light per pixel");
  Image image = background;
  parallelFor(image.height, [&](int y) {
    std::vector<LayerPixel> pixels;
    for (int x = 0; x < image.width; ++x) {
      Vec3 sum;
      bool is_empty = true;
      FogSettings here = fog;
      if (!scattered.empty()) here.color += scattered[size_t(y) * size_t(image.width) + size_t(x)];
      for (int sample = 0; sample < most * most; ++sample) {
        pixels.clear();
        for (const Layer& layer : layers) {
          const LayerPixel& pixel = layer.at(x, y, layer.sampleFor(sample, most));
          if (pixel.opacity > 0) pixels.push_back(pixel);
        }
        is_empty = is_empty && pixels.empty();
        sum += overBackground(pixels, background.at(x, y), here);
      }
      if (!is_empty) image.at(x, y) = sum / float(most * most);
    }
  });
  return image;
}

// --- Keys ---

const Keys<FogSettings>& fogKeys() {
  using S = FogSettings;
  static const Keys<S> keys{
      {"per_unit", &S::density, 0, 1e6, "density of the fog over the whole scene, 1 − exp(−per_unit·distance)"},
      {"color", &S::color, 0, kBright, "colour of both fogs; unset: that of the horizon"},
  };
  return keys;
}

const Keys<FogScatter>& scatterKeys() {
  using S = FogScatter;
  static const Keys<S> keys{
      {"scatter", &S::strength, 0, kBright,
       "s of the light s·max(0, v·l)^e, times the sun's, that is added to the fog's colour; 0.3 in the source"},
      {"scatter_exponent", &S::exponent, 1e-3, 1e4, "e of that light"},
  };
  return keys;
}

}  // namespace cloudbake
