// Let c = 0, 1, … be the slices of cells across the largest component of ω. With the shear
//   u = a − (ω_a/ω_c) c,   v = b − (ω_b/ω_c) c,
// a line along ω is (u, v) = constant. Resampling a slice to the lattice of (u, v) takes one bilinear tap with the same weights for all its
// cells. The running sum P over the slices is the inside length from the far end, in slices of length 1/ω_c:
//   behind(p) = P(u, v, c) / ω_c,   ahead(p) = (P(u, v, ∞) − P(u, v, c)) / ω_c,
// If L can cut chords short, P(p ± Lω) replaces 0 and P(∞). P is linear between two slices. Only one running sum is kept: points are looked
// up when their own slice has been added. The principles are the summed-area table (F. Crow, SIGGRAPH 1984) and shear-warp (P. Lacroute and
// M. Levoy, SIGGRAPH 1994).
#include "bake/lobe/sweep.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "bake/lobe/directions.h"
#include "bake/lobe/sliced_field.h"
#include "core/parallel.h"

namespace cloudbake {

namespace {

constexpr size_t kPadding = 32, kAxesTogether = 4;
constexpr size_t kMostRelaxedAxes = 1024;     // with more axes the seam matters little and the pairs are too many
constexpr double kConcentrationNoise = 1e-6;  // pairs of opposite directions add no noise; only rounding does
constexpr double kLengthNoise_cells = 0.5;    // error of a length, because the lattice differs on the two sides of a point

// The two planes of one sweep, and the look-ups in them.
class Sweeper {
 public:
  explicit Sweeper(const SlicedField& field) : field_(field) {
    // |slope| ≤ 1, so the lattice of (u, v) extends beyond the columns and rows by the number of slices, plus a border on either side.
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

  // Sweeps along a direction with a positive main component and looks up the running sum. total() can be called afterwards.
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
  // The planes at the lattice's (0, 0): it is inset by as much as a positive slope moves slices to the left, plus a border.
  ShearedPlanes planes() {
    const auto reach = [&](float slope) { return size_t(std::ceil(std::max(slope, 0.0F) * float(field_.cells[2]))) + 2; };
    return {planes_.data() + reach(shear_.slope_b) * stride_ + reach(shear_.slope_a), ptrdiff_t(plane_size_), stride_};
  }

  const SlicedField& field_;
  size_t stride_, plane_size_;
  std::vector<float> planes_, scratch_;
  Shear shear_;
};

// The upper half of a spherical Fibonacci set and its mirror image at the centre do not fit together at the equator. A few steps of
// repulsion repair the seam: each axis is repelled by both ends of all others with 1/r³ and moves by kStep of the force on it, in units of
// the mean spacing, but by at most a tenth of the spacing. This function adds the forces on axes [begin, end), one row of lanes at a time.
// The inner loop over lanes is vectorised by the compiler; the outer loop is over all axes.
void addForces(std::span<const Vec3> axes, size_t begin, size_t end, std::span<Vec3> forces) {
  constexpr size_t kRow = 16;
  constexpr float kSelf = 1e-30F;  // an axis is at distance 0 from itself, and this makes that term 0
  for (size_t first = begin; first < end; first += kRow) {
    float x[kRow], y[kRow], z[kRow], force_x[kRow] = {}, force_y[kRow] = {}, force_z[kRow] = {};
    for (size_t l = 0; l < kRow; ++l) {
      const Vec3 axis = axes[std::min(first + l, end - 1)];
      x[l] = axis.x, y[l] = axis.y, z[l] = axis.z;
    }
    for (const Vec3& other : axes)
      for (size_t l = 0; l < kRow; ++l) {
        const float near_x = x[l] - other.x, near_y = y[l] - other.y, near_z = z[l] - other.z;
        const float far_x = x[l] + other.x, far_y = y[l] + other.y, far_z = z[l] + other.z;
        const float near2 = near_x * near_x + near_y * near_y + near_z * near_z, far2 = far_x * far_x + far_y * far_y + far_z * far_z;
        const float near_pull = 1 / (near2 * near2 + kSelf), far_pull = 1 / (far2 * far2);
        force_x[l] += near_x * near_pull + far_x * far_pull;
        force_y[l] += near_y * near_pull + far_y * far_pull;
        force_z[l] += near_z * near_pull + far_z * far_pull;
      }
    for (size_t l = 0; l < std::min(kRow, end - first); ++l) forces[first + l] = {force_x[l], force_y[l], force_z[l]};
  }
}

void relaxAxes(std::vector<Vec3>& axes) {
  constexpr int kSteps = 20;
  constexpr size_t kAxesPerTask = 64;
  constexpr float kStep = 1.0F / 12;
  const float spacing2 = float(2 * kPi) / float(axes.size()), most = 0.1F * std::sqrt(spacing2);
  std::vector<Vec3> forces(axes.size());
  for (int step = 0; step < kSteps; ++step) {
    parallelBlocks(axes.size(), kAxesPerTask, [&](size_t begin, size_t end) { addForces(axes, begin, end, forces); });
    for (size_t i = 0; i < axes.size(); ++i) {
      Vec3 move = (forces[i] - axes[i] * dot(forces[i], axes[i])) * (kStep * spacing2 * spacing2);
      if (const float distance = length(move); distance > most) move = move * (most / distance);
      axes[i] = normalized(axes[i] + move).value();
    }
  }
}

// Data shared by the directions of one main axis.
struct AxisJob {
  const SlicedField* field;
  SortedPoints points;
  std::vector<uint32_t> axes;  // indices
};

// P at p − Lω, p and p + Lω, per sorted point. `from` is empty if no chord is cut short, because it is then 0 everywhere.
struct Prefixes {
  std::vector<float> from, at, to;
};

struct SweepPlan {
  std::vector<Vec3> cell_positions;
  std::span<const Vec3> axes;  // those of a bake have a positive main component
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
  // p ± Lω are on the same line, but in other slices.
  const float shift = plan.length_cells * component(direction, job.field->axes[2]);
  const SortedPoints before = sortedPoints(plan.cell_positions, *job.field, -shift),
                     after = sortedPoints(plan.cell_positions, *job.field, shift);
  std::vector<float> from(before.size()), to(after.size()), by_point(plan.cell_positions.size());
  const Sweeper::LookUp look_ups[] = {{&job.points, out.at.data()}, {&before, from.data()}, {&after, to.data()}};
  sweeper.sweep(direction, look_ups, true);
  out.from.resize(job.points.size());
  const auto reorder = [&](const SortedPoints& order, const std::vector<float>& values, std::vector<float>& target) {
    for (size_t i = 0; i < order.size(); ++i)
      if (order.source[i] != SortedPoints::kNobody) by_point[order.source[i]] = values[i];
    for (size_t i = 0; i < target.size(); ++i)
      target[i] = job.points.source[i] == SortedPoints::kNobody ? 0 : by_point[job.points.source[i]];
  };
  reorder(before, from, out.from);
  reorder(after, to, out.to);
}

// The diagonal of the shape's box. At either end the filled cells extend up to half a cell beyond it, and the sharpened ones one cell more.
float longestChord(const SlicedField& field) {
  Box box;
  for (int slice = 0; slice < field.cells[2]; ++slice)
    for (int row = 0; row < field.cells[1]; ++row)
      if (const auto [first, end] = field.slice(slice).spans[row]; first < end)
        box.add({float(first), float(row), float(slice)}), box.add({float(end - 1), float(row), float(slice)});
  const Vec3 size = box.size();
  return length({std::max(size.x - 3, 0.0F), std::max(size.y - 3, 0.0F), std::max(size.z - 3, 0.0F)});
}

SweepPlan makePlan(std::vector<Vec3> cell_positions, std::span<const Vec3> axes, const CoverageField& field, double ray_length,
                   const SlicedFields& sliced) {
  SweepPlan plan{std::move(cell_positions), axes, float(ray_length / field.frame.voxel_size), false, {}};
  plan.cut_short = plan.length_cells < longestChord(sliced.across[2]);
  for (uint32_t i = 0; i < axes.size(); ++i) plan.jobs[mainAxis(axes[i])].axes.push_back(i);
  parallelFor(sliced.across.size(), [&](size_t axis) {
    plan.jobs[axis].field = &sliced.across[axis];
    if (!plan.jobs[axis].axes.empty()) plan.jobs[axis].points = sortedPoints(plan.cell_positions, sliced.across[axis], 0);
  });
  return plan;
}

Vec3 turnedToMainAxis(Vec3 axis) { return component(axis, mainAxis(axis)) < 0 ? -axis : axis; }

// m and Σℓ² of a point.
struct SummedDirection {
  double x = 0, y = 0, z = 0, squares = 0;
};

// The axes of one job that one task sweeps, and their sums per sorted point.
struct Chunk {
  const AxisJob* job;
  size_t begin, end;
};
struct ChunkSums {
  Chunk chunk;
  std::vector<float> x, y, z, squares;
};

// The split depends only on the number of axes.
std::vector<Chunk> chunksOf(const std::array<AxisJob, 3>& jobs) {
  constexpr size_t kAxesPerChunk = 8;
  std::vector<Chunk> chunks;
  for (const AxisJob& job : jobs) {
    const size_t count = job.axes.size(), parts = std::max<size_t>(count / kAxesPerChunk, 1);
    for (size_t i = 0; i < parts && count > 0; ++i) chunks.push_back({&job, i * count / parts, (i + 1) * count / parts});
  }
  return chunks;
}

void sumChunk(const SweepPlan& plan, ChunkSums& sums) {
  const AxisJob& job = *sums.chunk.job;
  for (auto* array : {&sums.x, &sums.y, &sums.z, &sums.squares}) array->assign(job.points.size(), 0.0F);
  Sweeper sweeper(*job.field);
  Prefixes prefixes;
  for (size_t i = sums.chunk.begin; i < sums.chunk.end; ++i) {
    const Vec3 direction = plan.axes[job.axes[i]];
    sweepAxis(plan, job, direction, sweeper, prefixes);
    addSenses(plan.cut_short ? prefixes.from.data() : nullptr, prefixes.at.data(), prefixes.to.data(),
              1 / component(direction, job.field->axes[2]), direction, {sums.x.data(), sums.y.data(), sums.z.data(), sums.squares.data()},
              job.points.size());
  }
}

void addChunk(const ChunkSums& part, std::span<SummedDirection> sums) {
  for (size_t i = 0; i < part.x.size(); ++i) {
    const uint32_t source = part.chunk.job->points.source[i];
    if (source == SortedPoints::kNobody) continue;
    SummedDirection& sum = sums[source];
    sum.x += double(part.x[i]), sum.y += double(part.y[i]), sum.z += double(part.z[i]), sum.squares += double(part.squares[i]);
  }
}

// Any free thread sweeps a chunk, and chunks are added in order. So few of their arrays exist at a time, and the sums do not depend on the
// threads.
std::vector<SummedDirection> summedDirections(const SweepPlan& plan) {
  const std::vector<Chunk> chunks = chunksOf(plan.jobs);
  std::vector<SummedDirection> sums(plan.cell_positions.size());
  // One per chunk in progress; the arrays of a chunk that was added are reused.
  std::vector<ChunkSums> arrays(std::min(2 * threadCount(), chunks.size()));
  const LoopProgress::Counted counted;
  parallelInOrder(
      chunks.size(), std::span(arrays),
      [&](size_t chunk, ChunkSums& part) {
        part.chunk = chunks[chunk];
        sumChunk(plan, part);
      },
      [&](const ChunkSums& part) { addChunk(part, sums); });
  return sums;
}

}  // namespace

std::vector<Vec3> sweepAxes(int directions) {
  std::vector<Vec3> axes = fibonacciDirections(directions);
  axes.resize(axes.size() / 2);
  if (axes.size() <= kMostRelaxedAxes) relaxAxes(axes);
  return axes;
}

std::vector<Vec3> bothSenses(std::span<const Vec3> axes) {
  std::vector<Vec3> directions;
  for (const Vec3& axis : axes) directions.insert(directions.end(), {axis, -axis});
  return directions;
}

namespace {

// What a bake counts, by several threads.
struct BakeCounts {
  std::atomic<uint64_t> moved = 0, undefined = 0;
};

void bakePoints(const BakePoints& points, std::span<const Vec3> axes, const SweepField& field, double ray_length, std::span<Lobe> lobes,
                BakeCounts& counts) {
  uint64_t moved = 0;
  const SweepPlan plan = makePlan(cellPositions(points.positions, field.coverage, moved), axes, field.coverage, ray_length, field.sliced);
  counts.moved.fetch_add(moved, std::memory_order_relaxed);
  const std::vector<SummedDirection> sums = summedDirections(plan);
  std::vector<Vec3> directions(sums.size());
  forPoints(sums.size(), [&](size_t v) {
    const auto& [x, y, z, squares] = sums[v];
    const double norm = std::sqrt(x * x + y * y + z * z);
    // Errors of δ in N lengths alone give ‖Σ ω ℓ²‖ ≈ δ √(Σ ℓ²).
    const bool is_defined = norm > 0 && norm >= std::max(kConcentrationNoise * squares, kLengthNoise_cells * std::sqrt(squares));
    directions[v] = is_defined ? Vec3{float(x / norm), float(y / norm), float(z / norm)} : undefinedDirection(points, v);
    if (!is_defined) counts.undefined.fetch_add(1, std::memory_order_relaxed);
  });
  const std::vector<float> densities = slicedLengths(plan.cell_positions, directions, plan.length_cells, field.sliced);
  // The sharpened field overshoots, so a grazing length may be negative by up to a voxel.
  forPoints(lobes.size(), [&](size_t v) {
    lobes[v] = {directions[v], float(std::max(0.0, double(densities[v]) * field.coverage.frame.voxel_size))};
  });
}

}  // namespace

// Many points are baked in blocks, whose arrays stay in the cache and do not fill the memory. Every block sweeps all cells, so it has more
// points where there are many cells.
std::vector<Lobe> bakeSweep(const BakePoints& points, const SweepField& field, const BakeSettings& settings, Warnings& warnings) {
  constexpr size_t kLeastPoints = 1 << 17, kCellsPerPoint = 8;
  std::vector<Vec3> axes = sweepAxes(settings.rays);
  for (Vec3& axis : axes) axis = turnedToMainAxis(axis);
  const size_t count = points.positions.size(),
               blocks = std::max<size_t>(count / std::max(kLeastPoints, field.coverage.fractions.size() / kCellsPerPoint), 1);
  std::vector<Lobe> lobes(count);
  BakeCounts counts;
  const auto bakeBlock = [&](size_t block) {
    const size_t begin = block * count / blocks, size = (block + 1) * count / blocks - begin;
    const auto normals = points.normals.empty() ? points.normals : points.normals.subspan(begin, size);
    bakePoints({points.positions.subspan(begin, size), normals}, axes, field, settings.ray_length.value(),
               std::span(lobes).subspan(begin, size), counts);
  };
  if (blocks == 1) {
    bakeBlock(0);
  } else {
    const LoopProgress::Counted counted;
    parallelFor(blocks, bakeBlock);
  }
  warnings.add(WarningKind::kOutsideField, "a vertex outside the integration field was baked at its border", counts.moved);
  warnUndefined(counts.undefined, warnings);
  return lobes;
}

namespace {

// Lengths along an axis, then those against it, #points each.
void addLengths(const SweepPlan& plan, double voxel_size, Vec3 axis, Prefixes& prefixes, float* lengths) {
  const Vec3 turned = turnedToMainAxis(axis);
  const AxisJob& job = plan.jobs[mainAxis(turned)];
  Sweeper sweeper(*job.field);
  sweepAxis(plan, job, turned, sweeper, prefixes);
  const float per_slice = float(voxel_size / component(turned, job.field->axes[2]));
  const size_t points = plan.cell_positions.size();
  float* ahead = turned == axis ? lengths : lengths + points;
  float* behind = turned == axis ? lengths + points : lengths;
  for (size_t i = 0; i < job.points.size(); ++i) {
    const uint32_t source = job.points.source[i];
    if (source == SortedPoints::kNobody) continue;
    ahead[source] = (prefixes.to[i] - prefixes.at[i]) * per_slice;
    behind[source] = (prefixes.at[i] - (plan.cut_short ? prefixes.from[i] : 0.0F)) * per_slice;
  }
}

}  // namespace

void sweepLengths(std::span<const Vec3> positions, std::span<const Vec3> axes, const SweepField& field, double ray_length,
                  const std::function<void(size_t, std::span<const float>)>& use) {
  uint64_t moved = 0;
  const SweepPlan plan = makePlan(cellPositions(positions, field.coverage, moved), axes, field.coverage, ray_length, field.sliced);
  const size_t groups = (axes.size() + kAxesTogether - 1) / kAxesTogether;
  parallelBlocks(groups, 1, [&](size_t begin, size_t end) {
    Prefixes prefixes;
    std::vector<float> lengths;
    for (size_t group = begin; group < end; ++group) {
      const size_t first = group * kAxesTogether, count = std::min(kAxesTogether, axes.size() - first);
      lengths.resize(2 * count * positions.size());
      for (size_t i = 0; i < count; ++i)
        addLengths(plan, field.coverage.frame.voxel_size, axes[first + i], prefixes, lengths.data() + 2 * i * positions.size());
      use(first, lengths);
    }
  });
}

struct SweptPoints::State {
  SlicedFields sliced;
  double voxel_size;
  SweepPlan plan;
};

SweptPoints::SweptPoints(std::span<const Vec3> positions, const CoverageField& field, double ray_length)
    : state_(new State{slicedFields(field), field.frame.voxel_size, {}}) {
  static constexpr Vec3 kMainAxes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  // one per job, so that all of them have their points
  uint64_t moved = 0;
  state_->plan = makePlan(cellPositions(positions, field, moved), kMainAxes, field, ray_length, state_->sliced);
}
SweptPoints::~SweptPoints() = default;

std::vector<float> SweptPoints::lengths(Vec3 direction) const {
  Prefixes prefixes;
  const size_t points = state_->plan.cell_positions.size();
  std::vector<float> both(2 * points);
  addLengths(state_->plan, state_->voxel_size, direction, prefixes, both.data());
  both.resize(points);
  return both;
}

std::vector<float> sweptLengths(std::span<const Vec3> positions, std::span<const Vec3> axes, const SweepField& field, double ray_length) {
  std::vector<float> lengths(2 * axes.size() * positions.size());
  sweepLengths(positions, axes, field, ray_length, [&](size_t first, std::span<const float> some) {
    std::copy(some.begin(), some.end(), lengths.begin() + ptrdiff_t(2 * first * positions.size()));
  });
  return lengths;
}

}  // namespace cloudbake
