// A point p of the world has the same first two coordinates as the whole way of the light through it. With k the axis that makes the grid
// smallest and the slopes s_b = l_b/l_k,
//   x = (p_b − s_b p_k − x₀)/c,   y = (p_c − s_c p_k − y₀)/c,   z = (top − p_k)/h   (or p_k − bottom, where the light comes from below)
// so that the shadows of all clouds are one sum along z, and its last slice is the shadow on a plane across the axis k. For clouds in a
// layer, k is upwards until the light is as low as the layer is thin, and the cells are far thinner than those of a grid across the light.
//
// A cloud adds, in the column of a node, −ln(1 − A) with A the mean of what its shadow absorbs over the cell, so that means of the light
// are kept, not means of the depth. It adds it evenly between the heights of the cloud, as cloud_shadow.h does. Sums are whole numbers of
// 1/4096: they are exact, so that total minus own is exactly what is there without the cloud. Between nodes the light itself is
// interpolated, exp(−τ), not τ: edges stay where they are.
#include "preview/mesh_clouds/shade_grid.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/portable_math.h"

namespace cloudbake {

namespace {

constexpr double kMargin = 1.5;  // cells around everything, so that the outermost nodes are in the light

std::array<double, 3> asArray(Vec3 v) { return {v.x, v.y, v.z}; }

// The box of a frame along an axis: across it, sheared along the light, and along it.
struct ShearedBox {
  size_t axis, across, aside;
  double slope_across, slope_aside;
  std::array<double, 3> low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};  // across, aside, along

  ShearedBox(const Box& box, const std::array<double, 3>& l, size_t k)
      : axis(k), across((k + 1) % 3), aside((k + 2) % 3), slope_across(l[across] / l[k]), slope_aside(l[aside] / l[k]) {
    for (int i = 0; i < 8; ++i) {
      const std::array<double, 3> p = asArray(box.corner(i));
      const std::array<double, 3> at{p[across] - slope_across * p[axis], p[aside] - slope_aside * p[axis], p[axis]};
      for (size_t side = 0; side < 3; ++side) low[side] = std::min(low[side], at[side]), high[side] = std::max(high[side], at[side]);
    }
  }
  double volume() const { return (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]); }
};

// The smallest sheared box. The light must not be almost across its axis.
ShearedBox smallestBox(const Box& box, const std::array<double, 3>& l) {
  constexpr double kLeast = 0.02;
  std::vector<ShearedBox> all;
  for (size_t k = 0; k < 3; ++k)
    if (std::abs(l[k]) > kLeast) all.emplace_back(box, l, k);
  return *std::min_element(all.begin(), all.end(), [](const ShearedBox& a, const ShearedBox& b) { return a.volume() < b.volume(); });
}

}  // namespace

std::array<double, 3> ShadeFrame::place(double x, double y, double z) const {
  std::array<double, 3> at{};
  for (size_t r = 0; r < 3; ++r) at[r] = to_grid[r][0] * x + to_grid[r][1] * y + to_grid[r][2] * z + to_grid[r][3];
  return at;
}

ShadeFrame shadeFrame(const Box& box, Vec3 to_light, const ShadeGridSettings& settings) {
  const std::array<double, 3> l = asArray(to_light), wind = asArray(settings.wind);
  const ShearedBox sheared = smallestBox(box, l);
  const size_t k = sheared.axis;
  const double smallest = double(settings.cloud_size) / settings.cells_per_cloud;
  const double longer = std::max(sheared.high[0] - sheared.low[0], sheared.high[1] - sheared.low[1]);
  const double cell = std::max(longer / (settings.cells - 2 * kMargin - 2), smallest);
  const double height = std::max((sheared.high[2] - sheared.low[2]) / (settings.slices - 3), smallest);

  ShadeFrame frame;
  for (size_t side = 0; side < 2; ++side) {
    const size_t axis = side == 0 ? sheared.across : sheared.aside;
    const double slope = side == 0 ? sheared.slope_across : sheared.slope_aside, drift = wind[axis] - slope * wind[k];
    const double first = std::floor((sheared.low[side] - drift) / cell - kMargin);
    frame.to_grid[side][axis] = 1 / cell;
    frame.to_grid[side][k] = -slope / cell;
    frame.to_grid[side][3] = -first - drift / cell;
    frame.nodes[side] = int(std::ceil((sheared.high[side] - sheared.low[side]) / cell + 2 * kMargin)) + 2;
  }
  frame.to_grid[2][k] = (l[k] > 0 ? -1 : 1) / height;
  frame.to_grid[2][3] = 1 + (l[k] > 0 ? sheared.high[2] : -sheared.low[2]) / height;
  frame.nodes[2] = int(std::ceil((sheared.high[2] - sheared.low[2]) / height)) + 3;
  return frame;
}

float ShadeBlock::shareAt(const std::array<double, 3>& place) const {
  std::array<size_t, 3> low{}, step{1, size_t(nodes[0]), size_t(nodes[0]) * size_t(nodes[1])};
  std::array<float, 3> part{};
  for (size_t axis = 0; axis < 3; ++axis) {
    const double at = std::clamp(place[axis] - first[axis], 0.0, double(nodes[axis] - 1));
    low[axis] = std::min(size_t(at), size_t(std::max(0, nodes[axis] - 2)));
    part[axis] = float(at - double(low[axis]));
    if (nodes[axis] < 2) step[axis] = 0;
  }
  const float* const at = &shares[(low[2] * size_t(nodes[1]) + low[1]) * size_t(nodes[0]) + low[0]];
  const auto row = [&](size_t offset) { return at[offset] + part[0] * (at[offset + step[0]] - at[offset]); };
  const auto plane = [&](size_t offset) { return row(offset) + part[1] * (row(offset + step[1]) - row(offset)); };
  return plane(0) + part[2] * (plane(step[2]) - plane(0));
}

ShadeGrid::Columns ShadeGrid::columnsOf(const CloudShadow& shadow, Vec3 to_light) const {
  // The nodes that the cloud may reach, half a cell around it.
  std::array<double, 3> low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
  for (const std::array<double, 3>& corner : shadow.corners()) {
    const std::array<double, 3> at = frame_.place(corner[0], corner[1], corner[2]);
    for (size_t side = 0; side < 3; ++side) low[side] = std::min(low[side], at[side]), high[side] = std::max(high[side], at[side]);
  }
  Columns columns;
  for (size_t side = 0; side < 2; ++side) {
    columns.first[side] = std::clamp(int(std::floor(low[side] - 0.5)), 0, frame_.nodes[side] - 1);
    columns.count[side] = std::clamp(int(std::ceil(high[side] + 0.5)), 0, frame_.nodes[side] - 1) - columns.first[side] + 1;
  }
  columns.slices[0] = std::clamp(int(std::floor(low[2])), 0, frame_.nodes[2] - 1);
  columns.slices[1] = std::clamp(int(std::ceil(high[2])), 0, frame_.nodes[2] - 1);

  // Where ways of the light meet the plane of the shadow: everything is linear in the number of the node.
  const auto& m = frame_.to_grid;
  const size_t k = m[2][0] != 0 ? 0 : m[2][1] != 0 ? 1 : 2, across = (k + 1) % 3, aside = (k + 2) % 3;
  const auto wayAt = [&](int i, int j) {  // through a node, where the axis is 0
    std::array<double, 3> p{};
    p[across] = (columns.first[0] + i - m[0][3]) / m[0][across], p[aside] = (columns.first[1] + j - m[1][3]) / m[1][aside];
    return p;
  };
  const std::array<double, 3> l = asArray(to_light);
  const double slope_of_grid = m[2][k] * l[k];  // third coordinates per world unit towards the light
  const auto meets = [&](int i, int j) {
    const CloudShadow::Way way = shadow.wayThrough(wayAt(i, j));
    return std::array{way.u, way.v, m[2][3] + slope_of_grid * way.enters, m[2][3] + slope_of_grid * way.leaves};
  };
  const auto zero = meets(0, 0), one = meets(1, 0), other = meets(0, 1);
  columns.enters = {zero[2], one[2] - zero[2], other[2] - zero[2]};
  columns.leaves = {zero[3], one[3] - zero[3], other[3] - zero[3]};
  const auto half = [&](size_t q) {
    const double x = one[q] - zero[q], y = other[q] - zero[q];
    return std::sqrt(x * x + y * y) / 2;
  };
  const double half_u = half(0), half_v = half(1);
  columns.depths.resize(size_t(columns.count[0]) * size_t(columns.count[1]));
  for (int j = 0; j < columns.count[1]; ++j)
    for (int i = 0; i < columns.count[0]; ++i) {
      const double u = zero[0] + i * (one[0] - zero[0]) + j * (other[0] - zero[0]);
      const double v = zero[1] + i * (one[1] - zero[1]) + j * (other[1] - zero[1]);
      constexpr double kLeast = 1e-6;  // of the light, so that its logarithm is one
      const double passed = std::clamp(1 - shadow.absorbedOver(u, v, half_u, half_v), kLeast, 1.0);
      columns.depths[size_t(j) * size_t(columns.count[0]) + size_t(i)] = -portableLog(float(passed));
    }
  return columns;
}

int ShadeGrid::stepsAt(const Columns& columns, int i, int j, int slice) {
  const double depth = columns.depths[size_t(j) * size_t(columns.count[0]) + size_t(i)];
  const double enters = columns.enters[0] + i * columns.enters[1] + j * columns.enters[2];
  const double leaves = columns.leaves[0] + i * columns.leaves[1] + j * columns.leaves[2];
  return int(std::floor(depth * kPerDepth * std::clamp((slice - enters) / (leaves - enters), 0.0, 1.0) + 0.5));
}

ShadeGrid::ShadeGrid(const ShadeFrame& frame, std::span<const CloudShadow> shadows, Vec3 to_light) : frame_(frame) {
  columns_.resize(shadows.size());
  parallelFor(shadows.size(), [&](size_t c) { columns_[c] = columnsOf(shadows[c], to_light); });
  const int width = frame_.nodes[0], height = frame_.nodes[1], depth = frame_.nodes[2];
  std::vector<std::vector<uint32_t>> in_row(static_cast<size_t>(height));
  for (size_t c = 0; c < columns_.size(); ++c)
    for (int j = 0; j < columns_[c].count[1]; ++j) in_row[size_t(columns_[c].first[1]) + size_t(j)].push_back(uint32_t(c));

  // Each cloud adds the changes from slice to slice; their sums along the light are the depths.
  const size_t slice = size_t(width) * size_t(height);
  steps_.assign(slice * size_t(depth), 0);
  all_.nodes = frame_.nodes;
  all_.shares.resize(steps_.size());
  parallelFor(height, [&](int y) {
    for (const uint32_t c : in_row[size_t(y)]) {
      const Columns& columns = columns_[c];
      const int j = y - columns.first[1];
      for (int i = 0; i < columns.count[0]; ++i) {
        if (!(columns.depths[size_t(j) * size_t(columns.count[0]) + size_t(i)] > 0)) continue;
        const double enters = columns.enters[0] + i * columns.enters[1] + j * columns.enters[2];
        int before = 0;
        const int most = stepsAt(columns, i, j, depth - 1);
        for (int z = std::clamp(int(std::floor(enters)), 0, depth - 1); z < depth && before < most; ++z) {
          const int now = stepsAt(columns, i, j, z);
          steps_[size_t(z) * slice + size_t(y) * size_t(width) + size_t(columns.first[0] + i)] += now - before;
          before = now;
        }
      }
    }
    for (int z = 0; z < depth; ++z)
      for (int x = 0; x < width; ++x) {
        const size_t at = size_t(z) * slice + size_t(y) * size_t(width) + size_t(x);
        if (z > 0) steps_[at] += steps_[at - slice];
        all_.shares[at] = steps_[at] == 0 ? 1 : portableExp(-float(steps_[at]) / kPerDepth);
      }
  });
}

ShadeBlock ShadeGrid::pastOthers(size_t cloud) const {
  const Columns& columns = columns_[cloud];
  ShadeBlock block;
  block.first = {columns.first[0], columns.first[1], columns.slices[0]};
  block.nodes = {columns.count[0], columns.count[1], columns.slices[1] - columns.slices[0] + 1};
  for (int z = 0; z < block.nodes[2]; ++z)
    for (int j = 0; j < block.nodes[1]; ++j)
      for (int i = 0; i < block.nodes[0]; ++i) {
        const size_t at = (size_t(block.first[2] + z) * size_t(frame_.nodes[1]) + size_t(block.first[1] + j)) * size_t(frame_.nodes[0]) +
                          size_t(block.first[0] + i);
        const int others = steps_[at] - stepsAt(columns, i, j, block.first[2] + z);
        block.shares.push_back(others == 0 ? 1 : portableExp(-float(others) / kPerDepth));
      }
  return block;
}

}  // namespace cloudbake
