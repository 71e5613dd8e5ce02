#include "bake/lobe/sliced_field.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace cloudbake {

namespace {

constexpr size_t kPadding = 32;
constexpr float kInnerMargin = 2;  // least distance of a point from the field's border, in cells

// A looked-up value is blurred along each axis by the cell (variance 1/12) and by the bilinear tap (1/6 on average). A chord that starts in
// the middle of a blurred surface is too long, or too short for a grazing start, by w = ∫₀^∞ of the blur's tail. Subtracting α δ²F changes
// this by −α F(0)′. For a blur close to a normal distribution, w and F′ cancel at α = the variance = 1/4. (For a surface that is crossed,
// half of it would be enough.)
constexpr float kSharpening = 0.25F;

std::vector<float> sharpened(const CoverageField& field) {
  const size_t nx = size_t(field.cells[0]), ny = size_t(field.cells[1]), nz = size_t(field.cells[2]), plane = nx * ny;
  std::vector<float> out(plane * nz + kPadding, 0.0F);
  parallelFor(size_t(1), nz - 1, [&](size_t k) {
    for (size_t j = 1; j + 1 < ny; ++j) {
      const size_t first = k * plane + j * nx;
      const float *in = field.fractions.data() + first, *front = in - nx, *back = in + nx, *below = in - plane, *above = in + plane;
      float* row = out.data() + first;
      for (size_t i = 1; i + 1 < nx; ++i) {
        const float around = ((in[i - 1] + in[i + 1]) + (front[i] + back[i])) + (below[i] + above[i]);
        row[i] = in[i] - kSharpening * (around - 6 * in[i]);
      }
    }
  });
  return out;
}

// Copies the values into memory order along z, in tiles.
std::vector<float> turned(std::span<const float> values, const std::array<int, 3>& cells) {
  const size_t nx = size_t(cells[0]), ny = size_t(cells[1]), nz = size_t(cells[2]);
  constexpr size_t kTile = 16;
  std::vector<float> copy(nx * ny * nz + kPadding);
  parallelFor(ny, [&](size_t j) {
    for (size_t k0 = 0; k0 < nz; k0 += kTile)
      for (size_t i = 0; i < nx; ++i)
        for (size_t k = k0; k < std::min(k0 + kTile, nz); ++k) copy[(i * ny + j) * nz + k] = values[(k * ny + j) * nx + i];
  });
  return copy;
}

SlicedField slicedField(const std::array<int, 3>& cells, size_t axis, std::span<const float> along_x, std::span<const float> along_z) {
  const size_t nx = size_t(cells[0]), ny = size_t(cells[1]), nz = size_t(cells[2]);
  SlicedField sliced;
  if (axis == 0) {
    sliced.axes = {2, 1, 0};
    sliced.row_stride = nz, sliced.slice_stride = ny * nz;
    sliced.values = along_z.data();
  } else {
    sliced.axes = {0, 3 - axis, axis};
    sliced.row_stride = axis == 2 ? nx : nx * ny, sliced.slice_stride = axis == 2 ? nx * ny : nx;
    sliced.values = along_x.data();
  }
  for (size_t n = 0; n < 3; ++n) sliced.cells[n] = cells[sliced.axes[n]];

  sliced.spans.reserve(size_t(sliced.cells[1]) * size_t(sliced.cells[2]));
  for (int slice = 0; slice < sliced.cells[2]; ++slice)
    for (int row = 0; row < sliced.cells[1]; ++row) {
      const float* values = sliced.values + size_t(slice) * sliced.slice_stride + size_t(row) * sliced.row_stride;
      int first = 0, end = sliced.cells[0];
      while (end > 0 && values[end - 1] == 0) --end;
      while (first < end && values[first] == 0) ++first;
      sliced.spans.push_back({end > 0 ? first : sliced.cells[0], end});
    }
  return sliced;
}

// Rays of one main axis and sense: position, slopes, and length in slices.
constexpr size_t kBlock = 256;
struct RayBlock {
  std::array<float, kBlock> a, b, c, slope_a, slope_b, length, inside;
};

void marchBlock(std::span<const uint32_t> members, std::span<const Vec3> positions, std::span<const Vec3> directions, float length_cells,
                const SlicedField& field, float sense, std::span<float> lengths) {
  RayBlock rays;
  const size_t padded = (members.size() + kSweepLanes - 1) / kSweepLanes * kSweepLanes;
  for (size_t i = 0; i < padded; ++i) {
    const uint32_t v = members[std::min(i, members.size() - 1)];
    const Vec3 p = positions[v], w = directions[v];
    const float main = component(w, field.axes[2]);
    rays.a[i] = component(p, field.axes[0]), rays.b[i] = component(p, field.axes[1]), rays.c[i] = component(p, field.axes[2]);
    rays.slope_a[i] = component(w, field.axes[0]) / main, rays.slope_b[i] = component(w, field.axes[1]) / main;
    rays.length[i] = length_cells * std::fabs(main);
  }
  marchSlices({field.values, field.row_stride, field.slice_stride, field.cells[0], field.cells[1], field.cells[2]},
              {rays.a.data(), rays.b.data(), rays.c.data(), rays.slope_a.data(), rays.slope_b.data(), rays.length.data(), sense, padded},
              rays.inside.data());
  for (size_t i = 0; i < members.size(); ++i)
    lengths[members[i]] = rays.inside[i] / std::fabs(component(directions[members[i]], field.axes[2]));
}

}  // namespace

size_t mainAxis(Vec3 direction) {
  const float x = std::fabs(direction.x), y = std::fabs(direction.y), z = std::fabs(direction.z);
  return z >= x && z >= y ? 2 : y >= x ? 1 : 0;
}

SlicedFields slicedFields(const CoverageField& field) {
  SlicedFields fields;
  fields.along_x = sharpened(field);
  fields.along_z = turned(fields.along_x, field.cells);
  parallelFor(size_t(3), [&](size_t axis) { fields.across[axis] = slicedField(field.cells, axis, fields.along_x, fields.along_z); });
  return fields;
}

SortedPoints sortedPoints(std::span<const Vec3> cell_positions, const SlicedField& field, float shift) {
  // The slice of each point, rounded down.
  const int slices = field.cells[2];
  std::vector<int> slice_of(cell_positions.size());
  std::vector<size_t> counts(size_t(slices), 0);
  for (size_t v = 0; v < cell_positions.size(); ++v) {
    const float from_low = component(cell_positions[v], field.axes[2]) + shift + 0.5F;
    slice_of[v] = std::min(int(std::max(from_low, 0.0F)), slices - 1);
    ++counts[size_t(slice_of[v])];
  }
  SortedPoints sorted;
  sorted.first.assign(1, 0);
  for (const size_t count : counts) sorted.first.push_back(sorted.first.back() + (count + kSweepLanes - 1) / kSweepLanes * kSweepLanes);
  sorted.source.assign(sorted.first.back(), SortedPoints::kNobody);
  for (auto* array : {&sorted.a, &sorted.b, &sorted.c, &sorted.rest}) array->resize(sorted.size());

  // Put each point in its place. The padding repeats the first point of the slice.
  const auto place = [&](size_t at, size_t v) {
    sorted.a[at] = component(cell_positions[v], field.axes[0]);
    sorted.b[at] = component(cell_positions[v], field.axes[1]);
    sorted.c[at] = component(cell_positions[v], field.axes[2]);
    sorted.rest[at] = std::clamp(float(slice_of[v]) + 0.5F - (sorted.c[at] + shift), 0.0F, 1.0F);
  };
  std::vector<size_t> next(sorted.first.begin(), sorted.first.end() - 1);
  for (size_t v = 0; v < cell_positions.size(); ++v) {
    const size_t at = next[size_t(slice_of[v])]++;
    place(at, v);
    sorted.source[at] = uint32_t(v);
  }
  for (size_t slice = 0; slice < counts.size(); ++slice)
    for (size_t at = next[slice]; at < sorted.first[slice + 1]; ++at) place(at, sorted.source[sorted.first[slice]]);
  return sorted;
}

std::vector<Vec3> cellPositions(std::span<const Vec3> positions, const CoverageField& field, uint64_t& moved) {
  std::vector<Vec3> cells(positions.size());
  std::atomic<uint64_t> outside = 0;
  const Vec3 first{float(field.first[0]), float(field.first[1]), float(field.first[2])};
  forPoints(positions.size(), [&](size_t v) {
    const Vec3 at = field.frame.toIndex(positions[v]) - first;
    const auto within = [&](float x, int count) { return std::clamp(x, kInnerMargin, float(count - 1) - kInnerMargin); };
    cells[v] = {within(at.x, field.cells[0]), within(at.y, field.cells[1]), within(at.z, field.cells[2])};
    if (!(cells[v] == at)) outside.fetch_add(1, std::memory_order_relaxed);
  });
  moved = outside;
  return cells;
}

std::vector<float> slicedLengths(std::span<const Vec3> cell_positions, std::span<const Vec3> directions, float length_cells,
                                 const SlicedFields& fields) {
  // Group rays of one main axis and sense: they pass about the same number of slices.
  std::array<std::vector<uint32_t>, 6> groups;
  for (uint32_t v = 0; v < cell_positions.size(); ++v) {
    const size_t axis = mainAxis(directions[v]);
    groups[2 * axis + (component(directions[v], axis) < 0)].push_back(v);
  }
  std::vector<float> lengths(cell_positions.size());
  for (size_t group = 0; group < groups.size(); ++group) {
    const std::span<const uint32_t> members = groups[group];
    parallelFor((members.size() + kBlock - 1) / kBlock, [&](size_t block) {
      const size_t begin = block * kBlock;
      marchBlock(members.subspan(begin, std::min(kBlock, members.size() - begin)), cell_positions, directions, length_cells,
                 fields.across[group / 2], group % 2 ? -1.0F : 1.0F, lengths);
    });
  }
  return lengths;
}

}  // namespace cloudbake
