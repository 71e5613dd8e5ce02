// Along a column the inside fraction is 0 or 1, or in between for cells that the surface crosses. Only the changes are written. Entering at
// z, in cell c = ⌊z + ½⌋, adds t = c + ½ − z to the change at c and the rest 1 − t to the change at c + 1; leaving subtracts the same. A
// running sum along the axis then gives the fractions. Heights are rounded to 2⁻¹² voxel, so that all sums are exact in float and empty
// cells are 0.
#include "bake/field/coverage.h"

#include <algorithm>
#include <cmath>

#include "bake/field/winding.h"
#include "bake/mesh/mesh_topology.h"
#include "core/parallel.h"

namespace cloudbake {

namespace {

constexpr int kMargin = 2;
constexpr float kHeightSteps = 4096;

// The strides of the cells in memory, for columns along an axis.
struct Strides {
  size_t x, y, z;  // memory strides of the column's x, y and z, with z along the axis
};
Strides stridesOf(const CoverageField& field, int axis) {
  const size_t steps[3] = {1, size_t(field.cells[0]), size_t(field.cells[0]) * size_t(field.cells[1])};
  return {steps[(axis + 1) % 3], steps[(axis + 2) % 3], steps[axis]};
}

// Writes the changes of all columns of one axis. Returns false if a column does not close.
bool addChanges(const WindingColumns& columns, const CoverageField& field, int axis, std::vector<float>& changes) {
  const Strides stride = stridesOf(field, axis);
  const size_t ax = size_t(axis + 1) % 3, ay = size_t(axis + 2) % 3, az = size_t(axis);
  const auto change = [&](float* column, float z, float amount) {
    const float from_low = z + 0.5F - float(field.first[az]);
    const int cell = int(from_low);  // positive, so the cast rounds down, and so does that of the nearest step
    const float nearest_step = (float(cell + 1) - from_low) * kHeightSteps + 0.5F;
    const float share = float(int(nearest_step)) / kHeightSteps;
    float* at = column + size_t(cell) * stride.z;
    at[0] += amount * share;
    at[stride.z] += amount * (1 - share);
  };
  for (size_t i = 0; i + 1 < columns.first.size(); ++i) {
    if (columns.first[i] == columns.first[i + 1]) continue;
    const size_t x = i % size_t(columns.columns_x) + size_t(columns.x0 - field.first[ax]);
    const size_t y = i / size_t(columns.columns_x) + size_t(columns.y0 - field.first[ay]);
    float* column = changes.data() + x * stride.x + y * stride.y;
    int winding = 0;
    for (uint32_t c = columns.first[i]; c < columns.first[i + 1]; ++c) {
      const auto& [z, sign] = columns.crossings[c];
      if (winding == 0) change(column, z, 1);
      winding += sign;
      if (winding == 0) change(column, z, -1);
    }
    if (winding != 0) return false;
  }
  return true;
}

// Adds the running sums of the changes along the axis to the field, and clears the changes for the next axis.
void addRunningSums(CoverageField& field, int axis, std::vector<float>& changes) {
  const size_t row = size_t(field.cells[0]), plane = row * size_t(field.cells[1]), all = plane * size_t(field.cells[2]);
  float* c = changes.data();
  float* f = field.fractions.data();
  const auto rows = size_t(field.cells[1]), planes = size_t(field.cells[2]);
  if (axis == 0) {
    parallelFor(planes, [&](size_t k) {
      for (size_t first = k * plane; first < (k + 1) * plane; first += row) {
        float share = 0;
        for (size_t i = first; i < first + row; ++i) f[i] += share += c[i];
      }
    });
  } else if (axis == 1) {
    parallelFor(planes, [&](size_t k) {
      for (size_t i = k * plane + row; i < (k + 1) * plane; ++i) f[i] += c[i] += c[i - row];
    });
  } else {
    parallelFor(rows, [&](size_t j) {
      for (size_t first = plane + j * row; first < all; first += plane)
        for (size_t i = first; i < first + row; ++i) f[i] += c[i] += c[i - plane];
    });
  }
  std::fill(changes.begin(), changes.end(), 0.0F);
}

}  // namespace

CoverageField emptyField(const GridFrame& frame, const std::array<int, 3>& low, const std::array<int, 3>& high) {
  CoverageField field{frame, {}, {}, {}};
  for (size_t a = 0; a < 3; ++a) {
    field.first[a] = low[a] - kMargin;
    field.cells[a] = high[a] - low[a] + 1 + 2 * kMargin;
  }
  field.fractions.assign(size_t(field.cells[0]) * size_t(field.cells[1]) * size_t(field.cells[2]), 0.0F);
  return field;
}

double estimateCoverageBytes(const Box& box, double voxel_size) {
  double sides[3], cells = 1, planes = 0;
  for (size_t a = 0; const float side : {box.size().x, box.size().y, box.size().z})
    cells *= sides[a++] = side / voxel_size + 2 * kMargin + 2;
  // A sweep shears by up to the number of slices in either direction.
  for (size_t a = 0; a < 3; ++a) planes = std::max(planes, 2 * (sides[(a + 1) % 3] + sides[a]) * (sides[(a + 2) % 3] + sides[a]));
  return (4 * cells + planes * threadCount()) * sizeof(float);
}

std::optional<CoverageField> coverageFromMesh(const SurfaceMesh& mesh, const GridFrame& frame) {
  constexpr size_t kGrain = 1 << 15;
  std::vector<Vec3> positions(mesh.positions.size());
  parallelBlocks(positions.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) positions[v] = frame.toIndex(mesh.positions[v]);
  });
  const LatticePoints points = latticePoints(positions);

  CoverageField field = emptyField(frame, points.low, points.high);
  std::vector<float> changes(field.fractions.size(), 0.0F);
  const std::array<WindingColumns, 3> columns = windingColumnsOfAxes(points, mesh.triangles);
  for (int axis = 0; axis < 3; ++axis) {
    if (!addChanges(columns[size_t(axis)], field, axis, changes)) return std::nullopt;
    addRunningSums(field, axis, changes);
  }
  for (float& fraction : field.fractions) fraction *= 1.0F / 3;
  return field;
}

std::optional<CoverageField> coverageFromClosedMesh(const SurfaceMesh& mesh, const LevelSetSettings& settings, Warnings& warnings) {
  const GridFrame frame = meshFrame(mesh, settings, estimateCoverageBytes, warnings);
  std::optional<CoverageField> field = coverageFromMesh(mesh, frame);
  if (!field) return field;
  double cells = 0;
  for (const float fraction : field->fractions) cells += double(fraction);
  warnIfNotHeld(signedVolume(mesh), cells * frame.voxel_size * frame.voxel_size * frame.voxel_size, warnings);
  return field;
}

}  // namespace cloudbake
