// The steps are those of the renderer of maajor/Mesh-Cloud-Rendering: places of a grid with probability and jitter, random turns and sizes,
// a wind that wraps around, clouds that are smaller and lower towards the horizon. A grid of one jittered place per cell is stratified
// sampling: it has neither the clumps nor the gaps of independent places.
#include "preview/mesh_clouds/scatter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/random.h"

namespace cloudbake {

namespace {

std::array<double, 3> parts(Vec3 v) { return {v.x, v.y, v.z}; }

/// The random numbers of a place.
class Draws {
 public:
  Draws(uint64_t seed, uint32_t place) : stream_(mix64((seed + 1) * kGolden64)), place_(place) {}
  /// In 0 … 1, without 1.
  double next() { return uniformDouble(hashDraw(stream_, place_, dimension_++)); }

 private:
  uint64_t stream_;
  uint32_t place_, dimension_ = 0;
};

/// The places of a grid: rows along x of almost equal numbers of cells, which are about square.
class Grid {
 public:
  explicit Grid(const ScatterSettings& settings) : count_(settings.count) {
    const double width = double(settings.high.x) - settings.low.x, depth = double(settings.high.z) - settings.low.z;
    rows_ = uint64_t(std::clamp(std::round(std::sqrt(double(count_) * depth / width)), 1.0, double(count_)));
  }
  /// Calls visit(place, the shares of the box along x and z at which its cell begins, the shares that it takes).
  template <typename Visit>
  void visit(const Visit& visit) const {
    uint32_t place = 0;
    for (uint64_t row = 0; row < rows_; ++row) {
      const uint64_t columns = (row + 1) * count_ / rows_ - row * count_ / rows_;
      const double across = 1 / double(columns), along = 1 / double(rows_);
      for (uint64_t column = 0; column < columns; ++column, ++place)
        visit(place, std::array{double(column) * across, double(row) * along}, std::array{across, along});
    }
  }

 private:
  uint64_t count_, rows_;
};

// The squared distance of two places; along an axis of the wind the nearer way around counts.
double squaredDistance(const ScatterSettings& settings, Vec3 p, Vec3 q) {
  const std::array<double, 3> a = parts(p), b = parts(q), low = parts(settings.low), high = parts(settings.high),
                              drift = parts(settings.drift);
  double sum = 0;
  for (size_t axis = 0; axis < 3; ++axis) {
    double way = std::abs(a[axis] - b[axis]);
    if (drift[axis] != 0) way = std::min(way, high[axis] - low[axis] - way);
    sum += way * way;
  }
  return sum;
}

uint32_t drawn(std::span<const double> weights, double share) {
  double left = share * std::accumulate(weights.begin(), weights.end(), 0.0);
  for (size_t i = 0; i + 1 < weights.size(); ++i) {
    if (left < weights[i]) return uint32_t(i);
    left -= weights[i];
  }
  return uint32_t(weights.size() - 1);
}

}  // namespace

std::vector<ScatteredCloud> scatterClouds(const ScatterSettings& settings, std::span<const double> weights) {
  const std::array<double, 3> low = parts(settings.low), high = parts(settings.high);
  const double least = double(settings.minimum_distance) * settings.minimum_distance;
  std::vector<ScatteredCloud> clouds;
  Grid(settings).visit([&](uint32_t place, const std::array<double, 2>& begin, const std::array<double, 2>& cell) {
    Draws draws(settings.seed, place);
    const bool is_there = draws.next() < settings.probability;
    const auto at = [&](size_t axis, double from, double share) {
      const double within = 0.5 + settings.jitter * (draws.next() - 0.5);
      return float(low[axis] + (high[axis] - low[axis]) * (from + share * within));
    };
    ScatteredCloud cloud;
    cloud.place.x = at(0, begin[0], cell[0]), cloud.place.y = at(1, 0, 1), cloud.place.z = at(2, begin[1], cell[1]);
    cloud.turn_degrees = float(settings.turn_degrees * (2 * draws.next() - 1));
    cloud.size = float(settings.size.x + (settings.size.y - settings.size.x) * draws.next());
    cloud.mesh = drawn(weights, draws.next());
    if (!is_there) return;
    const auto isNear = [&](const ScatteredCloud& other) { return squaredDistance(settings, cloud.place, other.place) < least; };
    if (least > 0 && std::any_of(clouds.begin(), clouds.end(), isNear)) return;
    clouds.push_back(cloud);
  });
  return clouds;
}

Affine placeAt(const ScatterSettings& settings, const ScatteredCloud& cloud, const Affine& base, double seconds) {
  const std::array<double, 3> low = parts(settings.low), high = parts(settings.high), drift = parts(settings.drift);
  std::array<double, 3> at = parts(cloud.place);
  double shrink = 1;
  for (size_t axis = 0; axis < 3; ++axis) {
    if (drift[axis] == 0) continue;
    const double length = high[axis] - low[axis], boxes = (at[axis] - low[axis] + drift[axis] * seconds) / length;
    const double share = boxes - std::floor(boxes);
    at[axis] = low[axis] + length * share;
    if (!(settings.fade > 0)) continue;
    const double t = std::min(1.0, std::min(share, 1 - share) / settings.fade);
    shrink *= t * t * (3 - 2 * t);
  }
  double square = 0;  // of the distance to the horizon
  for (const size_t axis : {size_t(0), size_t(2)}) {
    const double halves = (2 * at[axis] - low[axis] - high[axis]) / (high[axis] - low[axis]);
    square += halves * halves;
  }
  square = std::min(1.0, square);
  shrink *= 1 + (settings.horizon_scale - 1) * square;
  at[1] -= settings.horizon_lower * square;

  const double scale = cloud.size * std::max(kLeastShrink, shrink);
  const float angle = cloud.turn_degrees * float(kPi / 180);
  const double c = scale * std::cos(angle), s = scale * std::sin(angle);
  return compose({{{{c, 0, s}, {0, scale, 0}, {-s, 0, c}}}, at}, base);
}

Box fieldBox(const ScatterSettings& settings, float radius) {
  const float most = radius * settings.size.y * std::max(1.0F, settings.horizon_scale);
  const Vec3 margin{most, most, most}, lower{0, settings.horizon_lower, 0};
  Box box;
  for (const Vec3 at : {settings.low, settings.high, settings.low - lower, settings.high - lower})
    box.add(at - margin), box.add(at + margin);
  return box;
}

bool repeatsAfter(const ScatterSettings& settings, double seconds) {
  constexpr double kRounding = 1e-6;
  const std::array<double, 3> low = parts(settings.low), high = parts(settings.high), drift = parts(settings.drift);
  for (size_t axis = 0; axis < 3; ++axis) {
    if (drift[axis] == 0) continue;
    const double boxes = drift[axis] * seconds / (high[axis] - low[axis]);
    if (std::abs(boxes - std::round(boxes)) > kRounding) return false;
  }
  return true;
}

// --- Keys ---

const Keys<ScatterSettings>& fieldKeys() {
  using S = ScatterSettings;
  constexpr const char* kInPage = "the page has the field as the file scatters it";
  static const Keys<S> keys{
      {"count", &S::count, 1, 20000, "places that are tried, in a grid", KeyUse::kScript, kInPage},
      {"probability", &S::probability, 0, 1, "of a cloud at a place", KeyUse::kScript, kInPage},
      {"jitter", &S::jitter, 0, 1, "of a place: 0 in the middle of its cell, 1 anywhere in it", KeyUse::kScript, kInPage},
      {"turn", &S::turn_degrees, 0, 180, "random turn about y, at most, to either side, degrees", KeyUse::kScript, kInPage},
      {"size", &S::size, 1e-3, 1e3, "random factor of the size, from … to", KeyUse::kScript, kInPage},
      {"minimum_distance", &S::minimum_distance, 0, 1e9,
       "between two clouds, world units; a place that is nearer to an earlier cloud stays empty", KeyUse::kScript, kInPage},
      {"drift", &S::drift, -1e6, 1e6, "of all clouds, which wrap around in the box, world units per second", KeyUse::kScript, kInPage},
      {"fade", &S::fade, 0, 0.5, "share of the box before a side through which clouds drift, in which they shrink to nothing",
       KeyUse::kScript, kInPage},
      {"horizon_scale", &S::horizon_scale, 0, 10, "factor of the size at the horizon, where the ellipse in the box touches its sides",
       KeyUse::kScript, kInPage},
      {"horizon_lower", &S::horizon_lower, -1e6, 1e6, "how much lower clouds are at the horizon, world units", KeyUse::kScript, kInPage},
      {"seed", &S::seed, 0, kMostSeed, "selects another field", KeyUse::kScript, kInPage},
  };
  return keys;
}

}  // namespace cloudbake
