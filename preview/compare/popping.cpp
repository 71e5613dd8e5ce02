// A picture of a large size is judged by a sample of its pixels, which are spread evenly over it. Each is drawn with as many rays as
// preview takes, because edges that move by a part of a pixel count by that part. The camera is far away, so that all of the cloud has one
// size.
#include "preview/compare/popping.h"

#include <algorithm>
#include <cmath>

#include "preview/camera.h"
#include "preview/mesh_clouds/render.h"

namespace cloudbake {

namespace {

constexpr float kLargestSize = 4096, kSmallestSize = 16;
constexpr int kSampledPerSide = 64;  // pixels per row and column of a picture that has more
constexpr float kFieldOfViewDegrees = 5;
constexpr float kSunAzimuth = 105, kSunElevation = 30, kCameraElevation = 6;

LightSettings light() { return lightForSun(kSunAzimuth, kSunElevation); }

// A camera for which the longest side of the box covers so many pixels, with the whole box in view.
Camera cameraFrom(const Box& box, float azimuth, float size) {
  const float units_per_pixel = box.longestSide() / size;
  const int width = int(std::ceil(1.1F * box.diagonal() / units_per_pixel));
  const float distance = 0.5F * float(width) * units_per_pixel / std::tan(kFieldOfViewDegrees * float(kPi / 360));
  return {box.center() + directionFromAngles(azimuth, kCameraElevation) * distance, box.center(), kFieldOfViewDegrees, width, width};
}

}  // namespace

Popping::Popping(const BakedMesh& full) {
  const Box box = drawnBox(full.surface);
  const std::vector<Vec2> places = pixelPlaces(light().samples_per_side);
  for (float size = kLargestSize; size >= kSmallestSize; size /= 2)
    for (size_t side = 0; side < 4; ++side) {
      const Camera camera = cameraFrom(box, kSunAzimuth + 90 * float(side), size);
      const CameraRays rays(camera);
      const int count = std::min(camera.width, kSampledPerSide);
      const auto pixelAt = [&](int i) { return float((2 * int64_t(i) + 1) * camera.width / (2 * count)); };
      pictures_.push_back({size, side, rays_.size() / places.size(), size_t(count) * size_t(count)});
      for (int y = 0; y < count; ++y)
        for (int x = 0; x < count; ++x)
          for (const Vec2 place : places) rays_.push_back(rays.at(pixelAt(x) + place.x, pixelAt(y) + place.y));
    }
  tones_ = tonesOf(full, shows_);
}

// The tones of all pixels, 0 to 1, and whether they show the mesh.
std::vector<Vec3> Popping::tonesOf(const BakedMesh& mesh, std::vector<bool>& shows) const {
  const LightSettings by = light();
  const std::vector<Vec3> colors = lobeColors(mesh, rays_, by);
  const size_t per_pixel = pixelPlaces(by.samples_per_side).size();
  Image pixels = blankImage(int(colors.size() / per_pixel), 1);
  shows.assign(pixels.pixels.size(), false);
  for (size_t i = 0; i < colors.size(); ++i) {
    pixels.pixels[i / per_pixel] += colors[i] / float(per_pixel);
    if (colors[i] != skyColor(rays_[i].direction, by.sky)) shows[i / per_pixel] = true;
  }
  return toneMap(std::move(pixels)).pixels;
}

std::vector<SizeChange> Popping::of(const BakedMesh& level) const {
  std::vector<bool> shows;
  const std::vector<Vec3> tones = tonesOf(level, shows);
  std::vector<SizeChange> changes;
  for (const Pixels& picture : pictures_) {
    double squares = 0;
    size_t count = 0;
    for (size_t i = picture.first; i < picture.first + picture.count; ++i) {
      if (!shows_[i] && !shows[i]) continue;
      const Vec3 difference = (tones[i] - tones_[i]) * 255;
      squares += double(dot(difference, difference)) / 3;
      ++count;
    }
    if (picture.side == 0) changes.push_back({picture.size, 0});
    changes.back().rms = std::max(changes.back().rms, float(std::sqrt(squares / double(std::max<size_t>(1, count)))));
  }
  return changes;
}

int switchPixels(std::span<const SizeChange> changes, float most) {
  float pixels = 0;
  for (size_t i = changes.size(); i-- > 0; pixels = changes[i].pixels) {
    if (changes[i].rms <= most) continue;
    if (i + 1 == changes.size()) return 0;
    const SizeChange &larger = changes[i], &smaller = changes[i + 1];
    if (smaller.rms > 0)
      pixels *= std::pow(larger.pixels / smaller.pixels, std::log(most / smaller.rms) / std::log(larger.rms / smaller.rms));
    break;
  }
  int digit = 1;
  while (pixels >= float(100 * digit)) digit *= 10;
  return int(pixels) / digit * digit;
}

}  // namespace cloudbake
