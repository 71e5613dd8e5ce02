#include "core/harmonic_lattice.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/harmonics.h"

namespace cloudbake {

namespace {

// The point itself if it is in the box, else where its way enters the box; none if it does not.
std::optional<Vec3> placeInBox(const Box& box, Vec3 point, Vec3 direction) {
  const std::array<float, 3> from{point.x, point.y, point.z}, along{direction.x, direction.y, direction.z},
      low{box.low.x, box.low.y, box.low.z}, high{box.high.x, box.high.y, box.high.z};
  float enter = 0, leave = INFINITY;
  for (size_t axis = 0; axis < 3; ++axis) {
    if (along[axis] == 0) {
      if (from[axis] < low[axis] || from[axis] > high[axis]) return std::nullopt;
      continue;
    }
    const float a = (low[axis] - from[axis]) / along[axis], b = (high[axis] - from[axis]) / along[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (!(enter <= leave)) return std::nullopt;
  return point + direction * enter;
}

}  // namespace

float latticeTransmittance(const HarmonicLattice& lattice, Vec3 point, Vec3 to_light) {
  const auto place = placeInBox(lattice.box(), point, to_light);
  if (!place) return 1;
  const Vec3 at = (*place - lattice.origin) / lattice.cell_size;
  const std::array<float, 3> index{at.x, at.y, at.z};
  std::array<size_t, 3> low{}, high{};
  std::array<float, 3> part{};
  for (size_t axis = 0; axis < 3; ++axis) {
    const float inside = std::clamp(index[axis], 0.0F, float(lattice.cells[axis] - 1));
    low[axis] = size_t(inside);
    high[axis] = std::min(low[axis] + 1, size_t(lattice.cells[axis] - 1));
    part[axis] = inside - float(low[axis]);
  }
  const size_t count = harmonicCount(lattice.order);
  std::array<float, kMaxHarmonics> mixed{};
  for (int corner = 0; corner < 8; ++corner) {
    std::array<size_t, 3> cell{};
    float weight = 1;
    for (size_t axis = 0; axis < 3; ++axis) {
      const bool is_high = (corner >> axis & 1) != 0;
      cell[axis] = is_high ? high[axis] : low[axis];
      weight *= is_high ? part[axis] : 1 - part[axis];
    }
    const float* own = &lattice.coefficients[((cell[2] * size_t(lattice.cells[1]) + cell[1]) * size_t(lattice.cells[0]) + cell[0]) * count];
    for (size_t i = 0; i < count; ++i) mixed[i] += weight * own[i];
  }
  return harmonicTransmittance(std::span(mixed).first(count), to_light);
}

}  // namespace cloudbake
