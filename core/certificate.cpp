// A stored integer is the centre of a cell. With h = l·o/2 + 1/2 and s = h^k d + b, for two lobes of a cell whose directions are a chord of
// at most c apart, |h − h'| ≤ c/2 =: δ, and by the mean value theorem, with f(σ, s) = σ exp(−σ s),
//
//   |T − T'| ≤ max over σ of f(σ, s_min) · (|h^k − h'^k| d + h'^k |d − d'|)
//
// Where l is about along o or against it, h hardly changes: dh = −sin θ / 2 dθ = −√(h (1 − h)) dθ for the angle θ between l and o, and the
// arc between the directions is at most 1.01 c for c ≤ 0.4. s_min is the smallest s of both. All h are covered by intervals; in each of
// them every factor is replaced by its upper end.
//
// Chord: the unfolded octahedron is a continuous map of the square that is linear in pieces, and in each of them (du, dv) moves the point
// by (±du, ±dv, ±du ± dv). So a cell of half side η keeps within √6 η of its centre's point p, 1/√3 ≤ |p| ≤ 1; and two vectors x and y that
// are normalised are at most 2 |x − y| / (|x| + |y|) apart (Dunkl and Williams, American Mathematical Monthly 71, 1964).
//
// A node's matrix A moves the lobe to the scene: o·d → A (o·d). The same inequality bounds the chord there, with |A x| ≤ ‖A‖ |x|.
#include "core/certificate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "core/portable_math.h"

namespace cloudbake {

namespace {

// Cells are taken larger than they are, for the rounding of lobes to float32 before and after (3e-7 of a cell's 1.5e-5), and what float32
// does to the formula is added (three roundings of an exponent x, of which x exp(−x) ≤ 1/e remains).
constexpr double kCellMargin = 1.03, kFormulaMargin = 2e-6;
constexpr size_t kIntervals = 256;

// All lobes of a cell, in scene space.
struct Cell {
  double chord = 2;                       // of two directions
  double density = 0, low = 0, high = 0;  // the stored d and the range
};

// ‖A‖ from above, and whether A is a similarity: a rotation or mirror, and a scale of all axes.
struct Norm {
  double most = 0;
  bool is_similarity = false;
};

Norm normOf(const Affine& map) {
  double squares = 0, off = 0;
  std::array<double, 3> columns{};
  for (size_t a = 0; a < 3; ++a)
    for (size_t b = a; b < 3; ++b) {
      double product = 0;
      for (size_t r = 0; r < 3; ++r) product += map.linear[r][a] * map.linear[r][b];
      if (a == b)
        columns[a] = product, squares += product;
      else
        off = std::max(off, std::fabs(product));
    }
  const auto [least, most] = std::minmax_element(columns.begin(), columns.end());
  constexpr double kRounding = 1e-6;
  Norm norm;
  norm.is_similarity = off <= kRounding * *most && *most - *least <= kRounding * *most;
  norm.most = norm.is_similarity ? std::sqrt(*most) * (1 + 2 * kRounding) : std::sqrt(squares);
  return norm;
}

double lengthOf(const std::array<double, 3>& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

Cell cellOf(const LobeUvs& stored, const Affine& map, const Norm& norm, double density_max) {
  constexpr double kHalfStep = kCellMargin * 0.5 / kDirectionSteps, kHalfRoot = kCellMargin * 0.5 / kDensitySteps;
  const double reach = std::sqrt(6.0) * kHalfStep;
  const std::array<double, 3> point = octahedronPoint(stored.first.x, stored.first.y);
  const double size = lengthOf(point), chord = 2 * reach / (2 * size - reach);
  std::array<double, 3> moved{};
  for (size_t r = 0; r < 3; ++r)
    for (size_t c = 0; c < 3; ++c) moved[r] += map.linear[r][c] * point[c] / size;
  const double length = lengthOf(moved), change = norm.is_similarity ? 0 : norm.most * chord;
  Cell cell;
  cell.chord = norm.is_similarity ? chord * (1 + 1e-5) : length > change ? std::min(2.0, 2 * norm.most * chord / (2 * length - change)) : 2;
  const double root = stored.second.y, below = std::max(0.0, root - kHalfRoot), above = root + kHalfRoot;
  cell.density = density_max * root * root * length;
  cell.low = density_max * below * below * std::max(0.0, length - change);
  cell.high = density_max * above * above * (length + change);
  return cell;
}

// The powers at the ends of each interval of h, with what a cell adds on both sides.
struct Interval {
  double lowest_power = 0, highest_power = 0;  // h^k
  double turn = 0.5;                           // the most of √(h (1 − h)), with a margin: |h − h'| over c
  double slope = 0;                            // the most of |h^k − h'^k| / |h − h'|; for k < 1 without the cell around 0
};

std::array<Interval, kIntervals> intervalsFor(double exponent, double delta) {
  std::array<Interval, kIntervals> intervals;
  const auto node = [](size_t i) { return double(i) / double(kIntervals) * (double(i) / double(kIntervals)); };
  for (size_t i = 0; i < kIntervals; ++i) {
    const double low = std::max(0.0, node(i) - delta), high = std::min(1.0, node(i + 1) + delta);
    const double steepest = exponent >= 1 ? high : low, middle = std::clamp(0.5, low, high);
    intervals[i] = {portablePow(low, exponent), portablePow(high, exponent), delta < 0.2 ? 1.01 * std::sqrt(middle * (1 - middle)) : 0.5,
                    exponent >= 1 || low > 0 ? exponent * portablePow(steepest, exponent - 1) : INFINITY};
  }
  return intervals;
}

// The largest σ exp(−σ s) in the range, whose maximum over all σ is at 1/s.
double steepestIn(double s, const PackingCertificate& range) {
  const double low = range.extinction_low, high = range.extinction_high;
  const double at = s * low >= 1 ? low : s * high <= 1 ? high : 1 / s;
  return at * portableExp(-at * s);
}

double boundOf(const Cell& cell, const std::array<Interval, kIntervals>& intervals, double exponent, double bias,
               const PackingCertificate& range) {
  const double density_change = std::max(cell.high - cell.density, cell.density - cell.low);
  double most = 0;
  for (const Interval& interval : intervals) {
    if (interval.highest_power * cell.high + bias <= 0) continue;  // T is 1
    const double delta = cell.chord * std::min(0.5, interval.turn);
    const double whole = exponent < 1 ? portablePow(delta, exponent) : INFINITY;  // |h^k − h'^k| ≤ |h − h'|^k
    const double shift = std::min(interval.slope * delta, whole) * cell.high + interval.highest_power * density_change;
    most = std::max(most, shift * steepestIn(std::max(0.0, interval.lowest_power * cell.low + bias), range));
  }
  return most;
}

// Rounded up to three digits.
float roundedUp(double value) {
  double unit = 1;
  while (unit > value * 10) unit /= 10;
  const double digits = std::ceil(value / unit * 100) / 100;
  const auto rounded = float(digits * unit);
  return double(rounded) < value ? std::nextafter(rounded, 2.0F) : rounded;
}

}  // namespace

PackingCertificate certificateRange(const AssetInfo& info) {
  if (info.extinction_high > 0) return {0, info.extinction_low, info.extinction_high};
  return {0, info.extinction / 2, info.extinction * 2};
}

PackingCertificate certify(std::span<const PackedPart> parts, const AssetInfo& info, const PackingCertificate& range) {
  std::vector<Cell> cells;
  for (const PackedPart& packed : parts) {
    Norm norm = normOf(packed.part.to_scene);
    for (size_t v = 0; v < packed.stored.size(); ++v) {
      if (!packed.part.vertex_to_scene.empty()) norm = normOf(packed.part.toScene(v));
      cells.push_back(cellOf(packed.stored[v], packed.part.toScene(v), norm, info.density_max));
    }
  }
  double chord = 0;
  for (const Cell& cell : cells) chord = std::max(chord, cell.chord);
  const double exponent = info.shape.exponent;
  const std::array<Interval, kIntervals> intervals = intervalsFor(exponent, chord / 2);
  std::vector<double> bounds(cells.size());
  parallelFor(cells.size(), [&](size_t v) { bounds[v] = boundOf(cells[v], intervals, exponent, info.shape.bias, range); });
  double most = 0;
  for (const double bound : bounds) most = std::max(most, bound);
  PackingCertificate certificate = range;
  certificate.transmittance = roundedUp(std::min(1.0, most + kFormulaMargin));
  return certificate;
}

}  // namespace cloudbake
