// One picture per side is drawn. Means of 2 × 2, 4 × 4, … of its pixels, in linear light, are those of the smaller sizes. The camera is far
// away, so that all of the cloud has one size.
#include "preview/compare/popping.h"

#include <algorithm>
#include <cmath>

#include "preview/camera.h"
#include "preview/mesh_clouds/render.h"

namespace cloudbake {

namespace {

constexpr int kLargestSize = 1024, kHalvings = 6;  // down to 16 pixels
constexpr float kSunAzimuth = 105, kSunElevation = 30, kCameraAzimuths[] = {60, 240}, kCameraElevation = 6;

// A plain sky of this measure's own, so that the levels of an asset do not depend on how skies are drawn: zenith, horizon, ground, sun,
// ambient light from above and from below, low sky.
constexpr SkyColors kColors{{0.016F, 0.07F, 0.27F}, {0.22F, 0.37F, 0.55F},    {0.05F, 0.08F, 0.105F}, {1.08F, 0.96F, 0.78F},
                            {0.09F, 0.15F, 0.27F},  {0.028F, 0.045F, 0.082F}, {0.22F, 0.37F, 0.55F}};

// A far camera, for which the longest side of the box covers kLargestSize pixels. Its picture holds the whole box, and can be halved
// kHalvings times.
Camera cameraFrom(const Box& box, float azimuth) {
  constexpr float kFieldOfViewDegrees = 5, kMargin = 1.05F;
  const float units_per_pixel = box.longestSide() / kLargestSize;
  Camera camera{box.center() + directionFromAngles(azimuth, kCameraElevation), box.center(), kFieldOfViewDegrees};
  const CameraAxes axes = cameraAxes(camera);
  Vec2 half;
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner = (box.corner(i) - box.center()) / units_per_pixel;
    half = {std::max(half.x, kMargin * std::abs(dot(corner, axes.right))), std::max(half.y, kMargin * std::abs(dot(corner, axes.up)))};
  }
  const int step = 1 << kHalvings;
  camera.width = (int(2 * half.x) / step + 1) * step, camera.height = (int(2 * half.y) / step + 1) * step;
  const float distance = float(camera.height) * units_per_pixel / (2 * std::tan(kFieldOfViewDegrees * float(kPi / 360)));
  camera.look_from = box.center() - axes.forward * distance;
  return camera;
}

Image drawn(const BakedMesh& mesh, const Camera& camera, const Image* sky = nullptr) {
  LightSettings light = lightForSun(kSunAzimuth, kSunElevation);
  light.samples_per_side = 1;
  light.sky.colors = kColors;
  light.sky.horizon_exponent = 8;
  light.sky.glow = 0.25F;
  return renderLobe(mesh, camera, light, sky);
}

// Linear colours, the same as they are shown, and in `shows` 1 where there is the mesh.
struct Picture {
  Image colors, tones;
  std::vector<uint8_t> shows;
};

// Rays that miss the mesh differ from those of the sky in their last bits.
constexpr float kSeen = 1e-3F;

Picture pictureOf(const BakedMesh& mesh, const Camera& camera, const Image& sky) {
  Picture picture{drawn(mesh, camera, &sky), {}, {}};
  picture.tones = toneMap(picture.colors);
  for (size_t i = 0; i < sky.pixels.size(); ++i) picture.shows.push_back(length(picture.colors.pixels[i] - sky.pixels[i]) > kSeen);
  return picture;
}

Picture halved(const Picture& picture) {
  const int width = picture.colors.width / 2, height = picture.colors.height / 2;
  Picture half{blankImage(width, height), {}, std::vector<uint8_t>(size_t(width) * size_t(height))};
  for (int y = 0; y < 2 * height; ++y)
    for (int x = 0; x < 2 * width; ++x) {
      half.colors.at(x / 2, y / 2) += picture.colors.at(x, y) / 4;
      half.shows[size_t(y / 2) * size_t(width) + size_t(x / 2)] |= picture.shows[size_t(y) * 2 * size_t(width) + size_t(x)];
    }
  half.tones = toneMap(half.colors);
  return half;
}

float rmsBetween(const Picture& a, const Picture& b) {
  double squares = 0;
  size_t count = 0;
  for (size_t i = 0; i < a.shows.size(); ++i) {
    if (!a.shows[i] && !b.shows[i]) continue;
    const Vec3 difference = (a.tones.pixels[i] - b.tones.pixels[i]) * 255;
    squares += double(dot(difference, difference)) / 3;
    ++count;
  }
  return float(std::sqrt(squares / double(std::max<size_t>(1, count))));
}

}  // namespace

std::vector<std::vector<SizeChange>> popping(const BakedMesh& full, std::span<const BakedMesh> levels) {
  std::vector<std::vector<SizeChange>> all(levels.size(), std::vector<SizeChange>(kHalvings + 1));
  for (const float azimuth : kCameraAzimuths) {
    const Camera camera = cameraFrom(drawnBox(full.surface), azimuth);
    const Image sky = drawn({}, camera);
    std::vector<Picture> of_full{pictureOf(full, camera, sky)};
    for (int i = 0; i < kHalvings; ++i) of_full.push_back(halved(of_full.back()));
    for (size_t level = 0; level < levels.size(); ++level) {
      Picture picture = pictureOf(levels[level], camera, sky);
      for (int i = 0; i <= kHalvings; ++i) {
        SizeChange& change = all[level][size_t(i)];
        change = {float(kLargestSize >> i), std::max(change.rms, rmsBetween(of_full[size_t(i)], picture))};
        picture = halved(picture);
      }
    }
  }
  return all;
}

int switchPixels(std::span<const SizeChange> changes, float most) {
  if (changes.empty() || changes.back().rms > most) return 0;
  size_t above = changes.size();  // the smallest size with too large a change comes before it
  while (above > 0 && changes[above - 1].rms <= most) --above;
  if (above == 0) return kLargestSwitch;
  const SizeChange &larger = changes[above - 1], &smaller = changes[above];
  const double share = smaller.rms > 0 ? std::log(most / smaller.rms) / std::log(larger.rms / smaller.rms) : 0;
  const double pixels = smaller.pixels * std::pow(larger.pixels / smaller.pixels, share);
  int digit = 1;
  while (pixels >= 100 * digit) digit *= 10;
  return int(pixels) / digit * digit;
}

}  // namespace cloudbake
