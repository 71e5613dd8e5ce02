// The blend is a kernel regression (Nadaraya 1964, Watson 1964) in place and normal, with weights that fall to 0 smoothly at kReach cells
// and kFarthestCosine, so the lobes have no steps. A chosen point of a point's own cell and range of normals is always within reach: a
// cell's diagonal is √3, and the normals of a range are at most 36° apart.
#include "bake/lobe/sparse_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "bake/lobe/blend_kernels.h"
#include "bake/lobe/sliced_field.h"
#include "core/parallel.h"

namespace cloudbake {

namespace {

constexpr float kReach = 1.8F;             // cells
constexpr float kFarthestCosine = 0.707F;  // between normals
constexpr size_t kLeastSaving = 4, kMostCellsPerPoint = 16, kGrain = 1 << 14;
constexpr int kRanges = 4;  // of normals, per side of a face of a cube
constexpr size_t kNormals = size_t(6 * kRanges * kRanges) + 1;

// The face of a cube that a normal leaves by, and the part of it; the last number without a normal.
size_t rangeOf(Vec3 normal) {
  const size_t axis = mainAxis(normal);
  const float main = component(normal, axis);
  if (main == 0) return kNormals - 1;
  const auto part = [&](size_t other) {
    return std::clamp(int((component(normal, other) / std::fabs(main) + 1) * (0.5F * kRanges)), 0, kRanges - 1);
  };
  return (2 * axis + (main < 0)) * size_t(kRanges * kRanges) + size_t(part((axis + 1) % 3) * kRanges + part((axis + 2) % 3));
}

Vec3 normalAt(const BakePoints& points, size_t v) { return points.normals.empty() ? Vec3{} : points.normals[v]; }

// What is near the points of a cell.
class NearRows {
 public:
  void clear() {
    for (auto& row : rows_) row.clear();
  }
  void add(Vec3 at, Vec3 normal, const Lobe& lobe) {
    size_t i = 0;
    for (const float value :
         {at.x, at.y, at.z, normal.x, normal.y, normal.z, lobe.direction.x, lobe.direction.y, lobe.direction.z, lobe.thickness})
      rows_[i++].push_back(value);
  }
  // Fills the last vector up with places beyond reach.
  void fillLanes() {
    while (rows_[0].size() % kLanes != 0) add({1e6F, 1e6F, 1e6F}, {}, {{}, 0});
  }

  // The mean of lobes has their mean d along their mean o·d (docs/lobe_math.md). Without any thickness it has their mean direction.
  Lobe blendedAt(Vec3 at, Vec3 normal) const {
    const auto& [x, y, z, normal_x, normal_y, normal_z, o_x, o_y, o_z, thickness] = rows_;
    const BlendSums sums = sumNear({x.data(), y.data(), z.data(), normal_x.data(), normal_y.data(), normal_z.data(), o_x.data(), o_y.data(),
                                    o_z.data(), thickness.data(), x.size()},
                                   at, normal, {kReach, dot(normal, normal) > 0 ? kFarthestCosine : -1});
    const Vec3 direction = normalized(sums.vector).value_or(normalized(sums.direction).value_or(Vec3{0, -1, 0}));
    return {direction, sums.weight > 0 ? sums.thickness / sums.weight : 0};
  }

 private:
  static constexpr size_t kLanes = 8;
  std::array<std::vector<float>, 10> rows_;
};

}  // namespace

std::optional<SparsePoints> SparsePoints::choose(const BakePoints& points, const CoverageField& field) {
  const size_t count = points.positions.size(), cells = field.fractions.size();
  if (!mayChoose(count) || cells > kMostCellsPerPoint * count) return {};
  SparsePoints sparse;
  sparse.points_ = points;
  sparse.counts_ = field.cells;
  uint64_t moved = 0;
  sparse.cells_ = cellPositions(points.positions, field, moved);
  const auto cell_of = [&](size_t v) {
    const Vec3 at = sparse.cells_[v];
    return (size_t(at.z) * size_t(field.cells[1]) + size_t(at.y)) * size_t(field.cells[0]) + size_t(at.x);
  };

  // A counting sort
  sparse.first_.assign(cells + 2, 0);
  for (size_t v = 0; v < count; ++v) ++sparse.first_[cell_of(v) + 2];
  for (size_t cell = 0; cell < cells; ++cell) {
    if (sparse.first_[cell + 2] > 0) sparse.used_cells_.push_back(uint32_t(cell));
    sparse.first_[cell + 2] += sparse.first_[cell + 1];
  }
  sparse.order_.resize(count);
  for (size_t v = 0; v < count; ++v) sparse.order_[sparse.first_[cell_of(v) + 1]++] = uint32_t(v);
  sparse.first_.pop_back();

  // Of each range of normals the point nearest to the middle of the cell
  std::vector<std::vector<size_t>> of_blocks((sparse.used_cells_.size() + kGrain - 1) / kGrain);
  sparse.of_cell_.assign(sparse.used_cells_.size() + 1, 0);
  parallelFor(of_blocks.size(), [&](size_t block) {
    constexpr uint32_t kNone = UINT32_MAX;
    std::vector<uint32_t> nearest(kNormals, kNone);
    for (size_t i = block * kGrain; i < std::min(sparse.used_cells_.size(), (block + 1) * kGrain); ++i) {
      const uint32_t cell = sparse.used_cells_[i];
      const auto rank = [&](uint32_t v) {
        const Vec3 at = sparse.cells_[v], middle{std::floor(at.x) + 0.5F, std::floor(at.y) + 0.5F, std::floor(at.z) + 0.5F},
                   p = points.positions[v], n = normalAt(points, v);
        return std::tuple(dot(at - middle, at - middle), p.x, p.y, p.z, n.x, n.y, n.z);
      };
      for (uint32_t at = sparse.first_[cell]; at < sparse.first_[cell + 1]; ++at) {
        const uint32_t v = sparse.order_[at];
        uint32_t& known = nearest[rangeOf(normalAt(points, v))];
        if (known == kNone || rank(v) < rank(known)) known = v;
      }
      for (uint32_t& v : nearest)
        if (v != kNone) of_blocks[block].push_back(std::exchange(v, kNone)), ++sparse.of_cell_[i + 1];
    }
  });
  for (const std::vector<size_t>& some : of_blocks) sparse.chosen_.insert(sparse.chosen_.end(), some.begin(), some.end());
  if (kLeastSaving * sparse.chosen_.size() > count) return {};
  for (size_t i = 1; i < sparse.of_cell_.size(); ++i) sparse.of_cell_[i] += sparse.of_cell_[i - 1];
  return sparse;
}

std::vector<Lobe> SparsePoints::blended(std::span<const Lobe> lobes) const {
  constexpr size_t kCellsPerTask = 256;
  std::vector<Lobe> all(points_.positions.size());
  parallelBlocks(used_cells_.size(), kCellsPerTask, [&](size_t begin, size_t end) {
    NearRows near;
    for (size_t i = begin; i < end; ++i) {
      const size_t row = size_t(counts_[0]), plane = row * size_t(counts_[1]), cell = used_cells_[i];
      near.clear();
      // Cells of a row follow each other, and so do their chosen points.
      for (int dz = -1; dz <= 1; ++dz)
        for (int dy = -1; dy <= 1; ++dy) {
          const size_t middle = cell + size_t(ptrdiff_t(plane) * dz + ptrdiff_t(row) * dy);
          const auto from = std::lower_bound(used_cells_.begin(), used_cells_.end(), middle - 1),
                     to = std::upper_bound(from, used_cells_.end(), middle + 1);
          for (uint32_t c = of_cell_[size_t(from - used_cells_.begin())]; c < of_cell_[size_t(to - used_cells_.begin())]; ++c)
            near.add(cells_[chosen_[c]], normalAt(points_, chosen_[c]), lobes[c]);
        }
      near.fillLanes();
      for (uint32_t at = first_[cell]; at < first_[cell + 1]; ++at) {
        const uint32_t v = order_[at];
        all[v] = near.blendedAt(cells_[v], normalAt(points_, v));
      }
    }
  });
  return all;
}

}  // namespace cloudbake
