// The light follows the axis a of the field most. With its slopes s_b = l_b/l_a and s_c = l_c/l_a (l in the cloud's own space), all cells
// on a way of the light meet the slice a = 0 at the place (b − s_b a, c − s_c a): on this sheared plane one bilinear tap per slice sums the
// way,
//   ℓ(u, v) = h/|l_a| Σ_a f(a, u + s_b a, v + s_c a),   A = 1 − exp(−σ ℓ).
// Means of A over squares are differences of sums (F. Crow, "Summed-Area Tables for Texture Mapping", SIGGRAPH 1984): a light that fills an
// angle spreads a shadow's edge by the distance times that angle.
//
// Of many shadows, a hierarchy of bounding volumes (S. Rubin, T. Whitted, "A 3-dimensional Representation for Fast Rendering of Complex
// Scenes", SIGGRAPH 1980) finds those that may reach a point. Seen along the light, a place (u, v) of the plane is the same place for every
// a, and n slices behind the cloud the square's half side is at most max(½, s n) cells, with s the spread per slice.
#include "preview/mesh_clouds/cloud_shadow.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/parallel.h"
#include "core/portable_math.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

std::array<double, 3> parts(Vec3 v) { return {v.x, v.y, v.z}; }

/// A slice of the field across an axis.
struct Slice {
  const ShadowCaster& caster;
  size_t axis, across, aside;
  int index;

  double cell(int b, int c) const {
    if (b < 0 || c < 0 || b >= caster.cells[across] || c >= caster.cells[aside]) return 0;
    std::array<size_t, 3> at{};
    at[axis] = size_t(index), at[across] = size_t(b), at[aside] = size_t(c);
    return caster.fractions[(at[2] * size_t(caster.cells[1]) + at[1]) * size_t(caster.cells[0]) + at[0]];
  }
  bool isEmpty() const {
    for (int c = 0; c < caster.cells[aside]; ++c)
      for (int b = 0; b < caster.cells[across]; ++b)
        if (cell(b, c) > 0) return false;
    return true;
  }
};

}  // namespace

CloudShadow::CloudShadow(const ShadowCaster& caster, const Affine& to_world, float extinction, Vec3 to_light,
                         const ShadowSettings& settings)
    : to_own_(inverted(to_world).value()), to_world_(to_world), origin_(caster.origin), cells_(caster.cells), cell_size_(caster.cell_size) {
  const Vec3 own = transformVector(to_own_, to_light);
  const std::array<double, 3> l = parts(own);
  axis_ = size_t(std::max_element(l.begin(), l.end(), [](double p, double q) { return std::abs(p) < std::abs(q); }) - l.begin());
  across_ = (axis_ + 1) % 3, aside_ = (axis_ + 2) % 3;
  slope_across_ = l[across_] / l[axis_], slope_aside_ = l[aside_] / l[axis_];
  per_slice_ = double(cell_size_) / std::abs(l[axis_]);
  towards_light_ = l[axis_] / double(cell_size_);
  spread_ = tanDegrees(settings.softness_degrees) * double(length(own)) / std::abs(l[axis_]);
  light_is_above_ = l[axis_] > 0;

  // The plane holds every place that a slice is seen at, and a cell around.
  const int slices = caster.cells[axis_];
  const double far_across = -slope_across_ * (slices - 1), far_aside = -slope_aside_ * (slices - 1);
  left_ = int(std::floor(std::min(0.0, far_across))) - 1, bottom_ = int(std::floor(std::min(0.0, far_aside))) - 1;
  width_ = int(std::ceil(caster.cells[across_] - 1 + std::max(0.0, far_across))) + 2 - left_;
  height_ = int(std::ceil(caster.cells[aside_] - 1 + std::max(0.0, far_aside))) + 2 - bottom_;

  const auto slice = [&](int index) { return Slice{caster, axis_, across_, aside_, index}; };
  int first = 0, last = slices - 1;
  while (first < last && slice(first).isEmpty()) ++first;
  while (last > first && slice(last).isEmpty()) --last;
  low_ = first - 0.5, high_ = last + 0.5;

  // A row of the plane meets part of a row of each slice; beyond it there is nothing to add.
  std::vector<float> absorbed(size_t(width_) * size_t(height_));
  parallelFor(height_, [&](int j) {
    std::vector<double> sums(size_t(width_), 0);
    for (int k = first; k <= last; ++k) {
      const Slice at = slice(k);
      const double shift = slope_across_ * k, c = bottom_ + j + slope_aside_ * k, c0 = std::floor(c), q = c - c0;
      const int y = int(c0);
      if (y < -1 || y >= caster.cells[aside_]) continue;
      const int begin = std::clamp(int(std::floor(-shift)) - left_ - 2, 0, width_);
      const int end = std::clamp(int(std::ceil(caster.cells[across_] - shift)) - left_ + 2, 0, width_);
      for (int i = begin; i < end; ++i) {
        const double b = left_ + i + shift, b0 = std::floor(b), p = b - b0;
        const int x = int(b0);
        sums[size_t(i)] +=
            (1 - q) * ((1 - p) * at.cell(x, y) + p * at.cell(x + 1, y)) + q * ((1 - p) * at.cell(x, y + 1) + p * at.cell(x + 1, y + 1));
      }
    }
    for (int i = 0; i < width_; ++i) {
      const auto length = float(sums[size_t(i)] / 255 * per_slice_);
      absorbed[size_t(j) * size_t(width_) + size_t(i)] = settings.strength * (1 - portableExp(-extinction * length));
    }
  });
  sums_.assign(size_t(width_ + 1) * size_t(height_ + 1), 0);
  for (int j = 0; j < height_; ++j)
    for (int i = 0; i < width_; ++i) {
      const size_t stride = size_t(width_) + 1, at = size_t(j) * stride + size_t(i);
      sums_[at + stride + 1] = sums_[at + 1] + sums_[at + stride] - sums_[at] + double(absorbed[size_t(j) * size_t(width_) + size_t(i)]);
    }
}

double CloudShadow::integralTo(double u, double v) const {
  const double x = std::clamp(u - left_ + 0.5, 0.0, double(width_)), y = std::clamp(v - bottom_ + 0.5, 0.0, double(height_));
  const int x0 = std::min(int(x), width_ - 1), y0 = std::min(int(y), height_ - 1);
  const double p = x - x0, q = y - y0;
  const double* at = &sums_[size_t(y0) * (size_t(width_) + 1) + size_t(x0)];
  const double* above = at + width_ + 1;
  return (1 - q) * ((1 - p) * at[0] + p * at[1]) + q * ((1 - p) * above[0] + p * above[1]);
}

CloudShadow::Way CloudShadow::wayThrough(const std::array<double, 3>& point) const {
  std::array<double, 3> place{};
  const std::array<double, 3> origin = parts(origin_);
  for (size_t r = 0; r < 3; ++r) {
    const auto& m = to_own_.linear[r];
    place[r] = (m[0] * point[0] + m[1] * point[1] + m[2] * point[2] + to_own_.offset[r] - origin[r]) / double(cell_size_);
  }
  const double a = place[axis_];
  return {place[across_] - slope_across_ * a, place[aside_] - slope_aside_ * a, ((light_is_above_ ? high_ : low_) - a) / towards_light_,
          ((light_is_above_ ? low_ : high_) - a) / towards_light_};
}

double CloudShadow::absorbedOver(double u, double v, double half_u, double half_v) const {
  const double a = std::max(0.5, half_u), b = std::max(0.5, half_v);
  const double sum = integralTo(u + a, v + b) - integralTo(u - a, v + b) - integralTo(u + a, v - b) + integralTo(u - a, v - b);
  return sum / (4 * a * b);
}

std::array<std::array<double, 3>, 8> CloudShadow::corners() const {
  std::array<std::array<double, 3>, 8> all{};
  const std::array<double, 3> origin = parts(origin_);
  for (size_t i = 0; i < 8; ++i) {
    std::array<double, 3> own{};
    for (size_t axis = 0; axis < 3; ++axis)
      own[axis] = origin[axis] + double(cell_size_) * ((i >> axis & 1U) != 0 ? cells_[axis] - 0.5 : -0.5);
    for (size_t r = 0; r < 3; ++r) {
      const auto& m = to_world_.linear[r];
      all[i][r] = m[0] * own[0] + m[1] * own[1] + m[2] * own[2] + to_world_.offset[r];
    }
  }
  return all;
}

ShadowCaster coarserCaster(const ShadowCaster& caster, int factor) {
  ShadowCaster coarse;
  const float shift = float(factor - 1) / 2 * caster.cell_size;
  coarse.origin = caster.origin + Vec3{shift, shift, shift};
  coarse.cell_size = float(factor) * caster.cell_size;
  for (size_t axis = 0; axis < 3; ++axis) coarse.cells[axis] = (caster.cells[axis] + factor - 1) / factor;
  std::vector<int> sums(size_t(coarse.cells[0]) * size_t(coarse.cells[1]) * size_t(coarse.cells[2]));
  size_t cell = 0;
  for (int z = 0; z < caster.cells[2]; ++z)
    for (int y = 0; y < caster.cells[1]; ++y)
      for (int x = 0; x < caster.cells[0]; ++x)
        sums[size_t((z / factor) * coarse.cells[1] + y / factor) * size_t(coarse.cells[0]) + size_t(x / factor)] +=
            caster.fractions[cell++];
  const int all = factor * factor * factor;
  for (const int sum : sums) coarse.fractions.push_back(uint8_t((2 * sum + all) / (2 * all)));
  return coarse;
}

float CloudShadow::shareAt(Vec3 point) const {
  const std::array<double, 3> place = parts((transformPoint(to_own_, point) - origin_) / cell_size_);
  const double a = place[axis_], before = light_is_above_ ? (high_ - a) / (high_ - low_) : (a - low_) / (high_ - low_);
  const double share = std::clamp(before, 0.0, 1.0);  // of the way through the cloud that lies before the point
  if (!(share > 0)) return 1;
  const double u = place[across_] - slope_across_ * a, v = place[aside_] - slope_aside_ * a;
  const double middle = light_is_above_ ? (std::max(a, low_) + high_) / 2 : (std::min(a, high_) + low_) / 2;
  const double half = std::max(0.5, spread_ * std::abs(middle - a));
  const double sum =
      integralTo(u + half, v + half) - integralTo(u - half, v + half) - integralTo(u + half, v - half) + integralTo(u - half, v - half);
  const auto passed = float(std::clamp(1 - sum / (4 * half * half), 0.0, 1.0));
  return share < 1 ? portablePow(passed, float(share)) : passed;
}

ShadowReach CloudShadow::reach(Vec3 to_light, Vec3 across, Vec3 aside) const {
  constexpr double kRounding = 1e-6, kLeastShare = 0.1;
  const auto column = [&](size_t axis) {  // a cell's step along an axis of the field, in the world
    const auto& m = to_world_.linear;
    return std::array<double, 3>{m[0][axis] * double(cell_size_), m[1][axis] * double(cell_size_), m[2][axis] * double(cell_size_)};
  };
  const auto along = [](Vec3 direction, const std::array<double, 3>& v) {
    return double(direction.x) * v[0] + double(direction.y) * v[1] + double(direction.z) * v[2];
  };
  std::array<double, 3> zero{};  // the first cell
  for (size_t r = 0; r < 3; ++r) {
    const auto& row = to_world_.linear[r];
    zero[r] = row[0] * double(origin_.x) + row[1] * double(origin_.y) + row[2] * double(origin_.z) + to_world_.offset[r];
  }
  const std::array<double, 3> u = column(across_), v = column(aside_);
  const double a = light_is_above_ ? high_ : low_,
               step = light_is_above_ ? -per_slice_ : per_slice_;  // the slice that the light meets first
  const double u0 = left_ - 1.0, u1 = left_ + width_ + 1.0, v0 = bottom_ - 1.0, v1 = bottom_ + height_ + 1.0;
  const auto rangeOf = [&](Vec3 direction, double start) {
    const double us = along(direction, u), vs = along(direction, v);
    return std::array<double, 2>{start + std::min(us * u0, us * u1) + std::min(vs * v0, vs * v1),
                                 start + std::max(us * u0, us * u1) + std::max(vs * v0, vs * v1)};
  };
  // The slices are at an angle to the light: half a side of the square also comes nearer to the light by `tilt` times as much.
  const double tilt = std::abs(along(to_light, u)) + std::abs(along(to_light, v));
  const double share = 1 - spread_ * tilt / per_slice_;
  ShadowReach reach;
  if (!(share > kLeastShare)) {
    reach.from = -INFINITY;
    reach.low = {-INFINITY, -INFINITY}, reach.high = {INFINITY, INFINITY};
    return reach;
  }
  reach.from = rangeOf(-to_light, along(-to_light, zero) + a * step)[0] - tilt / share;
  for (size_t side = 0; side < 2; ++side) {
    const Vec3 direction = side == 0 ? across : aside;
    const auto [low, high] = rangeOf(direction, along(direction, zero));
    const double cell = std::abs(along(direction, u)) + std::abs(along(direction, v));
    reach.low[side] = low - cell / share, reach.high[side] = high + cell / share;
    reach.growth[side] = cell * (spread_ / share + kRounding) / per_slice_;
  }
  return reach;
}

void ShadowReach::add(const ShadowReach& other) {
  from = std::min(from, other.from);
  for (size_t side = 0; side < 2; ++side) {
    low[side] = std::min(low[side], other.low[side]);
    high[side] = std::max(high[side], other.high[side]);
    growth[side] = std::max(growth[side], other.growth[side]);
  }
}

CloudShadows::CloudShadows(std::vector<CloudShadow> shadows, std::vector<size_t> owners, Vec3 to_light)
    : shadows_(std::move(shadows)), owners_(std::move(owners)), to_light_(to_light) {
  const Frame frame = frameAround(to_light);
  across_ = frame.tangent, aside_ = frame.bitangent;
  std::vector<ShadowReach> reaches;
  for (const CloudShadow& shadow : shadows_) reaches.push_back(shadow.reach(to_light_, across_, aside_));
  order_.resize(shadows_.size());
  std::iota(order_.begin(), order_.end(), 0);
  if (!shadows_.empty()) build(reaches, 0, uint32_t(shadows_.size()));
}

// Halves the shadows along the longer side of their middles. Returns the node, which comes after its children.
uint32_t CloudShadows::build(std::span<const ShadowReach> reaches, uint32_t first, uint32_t count) {
  constexpr uint32_t kLeaf = 4;
  Node node{{}, first, count, {}};
  std::array<double, 2> least{INFINITY, INFINITY}, most{-INFINITY, -INFINITY};
  const auto middle = [&](uint32_t i, size_t side) {
    const double sum = reaches[i].low[side] + reaches[i].high[side];
    return std::isfinite(sum) ? sum : 0;
  };
  for (uint32_t i = first; i < first + count; ++i) {
    node.reach.add(reaches[order_[i]]);
    for (size_t side = 0; side < 2; ++side) {
      least[side] = std::min(least[side], middle(order_[i], side));
      most[side] = std::max(most[side], middle(order_[i], side));
    }
  }
  if (count > kLeaf) {
    const size_t side = most[0] - least[0] > most[1] - least[1] ? 0 : 1;
    const auto begin = order_.begin() + first;
    std::nth_element(begin, begin + count / 2, begin + count,
                     [&](uint32_t i, uint32_t j) { return std::pair(middle(i, side), i) < std::pair(middle(j, side), j); });
    node.count = 0;
    node.children = {build(reaches, first, count / 2), build(reaches, first + count / 2, count - count / 2)};
  }
  nodes_.push_back(node);
  return uint32_t(nodes_.size() - 1);
}

bool CloudShadows::anyExceptOf(size_t owner) const {
  return std::any_of(owners_.begin(), owners_.end(), [&](size_t other) { return other != owner; });
}

void CloudShadows::pass(std::span<const Vec3> points, std::span<float> shares, size_t owner) const {
  constexpr size_t kTogether = 64;  // that are usually near each other
  for (size_t first = 0; first < points.size(); first += kTogether) {
    const size_t count = std::min(kTogether, points.size() - first);
    passTogether(points.subspan(first, count), shares.subspan(first, count), owner);
  }
}

void CloudShadows::passTogether(std::span<const Vec3> points, std::span<float> shares, size_t owner) const {
  if (nodes_.empty()) return;
  const auto along = [](Vec3 direction, Vec3 p) {
    return double(direction.x) * double(p.x) + double(direction.y) * double(p.y) + double(direction.z) * double(p.z);
  };
  double farthest = -INFINITY;
  std::array<double, 2> low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  for (const Vec3& point : points) {
    farthest = std::max(farthest, along(-to_light_, point));
    for (size_t side = 0; side < 2; ++side) {
      const double at = along(side == 0 ? across_ : aside_, point);
      low[side] = std::min(low[side], at), high[side] = std::max(high[side], at);
    }
  }
  const auto mayMeet = [&](const ShadowReach& reach) {
    if (!(farthest >= reach.from)) return false;
    for (size_t side = 0; side < 2; ++side) {
      const double more = std::isfinite(reach.from) ? reach.growth[side] * (farthest - reach.from) : INFINITY;
      if (!(high[side] >= reach.low[side] - more && low[side] <= reach.high[side] + more)) return false;
    }
    return true;
  };
  std::vector<uint32_t> open{uint32_t(nodes_.size() - 1)}, found;
  while (!open.empty()) {
    const Node& node = nodes_[open.back()];
    open.pop_back();
    if (!mayMeet(node.reach)) continue;
    if (node.count == 0) open.insert(open.end(), node.children.begin(), node.children.end());
    for (uint32_t i = node.first; i < node.first + node.count; ++i)
      if (owners_[order_[i]] != owner) found.push_back(order_[i]);
  }
  std::sort(found.begin(), found.end());  // products of floats depend on their order
  for (const uint32_t i : found)
    for (size_t k = 0; k < points.size(); ++k) shares[k] *= shadows_[i].shareAt(points[k]);
}

// --- Keys ---

const Keys<ShadowSettings>& shadowKeys() {
  using S = ShadowSettings;
  static const Keys<S> keys{
      {"shadows", &S::are_drawn, 0, 1, "things shadow each other", KeyUse::kScript, "shadow_strength = 0 has the same effect"},
      {"shadow_strength", &S::strength, 0, 1, "strength of the shadows that clouds cast"},
      {"shadow_softness", &S::softness_degrees, 0, 45, "half the angle that a shadow's edge spreads over, degrees", KeyUse::kScript},
  };
  return keys;
}

}  // namespace cloudbake
