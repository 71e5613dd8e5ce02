// Box filters of any width by sums: the image is taken as constant over each pixel, S(t) is its integral from the border to t, and the mean
// over [x − h, x + h] is (S(x + h) − S(x − h)) / 2h (F. Crow, "Summed-Area Tables for Texture Mapping", SIGGRAPH 1984, in one dimension).
#include "preview/mesh_clouds/paint.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "preview/backdrop/noise_kernels.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

// S at a place of a line, from its values at whole numbers.
Rgba integralAt(const Rgba* sums, size_t step, float place) {
  const int whole = int(place);
  const float part = place - float(whole);
  const Rgba &low = sums[size_t(whole) * step], &high = sums[size_t(whole) * step + (part > 0 ? step : 0)];
  Rgba value;
  for (size_t c = 0; c < 4; ++c) value[c] = low[c] + part * (high[c] - low[c]);
  return value;
}

// The mean of a line of `count` pixels about the centre of pixel i. Windows end at the border.
Rgba meanAbout(const Rgba* sums, size_t step, int count, int i, float half_width) {
  const float center = float(i) + 0.5F, low = std::max(0.0F, center - half_width), high = std::min(float(count), center + half_width);
  const Rgba a = integralAt(sums, step, low), b = integralAt(sums, step, high);
  const float scale = 1 / (high - low);
  Rgba mean;
  for (size_t c = 0; c < 4; ++c) mean[c] = (b[c] - a[c]) * scale;
  return mean;
}

template <typename Pixel>
void forEachPixel(const PixelBox& box, const Pixel& pixel) {
  for (int y = box.top; y < box.bottom; ++y)
    for (int x = box.left; x < box.right; ++x) pixel(x, y);
}

void addTo(Rgba& sum, const Rgba& more) {
  for (size_t c = 0; c < 4; ++c) sum[c] += more[c];
}

// One box along rows, then one along columns, of the pixels in `box`, beyond which they count as 0; half_width(x, y) in pixels, ≥ 1/2.
template <typename HalfWidth>
void boxBlur(Image4& image, const PixelBox& box, const HalfWidth& half_width) {
  parallelBlocks(box.top, box.bottom, 1, [&](int top, int bottom) {
    std::vector<Rgba> sums(size_t(image.width) + 1);
    for (int y = top; y < bottom; ++y) {
      for (int x = box.left; x < box.right; ++x) {
        sums[size_t(x) + 1] = sums[size_t(x)];
        addTo(sums[size_t(x) + 1], image.at(x, y));
      }
      std::fill(sums.begin() + box.right + 1, sums.end(), sums[size_t(box.right)]);
      for (int x = box.left; x < box.right; ++x) image.at(x, y) = meanAbout(sums.data(), 1, image.width, x, half_width(x, y));
    }
  });
  constexpr int kStrip = 32;  // columns at once
  parallelFor((box.width() + kStrip - 1) / kStrip, [&](int strip) {
    const int left = box.left + strip * kStrip, right = std::min(left + kStrip, box.right);
    std::vector<Rgba> sums((size_t(image.height) + 1) * kStrip);
    const auto row = [&](int y) { return sums.begin() + y * kStrip; };
    for (int y = box.top; y < box.bottom; ++y)
      for (int x = left; x < right; ++x) {
        Rgba& next = row(y + 1)[x - left];
        next = row(y)[x - left];
        addTo(next, image.at(x, y));
      }
    for (int y = box.bottom; y < image.height; ++y) std::copy_n(row(box.bottom), kStrip, row(y + 1));
    for (int y = box.top; y < box.bottom; ++y)
      for (int x = left; x < right; ++x) image.at(x, y) = meanAbout(sums.data() + (x - left), kStrip, image.height, y, half_width(x, y));
  });
}

// The largest difference of A between the pixel and its four neighbours.
float slopeOfDepth(const Image4& image, int x, int y) {
  const float here = image.at(x, y)[3];
  const auto step = [&](int i, int j) {
    return std::abs(image.at(std::clamp(i, 0, image.width - 1), std::clamp(j, 0, image.height - 1))[3] - here);
  };
  return std::max({step(x - 1, y), step(x + 1, y), step(x, y - 1), step(x, y + 1)});
}

}  // namespace

Image4 spreadDepth(Image4 image, float radius) {
  const float half_width = std::max(0.5F, radius * float(image.height));
  const PixelBox box = cloudBox(image, half_width + 1);
  Image4 depth = filledImage4(image.width, image.height, {});
  forEachPixel(box, [&](int x, int y) {
    const Rgba& p = image.at(x, y);
    depth.at(x, y) = {p[2] * p[3], 0, p[2], 0};
  });
  boxBlur(depth, box, [&](int, int) { return half_width; });
  forEachPixel(box, [&](int x, int y) {
    const Rgba& mean = depth.at(x, y);
    image.at(x, y)[3] = mean[2] > 1e-4F ? mean[0] / mean[2] : 1;
  });
  return image;
}

Image4 soften(Image4 image, const SoftenSettings& settings) {
  const float widest = std::max(0.5F, float(image.height) * std::max(settings.near_width, settings.far_width));
  const PixelBox box = cloudBox(image, 2 * widest + 2);
  std::vector<float> depths(size_t(box.width()) * size_t(box.bottom - box.top));
  const auto depthAt = [&](int x, int y) -> float& { return depths[size_t(y - box.top) * size_t(box.width()) + size_t(x - box.left)]; };
  forEachPixel(box, [&](int x, int y) {
    Rgba& p = image.at(x, y);
    depthAt(x, y) = p[3];
    p = {p[0] * p[2], p[1] * p[2], p[2], 0};
  });
  const auto half_width = [&](int x, int y) {
    return std::max(0.5F, float(image.height) * lerp(settings.near_width, settings.far_width, std::min(1.0F, depthAt(x, y))));
  };
  for (int pass = 0; pass < 2; ++pass) boxBlur(image, box, half_width);
  forEachPixel(box, [&](int x, int y) {
    Rgba& p = image.at(x, y);
    const float depth = depthAt(x, y);
    p = p[2] > 1e-4F ? Rgba{p[0] / p[2], p[1] / p[2], std::min(p[2], 1.0F), depth} : Rgba{0, 0, 0, depth};
  });
  return image;
}

Image4 erode(Image4 image, const Camera& camera, const DepthRange& range, const NoiseFrame& frame, const ErodeSettings& settings) {
  const CameraRays rays(camera);
  const Vec3 forward = cameraAxes(camera).forward, from = camera.look_from - frame.origin;
  FbmSettings octaves = kErosionNoise;
  octaves.seed = settings.seed;
  const float cells_per_depth = (range.far - range.near) / frame.size;
  const float mid_x = 0.5F * float(image.width), mid_y = 0.5F * float(image.height);
  const float cells_per_unit = length(rays.at(mid_x + 1, mid_y).direction - rays.at(mid_x, mid_y).direction) / frame.size;
  parallelFor(image.height, [&](int y) {
    std::vector<int> columns;  // of the pixels that are neither clear nor opaque
    std::vector<float> place_x, place_y, place_z, strengths;
    for (int x = 0; x < image.width; ++x) {
      const Rgba& p = image.at(x, y);
      if (!(p[2] > 0) || p[2] >= 1) continue;
      const Ray ray = rays.at(float(x) + 0.5F, float(y) + 0.5F);
      const float depth = lerp(range.near, range.far, p[3]), distance = depth / dot(ray.direction, forward);
      const Vec3 place = (from + ray.direction * distance) / frame.size;
      if (!(std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)}) < kMostCells)) continue;
      const float footprint = slopeOfDepth(image, x, y) * cells_per_depth + depth * cells_per_unit;
      columns.push_back(x);
      strengths.push_back(1 - smoothStep(kFadingFrom, kFadingTo, footprint));
      place_x.push_back(place.x), place_y.push_back(place.y), place_z.push_back(place.z);
    }
    std::vector<float> noises(columns.size());
    const std::vector<float> no_limits(columns.size(), INFINITY);
    fbmValues3(place_x.data(), place_y.data(), place_z.data(), no_limits.data(), columns.size(), octaves, noises.data());
    for (size_t i = 0; i < columns.size(); ++i) {
      Rgba& p = image.at(columns[i], y);
      const float noise = lerp(0.5F, smoothStep(0.25F, 0.75F, noises[i]), strengths[i]), taken = settings.shrink * noise;
      const float opacity = saturate((p[2] - taken) / (1 - taken));
      const float dark = 1 - settings.darkening * noise * (1 - opacity);
      p[0] *= dark, p[1] *= dark, p[2] = opacity;  // other rows read the depth
    }
  });
  return image;
}

// --- Keys ---

const Keys<PaintedSteps>& paintedKeys() {
  using S = PaintedSteps;
  static const Keys<S> keys{
      {"depth_spread", &S::depth_spread, 0, 1, "how far a cloud's depth extends beyond it, heights of the picture"},
      {"detail_size", &S::detail_size, 1e-4, 1e3, "cells of the erosion's noise, longest sides of a cloud"},
  };
  return keys;
}

const Keys<SoftenSettings>& softenKeys() {
  using S = SoftenSettings;
  static const Keys<S> keys{
      {"near_width", &S::near_width, 0, 1, "half width of the blur at depth 0, heights of the picture"},
      {"far_width", &S::far_width, 0, 1, "half width of the blur at depth 1, heights of the picture"},
  };
  return keys;
}

const Keys<ErodeSettings>& erodeKeys() {
  using S = ErodeSettings;
  static const Keys<S> keys{
      {"detail_shrink", &S::shrink, 0, 0.99, "largest opacity that the erosion's noise takes away"},
      {"detail_darkening", &S::darkening, 0, 1, "darkening where the noise takes most"},
  };
  return keys;
}

}  // namespace cloudbake
