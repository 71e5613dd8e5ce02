// The six faces of a cube around the viewer are divided into n × n cells (u, v in [−1, 1] of the face). A cell has at most one star, at a
// random place, with a probability that follows the solid angle of the cell, dΩ = (1 + u² + v²)^(−3/2) du dv, so that stars are spread
// evenly; the mean of (1 + u² + v²)^(−3/2) over a face is (4π/6)/4 = π/6. The number of stars brighter than F falls as F^(−3/2), as it
// does for stars that are spread evenly in space. A star's light falls as exp(−(distance/width)²).
#include "preview/backdrop/stars.h"

#include <algorithm>
#include <cmath>

#include "core/types.h"
#include "preview/backdrop/lattice_hash.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

// Turns v about an axis (O. Rodrigues 1840).
Vec3 turned(Vec3 v, Vec3 axis, float radians) {
  const float c = std::cos(radians), s = std::sin(radians);
  return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c));
}

/// A place on the cube: its face 0 … 5 and u, v in [−1, 1].
struct CubePlace {
  uint32_t face;
  float u, v;
};

CubePlace placeOnCube(Vec3 d) {
  const float x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
  if (x >= y && x >= z) return {d.x > 0 ? 0U : 1U, d.y / x, d.z / x};
  if (y >= z) return {d.y > 0 ? 2U : 3U, d.z / y, d.x / y};
  return {d.z > 0 ? 4U : 5U, d.x / z, d.y / z};
}

Vec3 directionOf(const CubePlace& place) {
  const float side = place.face % 2 == 0 ? 1 : -1;
  const Vec3 along = place.face < 2   ? Vec3{side, place.u, place.v}
                     : place.face < 4 ? Vec3{place.v, side, place.u}
                                      : Vec3{place.u, place.v, side};
  return along / length(along);
}

// From orange over white to blue.
Vec3 starColor(float draw, float tint) {
  const Vec3 warm{1, 0.72F, 0.46F}, white{1, 1, 1}, cold{0.66F, 0.78F, 1};
  const Vec3 color = draw < 0.5F ? lerp(warm, white, 2 * draw) : lerp(white, cold, 2 * draw - 1);
  return lerp(white, color, tint);
}

}  // namespace

Vec3 starLight(Vec3 view, float sun_height, const StarSettings& settings) {
  const float night = smoothStep(settings.high_height, settings.low_height, sun_height);
  if (!(night > 0) || view.y <= 0) return {};
  const Vec3 own = turned(view, settings.pole, -(settings.turn_degrees + settings.day_turn_degrees) * float(kPi / 180));
  const CubePlace at = placeOnCube(own);

  // The cell's star.
  const auto n = int(std::max(1.0F, std::sqrt(float(settings.count) / float(kPi))));
  const auto cellOf = [n](float w) { return std::clamp(int((w + 1) * 0.5F * float(n)), 0, n - 1); };
  const int column = cellOf(at.u), row = cellOf(at.v);
  const uint32_t cell = hashAlong(hashAlong(hashAlong(mix32(settings.seed), at.face), uint32_t(row)), uint32_t(column));
  const auto draw = [cell](uint32_t what) { return unitFloat(hashAlong(cell, what)); };
  constexpr float kMargin = 0.15F;  // of a cell: a star's light ends before its cell does
  const auto placeIn = [n](int index, float share) { return 2 * (float(index) + lerp(kMargin, 1 - kMargin, share)) / float(n) - 1; };
  const CubePlace star{at.face, placeIn(column, draw(0)), placeIn(row, draw(1))};
  const float square = 1 + star.u * star.u + star.v * star.v;
  if (draw(2) > 1 / (square * std::sqrt(square))) return {};

  constexpr float kFaintest = 0.02F;
  const float flux = std::min(1.0F, kFaintest * std::pow(std::max(draw(3), 1e-6F), -2.0F / 3));
  const float width = settings.size_degrees * float(kPi / 360) / 0.8325546F;  // √ln 2: half the light at half the diameter
  const Vec3 offset = own - directionOf(star);
  const float light = flux * std::exp(-dot(offset, offset) / (width * width));
  const float haze = smoothStep(0, 0.15F, view.y);
  return starColor(draw(4), settings.tint) * (settings.brightness * night * haze * light);
}

// --- Keys ---

const Keys<StarSettings>& starKeys() {
  using S = StarSettings;
  static const Keys<S> keys{
      {"count", &S::count, 100, 1e6, "stars over the whole sky"},
      {"brightness", &S::brightness, 0, kBright, "light of the brightest stars"},
      {"size", &S::size_degrees, 1e-3, 5, "diameter at which a star has half its light, degrees"},
      {"tint", &S::tint, 0, 1, "0: all stars are white; 1: from orange to blue"},
      {"low_height", &S::low_height, -1, 1, "sine of the sun's elevation below which all stars shine"},
      {"high_height", &S::high_height, -1, 1, "sine of the sun's elevation above which no star shines"},
      {"seed", &S::seed, 0, kMostSeed, "selects other stars"},
      {"pole", &S::pole, -1, 1, "the axis about which the sky turns", KeyUse::kComputed},
      {"turn", &S::turn_degrees, -3600, 3600, "turn of the stars about their pole, degrees; [sun] hour adds that of the hour"},
      {"day_turn", &S::day_turn_degrees, -kFar, kFar, "turn of the hour, degrees", KeyUse::kComputed},
  };
  return keys;
}

}  // namespace cloudbake
