// One picture per side is drawn. Means of 2 × 2, 4 × 4, … of its pixels, in linear light, are those of the smaller sizes. The camera is far
// away, so that all of the cloud has one size.
#include "preview/compare/popping.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "preview/camera.h"
#include "preview/mesh_clouds/impostor.h"
#include "preview/mesh_clouds/render.h"

namespace cloudbake {

namespace {

constexpr int kLargestSize = 1024, kHalvings = 6;  // down to 16 pixels
constexpr float kSunAzimuth = 105, kSunElevation = 30, kCameraAzimuths[] = {60, 240}, kCameraElevation = 6;

// A plain sky of this measure's own, so that the levels of an asset do not depend on how skies are drawn: zenith, horizon, ground, sun,
// ambient light from above and from below, low sky.
constexpr SkyColors kColors{{0.016F, 0.07F, 0.27F}, {0.22F, 0.37F, 0.55F},    {0.05F, 0.08F, 0.105F}, {1.08F, 0.96F, 0.78F},
                            {0.09F, 0.15F, 0.27F},  {0.028F, 0.045F, 0.082F}, {0.22F, 0.37F, 0.55F}};

// A far camera, for which the longest side of the box covers so many pixels. Its picture holds the whole box, and can be halved
// kHalvings times.
Camera cameraFrom(const Box& box, float azimuth, int pixels = kLargestSize) {
  constexpr float kFieldOfViewDegrees = 5, kMargin = 1.05F;
  const float units_per_pixel = box.longestSide() / float(pixels);
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

Image drawn(const BakedMesh& mesh, const Camera& camera, float half_lambert, const Image* sky = nullptr) {
  LightSettings light = lightForSun(kSunAzimuth, kSunElevation);
  light.half_lambert = half_lambert;
  light.samples_per_side = 1;
  light.sky.colors = kColors;
  light.sky.horizon_exponent = 8;
  light.sky.glow = 0.25F;
  return mesh.impostor ? renderImpostor(*mesh.impostor, camera, light) : renderLobe(mesh, camera, light, sky);
}

// The sky around a cloud and its halvings, from the largest size to the smallest one: linear colours, and the same as they are shown.
struct Skies {
  std::vector<Image> colors, tones;
};

Skies skiesOf(Image sky) {
  Skies skies;
  for (int i = 0;; ++i) {
    skies.tones.push_back(toneMap(sky));
    skies.colors.push_back(std::move(sky));
    if (i == kHalvings) return skies;
    sky = halved(skies.colors.back());
  }
}

// One size of a picture, with 1 in `shows` where there is the mesh.
struct Picture {
  Image colors, tones;
  std::vector<uint8_t> shows;
};

// Only the columns between the first and the last one of a row that show the mesh are toned. The others are those of the sky.
Image tonesOf(const Image& colors, const std::vector<uint8_t>& shows, const Image& sky) {
  Image tones = sky;
  parallelFor(colors.height, [&](int y) {
    const auto row = std::span(shows).subspan(size_t(y) * size_t(colors.width), size_t(colors.width));
    const int first = int(std::find(row.begin(), row.end(), 1) - row.begin());
    int end = colors.width;
    while (end > first && row[size_t(end - 1)] == 0) --end;
    std::copy_n(&colors.pixels[size_t(y) * size_t(colors.width)] + first, end - first, &tones.at(0, y) + first);
    toneRow(std::span(&tones.at(0, y) + first, size_t(end - first)));
  });
  return tones;
}

// 1 for each pixel that shows more than the sky.
std::vector<uint8_t> showsOf(const Image& picture, const Image& sky) {
  constexpr float kSeen = 1e-3F;  // of an opacity
  std::vector<uint8_t> shows(sky.pixels.size());
  for (size_t i = 0; i < sky.pixels.size(); ++i) shows[i] = length(picture.pixels[i] - sky.pixels[i]) > kSeen;
  return shows;
}

// At one of the sizes of the skies.
Picture pictureOf(const BakedMesh& mesh, const Camera& camera, float half_lambert, const Skies& skies, size_t size = 0) {
  const Image& sky = skies.colors[size];
  Picture picture{drawn(mesh, camera, half_lambert, &sky), {}, {}};
  picture.shows = showsOf(picture.colors, sky);
  picture.tones = tonesOf(picture.colors, picture.shows, skies.tones[size]);
  return picture;
}

// `half`: of the smaller picture's size, among the skies.
Picture halved(const Picture& picture, const Image& half_sky) {
  Picture half{halved(picture.colors), {}, std::vector<uint8_t>(half_sky.pixels.size())};
  for (int y = 0; y < picture.colors.height; ++y)
    for (int x = 0; x < picture.colors.width; ++x)
      half.shows[size_t(y / 2) * size_t(half_sky.width) + size_t(x / 2)] |=
          picture.shows[size_t(y) * size_t(picture.colors.width) + size_t(x)];
  half.tones = tonesOf(half.colors, half.shows, half_sky);
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

struct Popping::Side {
  Camera camera;
  Skies skies;
  std::vector<Picture> full;  // from the largest size to the smallest one
};

Popping::Popping(const BakedMesh& full, float half_lambert) : half_lambert_(half_lambert), sides_(std::size(kCameraAzimuths)) {
  parallelFor(sides_.size(), [&](size_t i) {
    Side& side = sides_[i];
    side.camera = cameraFrom(drawnBox(full.surface), kCameraAzimuths[i]);
    side.skies = skiesOf(drawn({}, side.camera, half_lambert_));
    side.full.push_back(pictureOf(full, side.camera, half_lambert_, side.skies));
    for (size_t half = 1; half <= kHalvings; ++half) side.full.push_back(halved(side.full.back(), side.skies.tones[half]));
  });
}

Popping::~Popping() = default;

std::vector<SizeChange> Popping::changesBy(const BakedMesh& level) const {
  if (level.impostor) return changesByImpostor(level);
  std::vector<SizeChange> changes(kHalvings + 1);
  for (const Side& side : sides_) {
    Picture picture = pictureOf(level, side.camera, half_lambert_, side.skies);
    for (size_t i = 0; i <= kHalvings; ++i) {
      if (i > 0) picture = halved(picture, side.skies.tones[i]);
      changes[i] = {float(kLargestSize >> i), std::max(changes[i].rms, rmsBetween(side.full[i], picture))};
    }
  }
  return changes;
}

// Its mip levels follow the size, so that small pictures of it are not means of large ones.
std::vector<SizeChange> Popping::changesByImpostor(const BakedMesh& level) const {
  std::vector<SizeChange> changes;
  for (size_t i = 0; i <= kHalvings; ++i) {
    const int pixels = kLargestSize >> i;
    if (pixels > kLargestOfImpostors) continue;
    SizeChange change{float(pixels), 0};
    for (const Side& side : sides_) {
      Camera camera = side.camera;
      camera.width >>= i, camera.height >>= i;
      change.rms = std::max(change.rms, rmsBetween(side.full[i], pictureOf(level, camera, half_lambert_, side.skies, i)));
    }
    changes.push_back(change);
  }
  return changes;
}

struct SidePictures::Side {
  Camera camera;
  Image sky;  // with one ray per pixel, twice as large
  Image half_sky, half_tones;
};

SidePictures::SidePictures(const Box& box, int pixels) : sides_(std::size(kCameraAzimuths)) {
  parallelFor(sides_.size(), [&](size_t i) {
    Side& side = sides_[i];
    side.camera = cameraFrom(box, kCameraAzimuths[i], 2 * pixels);
    side.sky = drawn({}, side.camera, LightSettings{}.half_lambert);
    side.half_sky = halved(side.sky);
    side.half_tones = toneMap(side.half_sky);
  });
}

SidePictures::~SidePictures() = default;

SidePictures::Taken SidePictures::of(const BakedMesh& mesh) const {
  std::vector<Taken> taken(sides_.size());
  parallelFor(sides_.size(), [&](size_t i) {
    const Side& side = sides_[i];
    const Image half = halved(drawn(mesh, side.camera, LightSettings{}.half_lambert, &side.sky));
    taken[i].shows = showsOf(half, side.half_sky);
    for (const Vec3& tone : tonesOf(half, taken[i].shows, side.half_tones).pixels) {
      const auto byte = [](float value) { return uint8_t(std::lround(255 * std::clamp(value, 0.0F, 1.0F))); };
      taken[i].values.push_back({byte(tone.x), byte(tone.y), byte(tone.z)});
    }
  });
  for (size_t i = 1; i < taken.size(); ++i) {
    taken[0].values.insert(taken[0].values.end(), taken[i].values.begin(), taken[i].values.end());
    taken[0].shows.insert(taken[0].shows.end(), taken[i].shows.begin(), taken[i].shows.end());
  }
  return taken[0];
}

float SidePictures::rmsBetween(const Taken& a, const Taken& b) {
  double squares = 0;
  size_t count = 0;
  for (size_t p = 0; p < a.shows.size(); ++p) {
    if (!a.shows[p] && !b.shows[p]) continue;
    for (size_t channel = 0; channel < 3; ++channel) {
      const double difference = double(a.values[p][channel]) - b.values[p][channel];
      squares += difference * difference / 3;
    }
    ++count;
  }
  return float(std::sqrt(squares / double(std::max<size_t>(1, count))));
}

float changeAt(std::span<const SizeChange> changes, float pixels) {
  if (changes.empty()) return 0;
  if (pixels >= changes.front().pixels) return changes.front().rms;
  for (size_t i = 1; i < changes.size(); ++i) {
    const SizeChange &larger = changes[i - 1], &smaller = changes[i];
    if (pixels < smaller.pixels) continue;
    const float share = std::log(pixels / smaller.pixels) / std::log(larger.pixels / smaller.pixels);
    return smaller.rms > 0 ? smaller.rms * std::pow(larger.rms / smaller.rms, share) : share * larger.rms;
  }
  return changes.back().rms;
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
