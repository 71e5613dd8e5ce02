// The mesh is sealed by a hash: the sum over the triangles of a hash of their corners' bits, which no order can change.
//
// Lobes come back from other programs with other last bits, so a hash would call every file changed. They are sealed by a sketch instead:
// m sums s_j = Σ_v ε_j(v)·x(v) of the stored vectors x = o·d, with signs ε_j = ±1 that are hashes of the vertex's position. Of a change
// Δ(v), E[(Δs_j)²] = Σ ‖Δ(v)‖², so that m such sums estimate its norm with a standard error of 1/√(2m) (Alon, Matias, Szegedy, "The Space
// Complexity of Approximating the Frequency Moments", STOC 1996).
//
// The shape in the scene is sealed by its area A and by the invariants of the covariance C of the surface (trace, sum of the principal
// 2 × 2 minors, determinant), which neither a translation nor a rotation changes. For a triangle of area a with corners v_i,
// ∫ x xᵀ = a/12 (Σ v_i v_iᵀ + (Σ v_i)(Σ v_i)ᵀ).
#include "core/seal.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/parallel.h"
#include "core/random.h"

namespace cloudbake {

namespace {

constexpr size_t kTogether = 1 << 16;
constexpr uint64_t kMeshSeed = 0x6D657368, kConstantsSeed = 0x636F6E73, kSketchSeed = 0x736B6574;

uint64_t hashedFloat(uint64_t key, float value) { return mix64(key ^ std::bit_cast<uint32_t>(value + 0.0F)) + kGolden64; }

// The same for each of the three corners that it may begin with.
uint64_t hashOfTriangle(std::array<uint64_t, 3> corners) {
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  uint64_t key = kMeshSeed;
  for (const uint64_t corner : corners) key = mix64(key ^ corner) + kGolden64;
  return mix64(key);
}

// By tables of signs, because conditions would be mispredicted half of the time.
void addSigned(std::array<double, kSketchSize>& sums, uint64_t signs, double value) {
  constexpr uint64_t kMinus = uint64_t(1) << 63;
  static constexpr auto kSigns = [] {  // of four sums; a bit of 1 means +
    std::array<std::array<uint64_t, 4>, 16> table{};
    for (size_t bits = 0; bits < table.size(); ++bits)
      for (size_t i = 0; i < 4; ++i) table[bits][i] = bits >> i & 1 ? 0 : kMinus;
    return table;
  }();
  const auto bits = std::bit_cast<uint64_t>(value);
  for (size_t j = 0; j < sums.size(); j += 4, signs >>= 4)
    for (size_t i = 0; i < 4; ++i) sums[j + i] += std::bit_cast<double>(bits ^ kSigns[signs & 15][i]);
}

std::array<float, kSketchSize> inUnits(const std::array<double, kSketchSize>& sums, double unit) {
  std::array<float, kSketchSize> result;
  std::transform(sums.begin(), sums.end(), result.begin(), [&](double sum) { return float(sum / unit); });
  return result;
}

std::string hexadecimal(uint64_t hash) { return fmt::format("{:016x}", hash); }

std::string hashOfConstants(const AssetInfo& info) {
  uint64_t key = kConstantsSeed + (info.lobe == "fit") + 2 * uint64_t(info.harmonic_order);
  const auto add = [&](std::initializer_list<float> values) {
    for (const float value : values) key = hashedFloat(key, value);
  };
  add({info.shape.exponent, info.shape.bias, info.extinction, info.extinction_low, info.extinction_high, info.ray_length});
  if (info.density_max > 0) add({info.density_max});
  if (const auto& arc = info.sun_arc)
    add({arc->elevation_low_degrees, arc->elevation_high_degrees, arc->azimuth_low_degrees, arc->azimuth_high_degrees});
  if (const auto& volume = info.volume) {
    add({volume->view_extinction, volume->asymmetry, float(volume->octaves.count)});
    if (volume->octaves.count > 0) add({volume->octaves.extinction, volume->octaves.contribution});
  }
  return hexadecimal(key);
}

// ‖a − b‖ / ‖a‖, where `unit` is b's in units of a's.
double relativeDifference(std::span<const float> a, std::span<const float> b, double unit) {
  const auto square = [](double x) { return x * x; };
  double difference = 0, size = 0;
  for (size_t j = 0; j < a.size(); ++j) difference += square(double(a[j]) - unit * b[j]), size += square(a[j]);
  return difference > 0 ? std::sqrt(difference / size) : difference;
}

}  // namespace

void SealMaker::Sums::operator+=(const Sums& other) {
  const auto add = [](auto& sums, const auto& more) {
    for (size_t i = 0; i < sums.size(); ++i) sums[i] += more[i];
  };
  mesh += other.mesh;
  area += other.area;
  add(first, other.first), add(second, other.second), add(lobes, other.lobes), add(harmonics, other.harmonics);
}

// The blocks do not depend on the threads, and their sums are added in order.
template <class Add>
void SealMaker::addInBlocks(size_t count, const Add& add) {
  std::vector<Sums> blocks((count + kTogether - 1) / kTogether);
  parallelFor(blocks.size(), [&](size_t block) {
    Sums sums;
    for (size_t i = block * kTogether; i < std::min(count, (block + 1) * kTogether); ++i) add(i, sums);
    blocks[block] = sums;
  });
  for (const Sums& sums : blocks) sums_ += sums;
}

void SealMaker::add(const SculptPart& part, std::span<const LobeUvs> uvs, std::span<const float> harmonics) {
  const size_t count = part.positions.size();
  if (count == 0) return;
  // In double, because GCC 12 at -O3 leaves out the rounding to float of a place that is used in double, and other levels do not.
  const auto in_scene = [&](size_t v) { return preciseTransformPoint(part.toScene(v), part.positions[v]); };
  if (!has_origin_) origin_ = in_scene(0), has_origin_ = true;
  const auto place_of = [&](size_t v) {
    std::array<double, 3> place = in_scene(v);
    for (size_t i = 0; i < 3; ++i) place[i] -= origin_[i];
    return place;
  };
  std::vector<uint64_t> keys(count);
  parallelBlocks(count, kTogether, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) keys[v] = pointStream(kSketchSeed, part.positions[v]);
  });
  const auto keys_of = [&](const Triangle& t) { return std::array{keys[t[0]], keys[t[1]], keys[t[2]]}; };
  const auto is_dropped = [](const std::array<uint64_t, 3>& c) { return c[0] == c[1] || c[1] == c[2] || c[2] == c[0]; };  // by optimisers

  addInBlocks(part.triangles.size(), [&](size_t f, Sums& sums) {
    const Triangle& t = part.triangles[f];
    const std::array<uint64_t, 3> corners = keys_of(t);
    if (is_dropped(corners)) return;
    sums.mesh += hashOfTriangle(corners);
    const std::array<std::array<double, 3>, 3> places{place_of(t[0]), place_of(t[1]), place_of(t[2])};
    std::array<double, 3> u, w, sum;
    for (size_t i = 0; i < 3; ++i) {
      u[i] = places[1][i] - places[0][i], w[i] = places[2][i] - places[0][i];
      sum[i] = places[0][i] + places[1][i] + places[2][i];
    }
    const double x = u[1] * w[2] - u[2] * w[1], y = u[2] * w[0] - u[0] * w[2], z = u[0] * w[1] - u[1] * w[0];
    const double area = std::sqrt(x * x + y * y + z * z) / 2;
    sums.area += area;
    for (size_t i = 0; i < 3; ++i) sums.first[i] += area / 3 * sum[i];
    constexpr std::array<std::array<size_t, 2>, 6> kPairs{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
    for (size_t k = 0; k < kPairs.size(); ++k) {
      const auto [i, j] = kPairs[k];
      double products = sum[i] * sum[j];
      for (const std::array<double, 3>& place : places) products += place[i] * place[j];
      sums.second[k] += area / 12 * products;
    }
  });

  // Every thread reads all triangles, of which most have all corners at one thread's vertices.
  std::vector<uint32_t> uses(count, 0);
  const size_t parts = std::clamp<size_t>(count / kTogether, 1, threadCount());
  parallelFor(parts, [&](size_t one) {
    const size_t begin = one * count / parts, end = (one + 1) * count / parts;
    const auto is_here = [&](uint32_t v) { return v - begin < end - begin; };
    for (const Triangle& t : part.triangles) {
      if ((!is_here(t[0]) && !is_here(t[1]) && !is_here(t[2])) || is_dropped(keys_of(t))) continue;
      for (const uint32_t v : t) uses[v] += is_here(v);
    }
  });

  // A vertex counts as often as triangles use it, so that it does not matter whether it is split or welded.
  const size_t coefficients = harmonics.size() / count;
  addInBlocks(count, [&](size_t v, Sums& sums) {
    if (uses[v] == 0) return;
    const LobeUvs& uv = uvs[v];
    const double d = uv.second.y, weight = uses[v];
    const float o[3] = {uv.first.x, uv.first.y, uv.second.x};
    for (uint32_t i = 0; i < 3; ++i) addSigned(sums.lobes, hashDraw(keys[v], i, 0), weight * d * o[i]);
    for (size_t i = 0; i < coefficients; ++i)
      addSigned(sums.harmonics, hashDraw(keys[v], uint32_t(i), 1), weight * harmonics[v * coefficients + i]);
  });
}

AssetSeal SealMaker::finished(const AssetInfo& info) const {
  AssetSeal seal;
  seal.mesh = hexadecimal(sums_.mesh);
  seal.constants = hashOfConstants(info);
  const double size = sums_.area == 0 ? 1 : std::sqrt(sums_.area);
  seal.size = float(size);
  seal.lobes = inUnits(sums_.lobes, size);
  if (info.harmonic_order > 0) seal.harmonics = inUnits(sums_.harmonics, size);
  if (!(sums_.area > 0)) return seal;
  const auto moment = [&](size_t k, size_t i, size_t j) {
    return sums_.second[k] / sums_.area / sums_.area - sums_.first[i] / sums_.area / size * (sums_.first[j] / sums_.area / size);
  };
  const double xx = moment(0, 0, 0), yy = moment(1, 1, 1), zz = moment(2, 2, 2), xy = moment(3, 0, 1), xz = moment(4, 0, 2),
               yz = moment(5, 1, 2);
  seal.moments = {float(xx + yy + zz), float(xx * yy - xy * xy + xx * zz - xz * xz + yy * zz - yz * yz),
                  float(xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz))};
  return seal;
}

bool isFinite(const AssetSeal& seal) {
  const auto areFinite = [](std::span<const float> values) {
    return std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
  };
  return std::isfinite(seal.size) && areFinite(seal.moments) && areFinite(seal.lobes) && (!seal.harmonics || areFinite(*seal.harmonics));
}

SealDifference differenceOf(const AssetSeal& recorded, const AssetSeal& found) {
  SealDifference difference;
  difference.mesh = recorded.mesh != found.mesh;
  difference.constants = recorded.constants != found.constants;
  const double unit = recorded.size > 0 ? double(found.size) / double(recorded.size) : 1;
  // In units of the trace, which has the largest of the three moments' scales, so that a flat shape's rounding does not count.
  double scale = std::max(double(recorded.moments[0]), 1e-300);
  for (size_t i = 0; i < recorded.moments.size(); ++i, scale *= double(recorded.moments[0]))
    difference.form = std::max(difference.form, std::fabs(double(found.moments[i]) - double(recorded.moments[i])) / scale);
  difference.shape = std::max(difference.form, std::fabs(unit * unit - 1));
  difference.lobes = relativeDifference(recorded.lobes, found.lobes, unit);
  if (recorded.harmonics && found.harmonics)
    difference.harmonics = relativeDifference(*recorded.harmonics, *found.harmonics, unit);
  else if (recorded.harmonics.has_value() != found.harmonics.has_value())
    difference.harmonics = 1;
  return difference;
}

}  // namespace cloudbake
