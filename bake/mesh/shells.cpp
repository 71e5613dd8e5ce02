// The winding number at p is the sum of the triangles' signed solid angles over 4π (A. Jacobson, L. Kavan, O. Sorkine-Hornung, "Robust
// Inside-Outside Segmentation using Generalized Winding Numbers", SIGGRAPH 2013, equations 5, 6), each by A. Van Oosterom, J. Strackee,
// "The Solid Angle of a Plane Triangle", IEEE Trans. Biomed. Eng. 30, 1983:
//   tan(Ω/2) = a·(b×c) / (|a||b||c| + (a·b)|c| + (b·c)|a| + (c·a)|b|)      with a, b, c from p
#include "bake/mesh/shells.h"

#include <cmath>
#include <numeric>

namespace cloudbake {

namespace {

// Disjoint sets by path halving.
struct Groups {
  std::vector<uint32_t> parent;
  explicit Groups(size_t count) : parent(count) { std::iota(parent.begin(), parent.end(), 0U); }
  uint32_t rootOf(uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  }
  void join(uint32_t a, uint32_t b) { parent[rootOf(a)] = rootOf(b); }
};

struct Vec3d {
  double x, y, z;
};
Vec3d between(Vec3 from, Vec3 to) { return {double(to.x) - from.x, double(to.y) - from.y, double(to.z) - from.z}; }
double dot(const Vec3d& a, const Vec3d& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
double triple(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
}

}  // namespace

std::vector<Shell> shellsOf(const SurfaceMesh& welded) {
  Groups groups(welded.positions.size());
  for (const Triangle& t : welded.triangles) groups.join(t[0], t[1]), groups.join(t[1], t[2]);
  std::vector<Shell> shells;
  std::vector<uint32_t> shell_of(welded.positions.size(), UINT32_MAX);
  for (uint32_t f = 0; f < welded.triangles.size(); ++f) {
    const Triangle& t = welded.triangles[f];
    uint32_t& shell = shell_of[groups.rootOf(t[0])];
    if (shell == UINT32_MAX) shell = uint32_t(shells.size()), shells.emplace_back();
    shells[shell].triangles.push_back(f);
    for (const uint32_t v : t) shells[shell].box.add(welded.positions[v]);
  }
  for (Shell& shell : shells) {
    const Vec3 center = shell.box.center();
    for (const uint32_t f : shell.triangles) {
      const Triangle& t = welded.triangles[f];
      shell.volume += triple(between(center, welded.positions[t[0]]), between(center, welded.positions[t[1]]),
                             between(center, welded.positions[t[2]])) /
                      6;
    }
  }
  return shells;
}

double windingNumber(const SurfaceMesh& welded, const Shell& shell, Vec3 point) {
  double sum = 0;
  for (const uint32_t f : shell.triangles) {
    const Triangle& t = welded.triangles[f];
    const Vec3d a = between(point, welded.positions[t[0]]), b = between(point, welded.positions[t[1]]),
                c = between(point, welded.positions[t[2]]);
    const double la = std::sqrt(dot(a, a)), lb = std::sqrt(dot(b, b)), lc = std::sqrt(dot(c, c));
    sum += std::atan2(triple(a, b, c), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (2 * double(kPi));
}

bool liesInside(const SurfaceMesh& welded, const Shell& inner, const Shell& outer) {
  const Vec3 low = inner.box.low, high = inner.box.high;
  const bool boxed = low.x > outer.box.low.x && low.y > outer.box.low.y && low.z > outer.box.low.z && high.x < outer.box.high.x &&
                     high.y < outer.box.high.y && high.z < outer.box.high.z;
  if (!boxed) return false;
  const Vec3 point = welded.positions[welded.triangles[inner.triangles.front()][0]];
  return std::fabs(windingNumber(welded, outer, point)) > 0.5;
}

}  // namespace cloudbake
