// A triangle covers a column if the column's foot (x, y) lies inside its projection: three edge functions
//   E(a,b; p) = (b.x − a.x)(p.y − a.y) − (b.y − a.y)(p.x − a.x)
// of one sign. Rounded to 2⁻¹⁶ voxel, coordinates have 30 bits, differences 31, products 62: int64 is exact. A foot on an edge
// (E = 0) belongs to the triangle for which the edge is a left or a top edge: the fill rule of rasterisers (J. Pineda,
// SIGGRAPH 1988). As the rule asks only for the edge's direction, the two triangles of an edge never both take it or both
// leave it, and corners are shared out likewise.
#include "bake/winding.h"

#include <algorithm>
#include <cmath>

namespace cloudbake {

namespace {

constexpr int kFractionBits = 16;

struct FixedPoint {
  int64_t x, y;
  double z;
};

FixedPoint toFixed(Vec3 p) {
  const float scale = float(1 << kFractionBits);
  return {std::llround(double(p.x) * scale), std::llround(double(p.y) * scale), std::llround(double(p.z) * scale) / double(scale)};
}

int64_t edgeFunction(const FixedPoint& a, const FixedPoint& b, int64_t x, int64_t y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

// Of the two directions of an edge exactly one owns the points on it.
bool ownsEdge(const FixedPoint& a, const FixedPoint& b) { return b.y < a.y || (b.y == a.y && b.x < a.x); }

int floorToColumn(int64_t fixed) { return int(fixed >> kFractionBits); }
int ceilToColumn(int64_t fixed) { return int((fixed + (1 << kFractionBits) - 1) >> kFractionBits); }

// Calls visit(x, y, z, sign) for every column that the triangle covers.
template <class Visit>
void scanTriangle(FixedPoint a, FixedPoint b, FixedPoint c, const Visit& visit) {
  const int64_t twice_area = edgeFunction(a, b, c.x, c.y);
  if (twice_area == 0) return;
  const int sign = twice_area > 0 ? -1 : 1;  // counter-clockwise from above: the normal points up, +z leaves the solid
  if (twice_area < 0) std::swap(b, c);
  const double area = std::abs(double(twice_area));

  const int x_low = ceilToColumn(std::min({a.x, b.x, c.x})), x_high = floorToColumn(std::max({a.x, b.x, c.x}));
  const int y_low = ceilToColumn(std::min({a.y, b.y, c.y})), y_high = floorToColumn(std::max({a.y, b.y, c.y}));
  const bool own_ab = ownsEdge(a, b), own_bc = ownsEdge(b, c), own_ca = ownsEdge(c, a);
  for (int y = y_low; y <= y_high; ++y)
    for (int x = x_low; x <= x_high; ++x) {
      const int64_t fx = int64_t(x) << kFractionBits, fy = int64_t(y) << kFractionBits;
      const int64_t e_ab = edgeFunction(a, b, fx, fy), e_bc = edgeFunction(b, c, fx, fy), e_ca = edgeFunction(c, a, fx, fy);
      const bool inside = (e_ab > 0 || (e_ab == 0 && own_ab)) && (e_bc > 0 || (e_bc == 0 && own_bc)) && (e_ca > 0 || (e_ca == 0 && own_ca));
      if (inside) visit(x, y, float((double(e_bc) * a.z + double(e_ca) * b.z + double(e_ab) * c.z) / area), sign);
    }
}

}  // namespace

WindingColumns windingColumns(std::span<const Vec3> positions_index, std::span<const Triangle> triangles) {
  WindingColumns columns;
  if (positions_index.empty()) return columns;
  std::vector<FixedPoint> points;
  points.reserve(positions_index.size());
  for (const Vec3& p : positions_index) points.push_back(toFixed(p));

  // Extent of the columns.
  Box box;
  for (const Vec3& p : positions_index) box.add(p);
  columns.x0 = int(std::floor(box.low.x)) - 1;
  columns.y0 = int(std::floor(box.low.y)) - 1;
  columns.columns_x = int(std::ceil(box.high.x)) + 2 - columns.x0;
  columns.columns_y = int(std::ceil(box.high.y)) + 2 - columns.y0;
  const auto column = [&](int x, int y) { return size_t(y - columns.y0) * size_t(columns.columns_x) + size_t(x - columns.x0); };
  const auto scanAll = [&](const auto& visit) {
    for (const Triangle& t : triangles) scanTriangle(points[t[0]], points[t[1]], points[t[2]], visit);
  };

  // Count, offset, fill, sort.
  columns.first.assign(size_t(columns.columns_x) * size_t(columns.columns_y) + 1, 0);
  scanAll([&](int x, int y, float, int) { ++columns.first[column(x, y) + 1]; });
  for (size_t i = 1; i < columns.first.size(); ++i) columns.first[i] += columns.first[i - 1];
  columns.crossings.resize(columns.first.back());
  std::vector<uint32_t> next(columns.first.begin(), columns.first.end() - 1);
  scanAll([&](int x, int y, float z, int sign) { columns.crossings[next[column(x, y)]++] = {z, sign}; });
  for (size_t i = 0; i + 1 < columns.first.size(); ++i)
    std::sort(columns.crossings.begin() + columns.first[i], columns.crossings.begin() + columns.first[i + 1],
              [](const auto& a, const auto& b) { return a.z != b.z ? a.z < b.z : a.sign > b.sign; });
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
