// Each triangle's normal is weighted by its angle at the vertex, so that the result does not depend on the tessellation (G. Thürmer,
// C. Wüthrich, "Computing Vertex Normals from Polygonal Facets", JGT 3(1), 1998). Where a fold lets these cancel, the weights are areas,
// whose sum is that of what lies around the fold.
#include "core/vertex_normals.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace cloudbake {

namespace {

constexpr float kCancelled = 1e-4F;  // of the sum of the weights

// atan2(y, x) for y >= 0, within 2e-7 relative: M. Abramowitz, I. Stegun, "Handbook of Mathematical Functions" (1964), 4.4.49. It
// takes less time than the library's, and has the same bits everywhere.
float angleOf(double y, double x) {
  const double along = std::fabs(x), small = std::min(y, along), large = std::max(y, along);
  const auto r = float(small / large);
  const float s = r * r;
  float sum = 0.0028662257F;
  for (const float coefficient :
       {-0.0161657367F, 0.0429096138F, -0.0752896400F, 0.1065626393F, -0.1420889944F, 0.1999355085F, -0.3333314528F, 1.0F})
    sum = sum * s + coefficient;
  const float first = sum * r, quadrant = y > along ? float(kPi / 2) - first : first;
  return x < 0 ? float(kPi) - quadrant : quadrant;
}

// In double, because products of four finite floats neither overflow nor vanish there.
struct Edge {
  double x, y, z;
};
Edge edge(Vec3 from, Vec3 to) { return {double(to.x) - from.x, double(to.y) - from.y, double(to.z) - from.z}; }
double dot(const Edge& a, const Edge& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// Sums of normals weighted by area, for the vertices marked.
std::vector<Vec3> areaNormals(std::span<const Vec3> positions, std::span<const Triangle> triangles, const std::vector<bool>& marked) {
  std::vector<Vec3> sums(positions.size());
  std::vector<float> areas(positions.size());
  for (const Triangle& t : triangles)
    for (size_t corner = 0; corner < 3; ++corner) {
      if (!marked[t[corner]]) continue;
      const Vec3 area = cross(positions[t[1]] - positions[t[0]], positions[t[2]] - positions[t[0]]);
      sums[t[corner]] += area, areas[t[corner]] += length(area);
    }
  for (size_t v = 0; v < sums.size(); ++v)
    if (!(length(sums[v]) > kCancelled * areas[v])) sums[v] = {};
  return sums;
}

}  // namespace

namespace {

// Adds the normals of all triangles at the vertices [begin, end), in the order of the triangles.
void addNormals(std::span<const Vec3> positions, std::span<const Triangle> triangles, size_t begin, size_t end, std::span<Vec3> normals,
                std::span<float> angles) {
  const auto is_here = [&](uint32_t vertex) { return vertex - begin < end - begin; };
  for (const Triangle& t : triangles) {
    if (!is_here(t[0]) && !is_here(t[1]) && !is_here(t[2])) continue;
    const Edge a = edge(positions[t[0]], positions[t[1]]), b = edge(positions[t[1]], positions[t[2]]),
               c = edge(positions[t[2]], positions[t[0]]);
    const Edge area{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    const double twice_area = std::sqrt(dot(area, area));
    if (!(twice_area > 0) || !std::isfinite(twice_area)) continue;
    const double inverse = 1 / twice_area;
    const Vec3 normal{float(area.x * inverse), float(area.y * inverse), float(area.z * inverse)};
    const auto add = [&](uint32_t vertex, double cosine) {  // the cross product of any two edges has this length
      if (!is_here(vertex)) return;
      const float angle = angleOf(twice_area, cosine);
      normals[vertex] += normal * angle;
      angles[vertex] += angle;
    };
    add(t[0], -dot(a, c));
    add(t[1], -dot(a, b));
    add(t[2], -dot(b, c));
  }
}

}  // namespace

std::vector<Vec3> vertexNormals(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  std::vector<Vec3> normals(positions.size());
  std::vector<float> angles(positions.size());
  // Every thread reads all triangles, of which most have all corners at one thread's vertices. Few of them are not worth it.
  constexpr size_t kLeastPerPart = 1 << 14, kMostParts = 8;
  const size_t parts = std::clamp<size_t>(positions.size() / kLeastPerPart, 1, std::min(threadCount(), kMostParts));
  parallelFor(parts, [&](size_t part) {
    addNormals(positions, triangles, part * positions.size() / parts, (part + 1) * positions.size() / parts, normals, angles);
  });
  std::vector<bool> cancelled(positions.size());
  for (size_t v = 0; v < normals.size(); ++v) cancelled[v] = angles[v] > 0 && !(length(normals[v]) > kCancelled * angles[v]);
  if (std::find(cancelled.begin(), cancelled.end(), true) != cancelled.end()) {
    const std::vector<Vec3> others = areaNormals(positions, triangles, cancelled);
    for (size_t v = 0; v < normals.size(); ++v)
      if (others[v] != Vec3{}) normals[v] = others[v];
  }
  parallelBlocks(normals.size(), kLeastPerPart, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) normals[v] = normalized(normals[v]).value_or(Vec3{});
  });
  return normals;
}

}  // namespace cloudbake
