// With the slices of cells across the largest component of ω taken as c = 0, 1, …, and the shear
//   u = a − (ω_a/ω_c) c,   v = b − (ω_b/ω_c) c,
// a line along ω is (u, v) = constant. Resampled to the lattice of (u, v) a slice takes one bilinear tap with one weight for all its cells; the
// running sum over the slices is the inside length from the far end, in slices of length 1/ω_c:
//   behind(p) = P(u, v, c) / ω_c,   ahead(p) = (P(u, v, ∞) − P(u, v, c)) / ω_c,
// and with L shorter than any chord P(p ± Lω) takes the place of 0 and ∞. P between two slices is linear. Only one running sum is kept:
// points are looked up when their own slice has been added. The principle is that of a summed-area table: F. Crow, SIGGRAPH 1984; of shear-warp:
// P. Lacroute and M. Levoy, SIGGRAPH 1994.
#include "bake/sweep.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "bake/directions.h"
#include "bake/sliced_field.h"

namespace cloudbake {

namespace {

constexpr size_t kPadding = 32;
constexpr double kConcentrationNoise = 1e-6;  // ± pairs have no noise of their own, rounding has

// The two planes of one sweep, and what is looked up in them.
class Sweeper {
 public:
  explicit Sweeper(const SlicedField& field) : field_(field) {
    // |slope| ≤ 1: the lattice of (u, v) reaches one number of slices past the columns and rows, and a border on either side.
    const size_t columns = size_t(field.cells[0]) + size_t(field.cells[2]) + 4, rows = size_t(field.cells[1]) + size_t(field.cells[2]) + 4;
    stride_ = (columns + kSweepLanes) / kSweepLanes * kSweepLanes;
    plane_size_ = rows * stride_ + kPadding;
    planes_.resize(2 * plane_size_);
    scratch_.resize(size_t(field.cells[0]) + kPadding);
  }

  struct LookUp {
    const SortedPoints* points;
    float* prefix;  // #points->size()
  };

  // Sweeps along a direction with positive main component and looks up the running sum; afterwards the total is at hand.
  void sweep(Vec3 direction, std::span<const LookUp> look_ups, bool points_leave) {
    const float main = component(direction, field_.axes[2]);
    shear_ = {component(direction, field_.axes[0]) / main, component(direction, field_.axes[1]) / main};
    std::fill(planes_.begin(), planes_.begin() + ptrdiff_t(plane_size_), 0.0F);
    for (int slice = 0; slice < field_.cells[2]; ++slice) {
      if (points_leave) std::fill(planes_.begin() + ptrdiff_t(plane_size_), planes_.end(), 0.0F);
      addSlice(field_.slice(slice), shiftOf(slice), planes(), scratch_);
      for (const auto& [points, prefix] : look_ups) {
        const size_t begin = points->first[size_t(slice)], end = points->first[size_t(slice) + 1];
        if (begin < end) lookUpPrefix(points->range(begin, end), shear_, planes(), prefix + begin);
      }
    }
  }
  void total(const SortedPoints& points, float* sum) { lookUpSum(points.range(0, points.size()), shear_, planes(), sum); }

 private:
  SliceShift shiftOf(int slice) const {
    const float column = shear_.slope_a * float(slice), row = shear_.slope_b * float(slice);
    return {int(std::floor(column)), int(std::floor(row)), column - std::floor(column), row - std::floor(row)};
  }
  // The lattice's (0, 0): as far inside the planes as a positive slope moves slices to the left, and a border more.
  ShearedPlanes planes() {
    const auto reach = [&](float slope) { return size_t(std::ceil(std::max(slope, 0.0F) * float(field_.cells[2]))) + 2; };
    return {planes_.data() + reach(shear_.slope_b) * stride_ + reach(shear_.slope_a), ptrdiff_t(plane_size_), stride_};
  }

  const SlicedField& field_;
  size_t stride_, plane_size_;
  std::vector<float> planes_, scratch_;
  Shear shear_;
};

// What the directions of one main axis share.
struct AxisJob {
  const SlicedField* field;
  SortedPoints points;
  std::vector<uint32_t> axes;  // indices
};

// P at p − Lω, p and p + Lω, per sorted point. `from` is empty where it is 0 everywhere: no chord is cut short.
struct Prefixes {
  std::vector<float> from, at, to;
};

struct SweepPlan {
  std::vector<Vec3> cell_positions;
  std::span<const Vec3> axes;  // each with a positive main component
  float length_cells;
  bool cut_short;
  std::array<AxisJob, 3> jobs;
};

void sweepAxis(const SweepPlan& plan, const AxisJob& job, Vec3 direction, Sweeper& sweeper, Prefixes& out) {
  out.at.resize(job.points.size());
  out.to.resize(job.points.size());
  if (!plan.cut_short) {
    const Sweeper::LookUp here{&job.points, out.at.data()};
    sweeper.sweep(direction, {&here, 1}, false);
    sweeper.total(job.points, out.to.data());
    return;
  }
  // p ± Lω lie on the same line, in other slices.
  const float shift = plan.length_cells * component(direction, job.field->axes[2]);
  const SortedPoints before = sortedPoints(plan.cell_positions, *job.field, -shift), after = sortedPoints(plan.cell_positions, *job.field, shift);
  std::vector<float> from(before.size()), to(after.size()), by_point(plan.cell_positions.size());
  const Sweeper::LookUp look_ups[] = {{&job.points, out.at.data()}, {&before, from.data()}, {&after, to.data()}};
  sweeper.sweep(direction, look_ups, true);
  out.from.resize(job.points.size());
  const auto reorder = [&](const SortedPoints& order, const std::vector<float>& values, std::vector<float>& target) {
    for (size_t i = 0; i < order.size(); ++i)
      if (order.source[i] != SortedPoints::kNobody) by_point[order.source[i]] = values[i];
    for (size_t i = 0; i < target.size(); ++i) target[i] = job.points.source[i] == SortedPoints::kNobody ? 0 : by_point[job.points.source[i]];
  };
  reorder(before, from, out.from);
  reorder(after, to, out.to);
}

// The diagonal of the shape's box as the cells tell it, of which up to one at either side are filled in part.
float longestChord(const SlicedField& field) {
  Box box;
  for (int slice = 0; slice < field.cells[2]; ++slice)
    for (int row = 0; row < field.cells[1]; ++row)
      if (const auto [first, end] = field.slice(slice).spans[row]; first < end)
        box.add({float(first), float(row), float(slice)}), box.add({float(end - 1), float(row), float(slice)});
  const Vec3 size = box.size();
  return length({std::max(size.x - 1, 0.0F), std::max(size.y - 1, 0.0F), std::max(size.z - 1, 0.0F)});
}

SweepPlan makePlan(std::vector<Vec3> cell_positions, std::span<const Vec3> axes, const CoverageField& field, double ray_length,
                   const std::array<SlicedField, 3>& sliced) {
  SweepPlan plan{std::move(cell_positions), axes, float(ray_length / field.frame.voxel_size), false, {}};
  plan.cut_short = plan.length_cells < longestChord(sliced[2]);
  for (uint32_t i = 0; i < axes.size(); ++i) plan.jobs[mainAxis(axes[i])].axes.push_back(i);
  tbb::parallel_for(size_t(0), sliced.size(), [&](size_t axis) {
    plan.jobs[axis].field = &sliced[axis];
    if (!plan.jobs[axis].axes.empty()) plan.jobs[axis].points = sortedPoints(plan.cell_positions, sliced[axis], 0);
  });
  return plan;
}

std::vector<Vec3> turnedToMainAxis(std::span<const Vec3> axes) {
  std::vector<Vec3> turned(axes.begin(), axes.end());
  for (Vec3& axis : turned)
    if (component(axis, mainAxis(axis)) < 0) axis = -axis;
  return turned;
}

// Directions of one main axis that one task sweeps. How they are split depends on their number alone.
struct Chunk {
  const AxisJob* job;
  size_t begin, end;
  std::vector<float> x, y, z, squares;  // sums per sorted point
};
std::vector<Chunk> chunksOf(const std::array<AxisJob, 3>& jobs) {
  constexpr size_t kLeastAxes = 4, kMostChunks = 8;
  std::vector<Chunk> chunks;
  for (const AxisJob& job : jobs) {
    const size_t count = job.axes.size(), parts = std::clamp<size_t>(count / kLeastAxes, 1, kMostChunks);
    for (size_t i = 0; i < parts && count > 0; ++i) chunks.push_back({&job, i * count / parts, (i + 1) * count / parts, {}, {}, {}, {}});
  }
  return chunks;
}

void sumChunk(const SweepPlan& plan, Chunk& chunk) {
  const AxisJob& job = *chunk.job;
  for (auto* sums : {&chunk.x, &chunk.y, &chunk.z, &chunk.squares}) sums->assign(job.points.size(), 0.0F);
  Sweeper sweeper(*job.field);
  Prefixes prefixes;
  for (size_t i = chunk.begin; i < chunk.end; ++i) {
    const Vec3 direction = plan.axes[job.axes[i]];
    sweepAxis(plan, job, direction, sweeper, prefixes);
    addSenses(plan.cut_short ? prefixes.from.data() : nullptr, prefixes.at.data(), prefixes.to.data(), 1 / component(direction, job.field->axes[2]),
              direction, {chunk.x.data(), chunk.y.data(), chunk.z.data(), chunk.squares.data()}, job.points.size());
  }
}

// m and Σℓ² of a point.
struct SummedDirection {
  double x = 0, y = 0, z = 0, squares = 0;
};
std::vector<SummedDirection> summedDirections(const SweepPlan& plan) {
  std::vector<Chunk> chunks = chunksOf(plan.jobs);
  tbb::parallel_for(tbb::blocked_range<size_t>(0, chunks.size(), 1), [&](const tbb::blocked_range<size_t>& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) sumChunk(plan, chunks[i]);
  });
  // In the order of the chunks, whoever made them.
  std::vector<SummedDirection> sums(plan.cell_positions.size());
  for (const Chunk& chunk : chunks)
    tbb::parallel_for(tbb::blocked_range<size_t>(0, chunk.x.size(), 4096), [&](const tbb::blocked_range<size_t>& range) {
      for (size_t i = range.begin(); i < range.end(); ++i) {
        const uint32_t source = chunk.job->points.source[i];
        if (source == SortedPoints::kNobody) continue;
        SummedDirection& sum = sums[source];
        sum.x += double(chunk.x[i]), sum.y += double(chunk.y[i]), sum.z += double(chunk.z[i]), sum.squares += double(chunk.squares[i]);
      }
    });
  return sums;
}

}  // namespace

std::vector<Vec3> sweepAxes(int directions) {
  std::vector<Vec3> axes = fibonacciDirections(directions);
  axes.resize(axes.size() / 2);
  return axes;
}

std::vector<Lobe> bakeSweep(const BakePoints& points, const CoverageField& field, const BakeSettings& settings, Warnings& warnings) {
  const std::vector<Vec3> axes = turnedToMainAxis(sweepAxes(settings.rays));
  const std::array<SlicedField, 3> sliced = slicedFields(field);
  uint64_t moved = 0, undefined = 0;
  const SweepPlan plan = makePlan(cellPositions(points.positions, field, moved), axes, field, settings.ray_length.value(), sliced);
  const std::vector<SummedDirection> sums = summedDirections(plan);

  std::vector<Vec3> directions(sums.size());
  for (size_t v = 0; v < sums.size(); ++v) {
    const auto& [x, y, z, squares] = sums[v];
    const double norm = std::sqrt(x * x + y * y + z * z);
    if (norm > 0 && norm >= kConcentrationNoise * squares) {
      directions[v] = {float(x / norm), float(y / norm), float(z / norm)};
    } else {
      directions[v] = points.normals.empty() ? Vec3{0, -1, 0} : -points.normals[v];
      ++undefined;
    }
  }
  const std::vector<float> densities = slicedLengths(plan.cell_positions, directions, plan.length_cells, sliced);
  std::vector<Lobe> lobes(sums.size());
  for (size_t v = 0; v < lobes.size(); ++v) lobes[v] = {directions[v], float(double(densities[v]) * field.frame.voxel_size)};
  warnings.add(WarningKind::kOutsideField, "a vertex outside the integration field was baked at its border", moved);
  warnUndefined(undefined, warnings);
  return lobes;
}

std::vector<float> sweptLengths(std::span<const Vec3> positions, std::span<const Vec3> axes, const CoverageField& field, double ray_length) {
  const std::vector<Vec3> turned = turnedToMainAxis(axes);
  const std::array<SlicedField, 3> sliced = slicedFields(field);
  uint64_t moved = 0;
  const SweepPlan plan = makePlan(cellPositions(positions, field, moved), turned, field, ray_length, sliced);
  std::vector<float> lengths(2 * axes.size() * positions.size());
  tbb::parallel_for(tbb::blocked_range<size_t>(0, axes.size()), [&](const tbb::blocked_range<size_t>& range) {
    Prefixes prefixes;
    for (size_t n = range.begin(); n < range.end(); ++n) {
      const AxisJob& job = plan.jobs[mainAxis(turned[n])];
      Sweeper sweeper(*job.field);
      sweepAxis(plan, job, turned[n], sweeper, prefixes);
      const float per_slice = float(field.frame.voxel_size / component(turned[n], job.field->axes[2]));
      const bool as_given = turned[n] == axes[n];
      float* first = lengths.data() + 2 * n * positions.size();
      float* ahead = as_given ? first : first + positions.size();
      float* behind = as_given ? first + positions.size() : first;
      for (size_t i = 0; i < job.points.size(); ++i) {
        const uint32_t source = job.points.source[i];
        if (source == SortedPoints::kNobody) continue;
        ahead[source] = (prefixes.to[i] - prefixes.at[i]) * per_slice;
        behind[source] = (prefixes.at[i] - (plan.cut_short ? prefixes.from[i] : 0.0F)) * per_slice;
      }
    }
  });
  return lengths;
}

}  // namespace cloudbake
