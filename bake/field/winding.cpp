// A triangle covers a column if the column's foot (x, y) lies inside its projection, that is, if three edge functions
//   E(a,b; p) = (b.x − a.x)(p.y − a.y) − (b.y − a.y)(p.x − a.x)
// have the same sign. Rounded to 2⁻¹⁶ voxel, coordinates have 30 bits, differences 31 and products 62, so int64 is exact. A foot on an
// edge (E = 0) belongs to the triangle for which the edge is a left or a top edge; this is the fill rule of rasterisers (J. Pineda,
// SIGGRAPH 1988). The rule depends only on the edge's direction, so exactly one of the two triangles of an edge owns it. The same holds
// for corners.
#include "bake/field/winding.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "core/parallel.h"

namespace cloudbake {

namespace {

constexpr int kFractionBits = 16;
constexpr double kScale = 1 << kFractionBits;
constexpr size_t kTogether = 1 << 15;  // points or triangles of a task

struct FixedPoint {
  int64_t x, y, z;
};

int64_t edgeFunction(const FixedPoint& a, const FixedPoint& b, int64_t x, int64_t y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

// Exactly one of the two directions of an edge owns the points on it.
bool ownsEdge(const FixedPoint& a, const FixedPoint& b) { return b.y < a.y || (b.y == a.y && b.x < a.x); }

int floorToColumn(int32_t fixed) { return fixed >> kFractionBits; }
int ceilToColumn(int32_t fixed) { return (fixed + (1 << kFractionBits) - 1) >> kFractionBits; }

// Calls visit(x, y, z, sign) for every column of [x_low, x_high] × [y_low, y_high] that the triangle covers.
template <class Visit>
void scanTriangle(FixedPoint a, FixedPoint b, FixedPoint c, int x_low, int x_high, int y_low, int y_high, const Visit& visit) {
  const int64_t twice_area = edgeFunction(a, b, c.x, c.y);
  if (twice_area == 0) return;
  const int sign = twice_area > 0 ? -1 : 1;  // counter-clockwise from above: the normal points up, so +z leaves the solid
  if (twice_area < 0) std::swap(b, c);
  const double area = std::abs(double(twice_area)) * kScale;
  const bool own_ab = ownsEdge(a, b), own_bc = ownsEdge(b, c), own_ca = ownsEdge(c, a);
  for (int y = y_low; y <= y_high; ++y)
    for (int x = x_low; x <= x_high; ++x) {
      const int64_t fx = int64_t(x) << kFractionBits, fy = int64_t(y) << kFractionBits;
      const int64_t e_ab = edgeFunction(a, b, fx, fy), e_bc = edgeFunction(b, c, fx, fy), e_ca = edgeFunction(c, a, fx, fy);
      const bool inside = (e_ab > 0 || (e_ab == 0 && own_ab)) && (e_bc > 0 || (e_bc == 0 && own_bc)) && (e_ca > 0 || (e_ca == 0 && own_ca));
      if (inside) visit(x, y, float((double(e_bc) * double(a.z) + double(e_ca) * double(b.z) + double(e_ab) * double(c.z)) / area), sign);
    }
}

// The columns along one axis while crossings are being collected.
struct ColumnScan {
  struct Found {
    uint32_t column;
    WindingColumns::Crossing crossing;
  };
  size_t x, y, z;  // the coordinates that take these roles
  WindingColumns columns;
  std::vector<std::vector<Found>> found;  // per chunk of triangles

  ColumnScan(const LatticePoints& points, size_t axis) : x((axis + 1) % 3), y((axis + 2) % 3), z(axis) {
    columns.x0 = points.low[x] - 1;
    columns.y0 = points.low[y] - 1;
    columns.columns_x = points.high[x] + 2 - columns.x0;
    columns.columns_y = points.high[y] + 2 - columns.y0;
    columns.first.assign(size_t(columns.columns_x) * size_t(columns.columns_y) + 1, 0);
  }
  void add(size_t chunk, int column_x, int column_y, float height, int sign) {
    found[chunk].push_back({uint32_t((column_y - columns.y0) * columns.columns_x + (column_x - columns.x0)), {height, sign}});
  }
};

// Finds the crossings of each axis's columns. Most triangles of a fine mesh lie between the columns; one test of their box finds this
// for all axes.
void scanChunk(const LatticePoints& points, std::span<const Triangle> triangles, size_t chunk, std::span<ColumnScan> scans) {
  for (const Triangle& t : triangles) {
    const auto &a = points.fixed[t[0]], &b = points.fixed[t[1]], &c = points.fixed[t[2]];
    std::array<int, 3> low, high;
    for (size_t n = 0; n < 3; ++n) {
      low[n] = ceilToColumn(std::min(std::min(a[n], b[n]), c[n]));
      high[n] = floorToColumn(std::max(std::max(a[n], b[n]), c[n]));
    }
    for (ColumnScan& scan : scans) {
      const size_t x = scan.x, y = scan.y, z = scan.z;
      if (low[x] > high[x] || low[y] > high[y]) continue;
      scanTriangle({a[x], a[y], a[z]}, {b[x], b[y], b[z]}, {c[x], c[y], c[z]}, low[x], high[x], low[y], high[y],
                   [&](int column_x, int column_y, float height, int sign) { scan.add(chunk, column_x, column_y, height, sign); });
    }
  }
}

void scanAll(const LatticePoints& points, std::span<const Triangle> triangles, std::span<ColumnScan> scans) {
  const size_t chunks = (triangles.size() + kTogether - 1) / kTogether;
  for (ColumnScan& scan : scans) scan.found.resize(chunks);
  parallelFor(chunks, [&](size_t chunk) {
    const size_t first = chunk * kTogether;
    scanChunk(points, triangles.subspan(first, std::min(kTogether, triangles.size() - first)), chunk, scans);
  });
}

// Sorts the crossings by column and height.
WindingColumns sortedColumns(ColumnScan& scan) {
  WindingColumns columns = std::move(scan.columns);
  for (const auto& of_chunk : scan.found)
    for (const ColumnScan::Found& found : of_chunk) ++columns.first[found.column + 1];
  for (size_t i = 1; i < columns.first.size(); ++i) columns.first[i] += columns.first[i - 1];
  columns.crossings.resize(columns.first.back());
  std::vector<uint32_t> next(columns.first.begin(), columns.first.end() - 1);
  for (const auto& of_chunk : scan.found)
    for (const auto& [column, crossing] : of_chunk) columns.crossings[next[column]++] = crossing;
  const auto is_below = [](const auto& a, const auto& b) { return a.z != b.z ? a.z < b.z : a.sign > b.sign; };
  for (size_t i = 0; i + 1 < columns.first.size(); ++i)
    if (columns.first[i + 1] - columns.first[i] > 1)
      std::sort(columns.crossings.begin() + columns.first[i], columns.crossings.begin() + columns.first[i + 1], is_below);
  return columns;
}

}  // namespace

LatticePoints latticePoints(std::span<const Vec3> positions_index) {
  LatticePoints points;
  points.fixed.resize(positions_index.size());
  Box box;
  std::mutex mutex;
  const auto rounded = [](float x) { return int32_t(double(x) * kScale + (x < 0 ? -0.5 : 0.5)); };
  parallelBlocks(positions_index.size(), kTogether, [&](size_t begin, size_t end) {
    Box own;
    for (size_t v = begin; v < end; ++v) {
      const Vec3& p = positions_index[v];
      own.add(p);
      points.fixed[v] = {rounded(p.x), rounded(p.y), rounded(p.z)};
    }
    const std::lock_guard lock(mutex);
    box.add(own.low), box.add(own.high);
  });
  if (box.empty()) return points;
  points.low = {int(std::floor(box.low.x)), int(std::floor(box.low.y)), int(std::floor(box.low.z))};
  points.high = {int(std::ceil(box.high.x)), int(std::ceil(box.high.y)), int(std::ceil(box.high.z))};
  return points;
}

WindingColumns windingColumns(const LatticePoints& points, std::span<const Triangle> triangles) {
  ColumnScan scan(points, 2);
  scanAll(points, triangles, {&scan, 1});
  return sortedColumns(scan);
}

std::array<WindingColumns, 3> windingColumnsOfAxes(const LatticePoints& points, std::span<const Triangle> triangles) {
  std::array<ColumnScan, 3> scans{ColumnScan(points, 0), ColumnScan(points, 1), ColumnScan(points, 2)};
  scanAll(points, triangles, scans);
  std::array<WindingColumns, 3> columns;
  parallelFor(columns.size(), [&](size_t axis) { columns[axis] = sortedColumns(scans[axis]); });
  return columns;
}

int windingNumber(const WindingColumns& columns, int x, int y, float z) {
  if (x < columns.x0 || y < columns.y0 || x >= columns.x0 + columns.columns_x || y >= columns.y0 + columns.columns_y) return 0;
  const size_t i = size_t(y - columns.y0) * size_t(columns.columns_x) + size_t(x - columns.x0);
  int winding = 0;
  for (uint32_t c = columns.first[i]; c < columns.first[i + 1] && columns.crossings[c].z < z; ++c) winding += columns.crossings[c].sign;
  return winding;
}

}  // namespace cloudbake
