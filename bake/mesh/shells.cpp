// The winding number at p is the sum of the triangles' signed solid angles over 4π (A. Jacobson, L. Kavan, O. Sorkine-Hornung, "Robust
// Inside-Outside Segmentation using Generalized Winding Numbers", SIGGRAPH 2013, equations 5, 6), each by A. Van Oosterom, J. Strackee,
// "The Solid Angle of a Plane Triangle", IEEE Trans. Biomed. Eng. 30, 1983:
//   tan(Ω/2) = a·(b×c) / (|a||b||c| + (a·b)|c| + (b·c)|a| + (c·a)|b|)      with a, b, c from p
// Of a large shell, triangles that are far from p count together, as Σ area · (c − p) / |c − p|³ around their middle c (G. Barill, N.
// Dickson, R. Schmidt, D. Levin, A. Jacobson, "Fast Winding Numbers for Soups and Clouds", ACM TOG 37(4), 2018).
#include "bake/mesh/shells.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "core/parallel.h"
#include "core/portable_math.h"

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

Vec3d& operator+=(Vec3d& a, const Vec3d& b) { return a = {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec3d operator*(const Vec3d& a, double s) { return {a.x * s, a.y * s, a.z * s}; }
double lengthOf(const Vec3d& a) { return std::sqrt(dot(a, a)); }
Vec3d toDouble(Vec3 v) { return {v.x, v.y, v.z}; }

// Half of a triangle's solid angle.
double halfAngle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double la = lengthOf(a), lb = lengthOf(b), lc = lengthOf(c);
  return portableAtan2(triple(a, b, c), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

// Halves the indices begin … end at the middle of their longest side. `middle(i)` is a point per index.
template <class Middle>
size_t halved(std::vector<uint32_t>& indices, size_t begin, size_t end, const Middle& middle) {
  Box box;
  for (size_t i = begin; i < end; ++i) box.add(middle(indices[i]));
  const Vec3 size = box.size();
  float Vec3::*const axis = size.x >= size.y && size.x >= size.z ? &Vec3::x : size.y >= size.z ? &Vec3::y : &Vec3::z;
  const size_t half = (begin + end) / 2;
  std::nth_element(indices.begin() + ptrdiff_t(begin), indices.begin() + ptrdiff_t(half), indices.begin() + ptrdiff_t(end),
                   [&](uint32_t a, uint32_t b) { return std::pair(middle(a).*axis, a) < std::pair(middle(b).*axis, b); });
  return half;
}

// The triangles of a shell as a tree.
class ShellTree {
 public:
  ShellTree(const SurfaceMesh& welded, const Shell& shell) : mesh_(welded), triangles_(shell.triangles) { add(0, triangles_.size()); }
  double windingNumber(const Vec3d& point) const { return halfAngles(0, point) / (2 * double(kPi)); }

 private:
  static constexpr size_t kFew = 8;
  static constexpr double kFar = 2;  // times the radius
  struct Node {
    Vec3d middle{}, area{};
    double radius = 0;
    size_t begin, end, second = 0;  // the first half follows its node
  };

  Vec3 corner(uint32_t f, size_t k) const { return mesh_.positions[mesh_.triangles[f][k]]; }
  Vec3 center(uint32_t f) const { return (corner(f, 0) + corner(f, 1) + corner(f, 2)) / 3; }

  void add(size_t begin, size_t end) {
    const size_t index = nodes_.size();
    Node node{.begin = begin, .end = end};
    double weight = 0;
    for (size_t i = begin; i < end; ++i) {
      const uint32_t f = triangles_[i];
      const Vec3d u = between(corner(f, 0), corner(f, 1)), v = between(corner(f, 0), corner(f, 2));
      const Vec3d area = Vec3d{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x} * 0.5;
      node.area += area, weight += lengthOf(area);
      node.middle += toDouble(center(f)) * lengthOf(area);
    }
    node.middle = weight > 0 ? node.middle * (1 / weight) : toDouble(center(triangles_[begin]));
    for (size_t i = begin; i < end; ++i)
      for (size_t k = 0; k < 3; ++k) {
        Vec3d away = toDouble(corner(triangles_[i], k));
        node.radius = std::max(node.radius, lengthOf(away += node.middle * -1));
      }
    nodes_.push_back(node);
    if (end - begin <= kFew) return;
    const size_t half = halved(triangles_, begin, end, [&](uint32_t f) { return center(f); });
    add(begin, half);
    nodes_[index].second = nodes_.size();
    add(half, end);
  }

  double halfAngles(size_t index, const Vec3d& point) const {
    const Node& node = nodes_[index];
    Vec3d away = node.middle;
    away += point * -1;
    const double distance = lengthOf(away);
    if (distance > kFar * node.radius) return dot(node.area, away) / (2 * distance * distance * distance);
    if (node.second != 0) return halfAngles(index + 1, point) + halfAngles(node.second, point);
    double sum = 0;
    for (size_t i = node.begin; i < node.end; ++i) {
      Vec3d corners[3];
      for (size_t k = 0; k < 3; ++k) corners[k] = toDouble(corner(triangles_[i], k)), corners[k] += point * -1;
      sum += halfAngle(corners[0], corners[1], corners[2]);
    }
    return sum;
  }

  const SurfaceMesh& mesh_;
  std::vector<uint32_t> triangles_;
  std::vector<Node> nodes_;
};

bool isStrictlyInside(const Box& inner, const Box& outer) {
  return inner.low.x > outer.low.x && inner.low.y > outer.low.y && inner.low.z > outer.low.z && inner.high.x < outer.high.x &&
         inner.high.y < outer.high.y && inner.high.z < outer.high.z;
}

// The boxes of shells as a tree, to find those around another one.
class BoxTree {
 public:
  BoxTree(const std::vector<Shell>& shells, std::vector<uint32_t> chosen) : shells_(shells), chosen_(std::move(chosen)) {
    if (!chosen_.empty()) add(0, chosen_.size());
  }
  // Whether test(shell) holds for one whose box is around this one.
  template <class Test>
  bool anyAround(const Box& box, const Test& test, size_t index = 0) const {
    if (chosen_.empty() || !isStrictlyInside(box, nodes_[index].box)) return false;
    const Node& node = nodes_[index];
    if (node.second != 0) return anyAround(box, test, index + 1) || anyAround(box, test, node.second);
    return std::any_of(chosen_.begin() + ptrdiff_t(node.begin), chosen_.begin() + ptrdiff_t(node.end),
                       [&](uint32_t shell) { return isStrictlyInside(box, shells_[shell].box) && test(shell); });
  }

 private:
  static constexpr size_t kFew = 4;
  struct Node {
    Box box;
    size_t begin, end, second = 0;
  };
  void add(size_t begin, size_t end) {
    const size_t index = nodes_.size();
    Node node{{}, begin, end};
    for (size_t i = begin; i < end; ++i) {
      node.box.add(shells_[chosen_[i]].box.low);
      node.box.add(shells_[chosen_[i]].box.high);
    }
    nodes_.push_back(node);
    if (end - begin <= kFew) return;
    const size_t half = halved(chosen_, begin, end, [&](uint32_t shell) { return shells_[shell].box.center(); });
    add(begin, half);
    nodes_[index].second = nodes_.size();
    add(half, end);
  }

  const std::vector<Shell>& shells_;
  std::vector<uint32_t> chosen_;
  std::vector<Node> nodes_;
};

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
    sum += halfAngle(a, b, c);
  }
  return sum / (2 * double(kPi));
}

std::vector<bool> innerShells(const SurfaceMesh& welded, const std::vector<Shell>& shells) {
  constexpr size_t kFewestThatEnclose = 4;
  std::vector<uint32_t> enclosing;
  for (uint32_t i = 0; i < shells.size(); ++i)
    if (shells[i].triangles.size() >= kFewestThatEnclose) enclosing.push_back(i);
  std::vector<std::unique_ptr<const ShellTree>> trees(shells.size());
  if (shells.size() > 1)
    parallelFor(enclosing.size(), [&](size_t i) { trees[enclosing[i]] = std::make_unique<ShellTree>(welded, shells[enclosing[i]]); });
  const BoxTree boxes(shells, enclosing);
  std::vector<uint8_t> inner(shells.size());
  parallelFor(shells.size(), [&](size_t i) {
    const Vec3d point = toDouble(welded.positions[welded.triangles[shells[i].triangles.front()][0]]);
    inner[i] = shells.size() > 1 && boxes.anyAround(shells[i].box, [&](uint32_t other) {
      return other != i && std::fabs(trees[other]->windingNumber(point)) > 0.5;
    });
  });
  return {inner.begin(), inner.end()};
}

}  // namespace cloudbake
