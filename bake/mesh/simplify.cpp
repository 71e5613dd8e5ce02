// Half-edge collapses in order of their quadric error (M. Garland, P. Heckbert, Simplifying Surfaces with Color and Texture using Quadric
// Error Metrics, IEEE Visualization 1998): every triangle spans a plane in the six dimensions of position and light, and an error is the
// squared distance to such planes, Q(x) = xᵀAx + 2bᵀx + c with A = I − e₁e₁ᵀ − e₂e₂ᵀ. OpenMesh keeps the topology and the queue.
#include "bake/mesh/simplify.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModBaseT.hh>
#include <OpenMesh/Tools/Decimater/Observer.hh>

#include <algorithm>

#include "bake/mesh/mesh_topology.h"
#include "core/distinct_positions.h"

namespace cloudbake {

namespace {

using Point = std::array<double, 6>;  // position as shares of the longest side, then light

double dot(const Point& a, const Point& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}
Point along(const Point& a, double t, const Point& b) {
  Point sum;
  for (size_t i = 0; i < a.size(); ++i) sum[i] = a[i] + t * b[i];
  return sum;
}
// The part of `a` across the unit vectors, of unit length; zero if there is none.
Point unitAcross(Point a, std::initializer_list<Point> others) {
  for (const Point& other : others) a = along(a, -dot(a, other), other);
  const double length = std::sqrt(dot(a, a));
  return length > 0 ? along({}, 1 / length, a) : Point{};
}

struct Quadric {
  std::array<Point, 6> a{};
  Point b{};
  double c = 0, weight = 0;

  Quadric& operator+=(const Quadric& other) {
    for (size_t i = 0; i < 6; ++i) a[i] = along(a[i], 1, other.a[i]);
    b = along(b, 1, other.b);
    c += other.c, weight += other.weight;
    return *this;
  }
  double at(const Point& x) const {
    double error = c + 2 * dot(b, x);
    for (size_t i = 0; i < 6; ++i) error += x[i] * dot(a[i], x);
    return std::max(0.0, error);
  }
  // The squared distance from p, where it is not along the unit vectors of `free`, or only where it is along `bound`.
  static Quadric distance(const Point& p, std::span<const Point> free, std::span<const Point> bound, double weight) {
    Quadric q;
    for (size_t i = 0; i < 6 && bound.empty(); ++i) q.a[i][i] = weight;
    for (size_t i = 0; i < 6; ++i) {
      for (const Point& e : free) q.a[i] = along(q.a[i], -weight * e[i], e);
      for (const Point& e : bound) q.a[i] = along(q.a[i], weight * e[i], e);
    }
    for (size_t i = 0; i < 6; ++i) q.b[i] = -dot(q.a[i], p);
    q.c = -dot(q.b, p), q.weight = weight;
    return q;
  }
};

struct Traits : OpenMesh::DefaultTraitsDouble {
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge | OpenMesh::Attributes::Status);
};
using HalfEdges = OpenMesh::TriMesh_ArrayKernelT<Traits>;

// The surface over distinct positions, which are OpenMesh's vertices. `corners` are vertices of the mesh itself, per face.
struct Welded {
  HalfEdges edges;
  std::vector<uint32_t> position_of;  // per vertex of the mesh
  std::vector<Triangle> corners;
  std::vector<Triangle> apart;      // what has no place among half-edges
  std::vector<Point> points;        // per position
  std::vector<size_t> faces_using;  // per vertex of the mesh
  size_t used = 0;                  // vertices of the mesh with a face

  // The corner of a face at a position.
  uint32_t& cornerAt(OpenMesh::FaceHandle face, OpenMesh::VertexHandle position) {
    Triangle& t = corners[size_t(face.idx())];
    return *std::find_if(t.begin(), t.end(), [&](uint32_t v) { return position_of[v] == uint32_t(position.idx()); });
  }
  bool isSeam(OpenMesh::HalfedgeHandle h) {
    const auto face = edges.face_handle(h), other = edges.face_handle(edges.opposite_halfedge_handle(h));
    const auto from = edges.from_vertex_handle(h), to = edges.to_vertex_handle(h);
    return face.is_valid() && other.is_valid() &&
           (cornerAt(face, from) != cornerAt(other, from) || cornerAt(face, to) != cornerAt(other, to));
  }
  void count(uint32_t vertex, bool added) {
    if (added && faces_using[vertex]++ == 0) ++used;
    if (!added && --faces_using[vertex] == 0) --used;
  }
};

Welded weld(const SurfaceMesh& mesh, std::span<const Vec3> light, const std::vector<bool>& held) {
  Welded welded;
  const Box box = boundingBox(mesh);
  DistinctPositions distinct(mesh.positions.size());
  std::vector<bool> locked;
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    welded.position_of.push_back(distinct.add(mesh.positions[v]));
    if (distinct.positions.size() > welded.points.size()) {
      const Vec3 p = (mesh.positions[v] - box.center()) / box.longestSide(), l = light[v];
      welded.points.push_back({p.x, p.y, p.z, l.x, l.y, l.z});
      welded.edges.add_vertex({p.x, p.y, p.z});
      locked.push_back(false);
    }
    if (!held.empty() && held[v]) locked[welded.position_of[v]] = true;
  }
  welded.faces_using.resize(mesh.positions.size());
  omerr().disable();  // it would print the faces that it refuses
  for (const Triangle& t : mesh.triangles) {
    const auto at = [&](size_t k) { return OpenMesh::VertexHandle(int(welded.position_of[t[k]])); };
    const bool has_place = hasDistinctCorners({uint32_t(at(0).idx()), uint32_t(at(1).idx()), uint32_t(at(2).idx())}) &&
                           welded.edges.add_face(at(0), at(1), at(2)).is_valid();
    (has_place ? welded.corners : welded.apart).push_back(t);
    for (size_t k = 0; k < 3; ++k) {
      welded.count(t[k], true);
      if (!has_place) locked[size_t(at(k).idx())] = true;
    }
  }
  for (const auto v : welded.edges.vertices())
    if (locked[size_t(v.idx())] || welded.edges.is_boundary(v)) welded.edges.status(v).set_locked(true);
  return welded;
}

// The order of the collapses, and which of them are refused.
class LightQuadrics : public OpenMesh::Decimater::ModBaseT<HalfEdges> {
 public:
  using Base = OpenMesh::Decimater::ModBaseT<HalfEdges>;
  using Handle = OpenMesh::Decimater::ModHandleT<LightQuadrics>;
  using CollapseInfo = Base::CollapseInfo;
  explicit LightQuadrics(HalfEdges& edges) : Base(edges, false) {}
  void attach(Welded& welded) {
    welded_ = &welded;
    quadrics_.assign(welded.points.size(), {});
    for (const auto face : welded.edges.faces()) addFace(face);
  }

  float collapse_priority(const CollapseInfo& c) override {
    constexpr double kMostDistance = 0.03;  // as a mean over the planes; what is left at seams would otherwise be all that is left
    if (!keepsSeams(c) || turnsTriangle(c)) return float(Base::ILLEGAL_COLLAPSE);
    Quadric q = quadrics_[size_t(c.v0.idx())];
    q += quadrics_[size_t(c.v1.idx())];
    const double error = q.at(welded_->points[size_t(c.v1.idx())]);
    return error > kMostDistance * kMostDistance * q.weight ? float(Base::ILLEGAL_COLLAPSE) : float(error);
  }

  void preprocess_collapse(const CollapseInfo& c) override {
    const Moves moves = movesOf(c);
    std::vector<OpenMesh::FaceHandle> around;
    for (auto f = welded_->edges.vf_iter(c.v0); f.is_valid(); ++f) around.push_back(*f);
    for (const auto f : around) {
      if (f == c.fl || f == c.fr) {
        for (const uint32_t v : welded_->corners[size_t(f.idx())]) welded_->count(v, false);
        continue;
      }
      uint32_t& corner = welded_->cornerAt(f, c.v0);
      welded_->count(corner, false);
      corner = *moves.of(corner);
      welded_->count(corner, true);
    }
    quadrics_[size_t(c.v1.idx())] += quadrics_[size_t(c.v0.idx())];
  }

 private:
  // The planes of a triangle, by its area, and those that stand on its seams, by their length.
  void addFace(OpenMesh::FaceHandle face) {
    constexpr double kSeam = 1;
    for (auto h = welded_->edges.fh_iter(face); h.is_valid(); ++h) {
      const size_t i = size_t(welded_->edges.from_vertex_handle(*h).idx()), j = size_t(welded_->edges.to_vertex_handle(*h).idx()),
                   k = size_t(welded_->edges.to_vertex_handle(welded_->edges.next_halfedge_handle(*h)).idx());
      const Point &p = welded_->points[i], edge = along(welded_->points[j], -1, p), side = along(welded_->points[k], -1, p);
      const Point e1 = unitAcross(edge, {}), e2 = unitAcross(side, {e1});
      const double squared = edge[0] * edge[0] + edge[1] * edge[1] + edge[2] * edge[2];
      const double area = welded_->edges.calc_sector_area(*h);
      quadrics_[i] += Quadric::distance(p, std::array{e1, e2}, {}, area);
      if (!welded_->isSeam(*h)) continue;
      const Point along_seam = unitAcross({edge[0], edge[1], edge[2]}, {});
      const Quadric seam =
          Quadric::distance(p, {}, std::array<Point, 1>{unitAcross({side[0], side[1], side[2]}, {along_seam})}, kSeam * squared);
      quadrics_[i] += seam, quadrics_[j] += seam;
    }
  }

  // Where the corners at v0 go: those of the two faces at the edge have a corner at v1 beside them.
  struct Moves {
    std::array<std::pair<uint32_t, uint32_t>, 2> all;
    size_t count = 0;
    const uint32_t* of(uint32_t corner) const {
      for (size_t i = 0; i < count; ++i)
        if (all[i].first == corner) return &all[i].second;
      return nullptr;
    }
  };
  Moves movesOf(const CollapseInfo& c) {
    Moves moves;
    for (const auto f : {c.fl, c.fr})
      if (f.is_valid()) moves.all[moves.count++] = {welded_->cornerAt(f, c.v0), welded_->cornerAt(f, c.v1)};
    return moves;
  }
  bool keepsSeams(const CollapseInfo& c) {
    const Moves moves = movesOf(c);
    if (moves.count == 2 && moves.all[0].first == moves.all[1].first && moves.all[0].second != moves.all[1].second) return false;
    for (auto f = welded_->edges.vf_iter(c.v0); f.is_valid(); ++f)
      if (!moves.of(welded_->cornerAt(*f, c.v0))) return false;
    return true;
  }
  bool turnsTriangle(const CollapseInfo& c) {
    constexpr double kLeastCosine = 0.25;
    for (auto h = welded_->edges.voh_iter(c.v0); h.is_valid(); ++h) {
      const auto f = welded_->edges.face_handle(*h);
      if (!f.is_valid() || f == c.fl || f == c.fr) continue;
      const auto a = welded_->edges.point(welded_->edges.to_vertex_handle(*h)),
                 b = welded_->edges.point(welded_->edges.to_vertex_handle(welded_->edges.next_halfedge_handle(*h)));
      const auto before = (a - c.p0).cross(b - c.p0), after = (a - c.p1).cross(b - c.p1);
      if (!(before.dot(after) > kLeastCosine * before.norm() * after.norm())) return true;
    }
    return false;
  }

  Welded* welded_ = nullptr;
  std::vector<Quadric> quadrics_;  // per position
};

// Ends the collapses when few enough vertices are left.
struct EnoughRemoved : OpenMesh::Decimater::Observer {
  explicit EnoughRemoved(const Welded& mesh) : Observer(1), welded(mesh) {}
  void notify(size_t /*collapses*/) override {}
  bool abort() const override { return welded.used <= count; }
  const Welded& welded;
  size_t count = 0;
};

}  // namespace

std::vector<std::vector<Triangle>> simplified(const SurfaceMesh& mesh, std::span<const Vec3> light, const std::vector<bool>& held,
                                              std::span<const size_t> vertex_counts) {
  Welded welded = weld(mesh, light, held);
  OpenMesh::Decimater::DecimaterT<HalfEdges> decimater(welded.edges);
  LightQuadrics::Handle order;
  decimater.add(order);
  decimater.module(order).attach(welded);
  decimater.initialize();
  EnoughRemoved enough(welded);
  decimater.set_observer(&enough);
  std::vector<std::vector<Triangle>> levels;
  for (const size_t count : vertex_counts) {
    enough.count = count;
    if (!enough.abort()) decimater.decimate();
    std::vector<Triangle>& triangles = levels.emplace_back(welded.apart);
    for (const auto face : welded.edges.faces())
      if (!welded.edges.status(face).deleted()) triangles.push_back(welded.corners[size_t(face.idx())]);
  }
  return levels;
}

}  // namespace cloudbake
