// Where the surface goes is found as optical flow is (B. Lucas, T. Kanade, "An Iterative Image Registration Technique with an Application
// to Stereo Vision", IJCAI 1981): a vertex only sees how far the surface is along its normal n, at a signed distance e. The motion t of its
// neighbourhood is that for which n·t = e holds best there,
//   (Σ w n nᵀ + ε I) t = Σ w e n
// with sums over the neighbourhood, made by smoothing over the mesh. From round to round neighbourhoods are smaller, as in non-rigid
// registration with decreasing stiffness (B. Amberg, S. Romdhani, T. Vetter, "Optimal Step Nonrigid ICP Algorithms for Surface
// Registration", CVPR 2007). So what moves as a whole keeps its vertices, and what is blended between two frames moves with it. In the end
// vertices are drawn to the surface itself.
#include "bake/sequence/follow_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/shells.h"
#include "bake/truth/surface_error.h"
#include "core/parallel.h"
#include "core/surface_points.h"
#include "core/vertex_normals.h"

namespace cloudbake {

namespace {

constexpr int kSmoothings[] = {48, 32, 16, 6};  // of the sums, per round
constexpr float kStiffness = 0.2F;              // ε, as a share of the trace of Σ w n nᵀ
constexpr int kUnfoldings = 6;                  // most rounds
constexpr size_t kSamples = 2000;               // of the surface, to find what the mesh has lost
constexpr double kCrumb = 0.001;                // of the volume

Vec3 normalOf(const SurfaceMesh& mesh, const Triangle& t) {
  return cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]);
}

std::vector<Vec3> placesOf(const std::vector<SurfacePoint>& points, std::span<const Vec3> values) {
  std::vector<Vec3> places;
  for (const SurfacePoint& point : points) places.push_back(valueAt(point, values));
  return places;
}

// The triangles that face against the surface at the place nearest to their middle.
std::vector<size_t> foldedTriangles(const SurfaceMesh& mesh, const SurfaceMesh& surface, const NearestSurface& nearest) {
  std::vector<Vec3> middles;
  for (const auto& [a, b, c] : mesh.triangles) middles.push_back((mesh.positions[a] + mesh.positions[b] + mesh.positions[c]) / 3);
  const std::vector<SurfacePoint> beneath = nearest.nearestTo(middles);
  std::vector<size_t> folded;
  for (size_t i = 0; i < mesh.triangles.size(); ++i)
    if (!(dot(normalOf(mesh, mesh.triangles[i]), normalAt(beneath[i], surface.normals)) > 0)) folded.push_back(i);
  return folded;
}

double missedShare(const SurfaceMesh& surface, const SurfaceMesh& mesh) {
  const std::vector<SurfacePoint> samples = spreadOverSurface(surface, kSamples);
  const std::vector<Vec3> places = placesOf(samples, surface.positions);
  const std::vector<Vec3> found = placesOf(nearestSurface(mesh)->nearestTo(places), mesh.positions);
  const double most = kMissedFrom * boundingBox(surface).longestSide();
  size_t missed = 0;
  for (size_t i = 0; i < places.size(); ++i) missed += length(found[i] - places[i]) > most;
  return double(missed) / double(std::max<size_t>(1, places.size()));
}

}  // namespace

double rmsBetween(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double squares = 0;
  for (size_t v = 0; v < a.size(); ++v) squares += double(dot(a[v] - b[v], a[v] - b[v]));
  return std::sqrt(squares / double(std::max<size_t>(1, a.size())));
}

FollowingMesh::FollowingMesh(SurfaceMesh start) : mesh_(std::move(start)), first_(mesh_.positions.size() + 1) {
  forEachEdge(mesh_.positions.size(), mesh_.triangles, Degenerate::kLeftOut,
              [&](uint32_t low, std::span<EdgeSide> sides) { ++first_[low + 1], ++first_[sides.front().high + 1]; });
  for (size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
  neighbours_.resize(first_.back());
  std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
  forEachEdge(mesh_.positions.size(), mesh_.triangles, Degenerate::kLeftOut, [&](uint32_t low, std::span<EdgeSide> sides) {
    const uint32_t high = sides.front().high;
    neighbours_[next[low]++] = high, neighbours_[next[high]++] = low;
  });
  mesh_.normals = vertexNormals(mesh_.positions, mesh_.triangles);
}

void FollowingMesh::place(std::vector<Vec3> positions) {
  mesh_.positions = std::move(positions);
  mesh_.normals = vertexNormals(mesh_.positions, mesh_.triangles);
}

std::span<const uint32_t> FollowingMesh::neighboursOf(size_t v) const {
  return std::span(neighbours_).subspan(first_[v], first_[v + 1] - first_[v]);
}

// The mean of the neighbours' values, per vertex.
std::vector<Vec3> FollowingMesh::averaged(const std::vector<Vec3>& values) const {
  std::vector<Vec3> means(values.size());
  parallelBlocks(values.size(), 1000, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) {
      const std::span<const uint32_t> neighbours = neighboursOf(v);
      Vec3 sum;
      for (const uint32_t other : neighbours) sum += values[other];
      means[v] = neighbours.empty() ? values[v] : sum / float(neighbours.size());
    }
  });
  return means;
}

// Goes half of the way to the mean of the neighbours, so many times.
void FollowingMesh::smooth(std::vector<Sums>& values, int passes) const {
  std::vector<Sums> next(values.size());
  for (int i = 0; i < passes; ++i) {
    parallelBlocks(values.size(), 500, [&](size_t begin, size_t end) {
      for (size_t v = begin; v < end; ++v) {
        const std::span<const uint32_t> neighbours = neighboursOf(v);
        next[v] = values[v];
        if (neighbours.empty()) continue;
        Sums sum{};
        for (const uint32_t other : neighbours)
          for (size_t n = 0; n < sum.size(); ++n) sum[n] += values[other][n];
        for (size_t n = 0; n < sum.size(); ++n) next[v][n] = (values[v][n] + sum[n] / float(neighbours.size())) * 0.5F;
      }
    });
    std::swap(values, next);
  }
}

// How each vertex moves with its neighbourhood to these places of the surface.
std::vector<Vec3> FollowingMesh::motionTo(const std::vector<Vec3>& places, int smoothings) const {
  const size_t count = places.size();
  std::vector<Sums> sums(count);
  for (size_t v = 0; v < count; ++v) {
    const Vec3 n = mesh_.normals[v], right = n * dot(places[v] - mesh_.positions[v], n);
    sums[v] = {n.x * n.x, n.y * n.y, n.z * n.z, n.y * n.z, n.x * n.z, n.x * n.y, right.x, right.y, right.z};
  }
  smooth(sums, smoothings);
  std::vector<Vec3> motion(count);
  for (size_t v = 0; v < count; ++v) {
    const auto& [xx, yy, zz, yz, xz, xy, right_x, right_y, right_z] = sums[v];
    const float stiffness = kStiffness * (xx + yy + zz);
    const Vec3 o{yz, xz, xy}, d = Vec3{xx, yy, zz} + Vec3{stiffness, stiffness, stiffness}, right{right_x, right_y, right_z};
    // By Cramer's rule.
    const Vec3 first{d.y * d.z - o.x * o.x, o.x * o.y - o.z * d.z, o.z * o.x - d.y * o.y},
        second{first.y, d.x * d.z - o.y * o.y, o.z * o.y - d.x * o.x}, third{first.z, second.z, d.x * d.y - o.z * o.z};
    const float determinant = d.x * first.x + o.z * first.y + o.y * first.z;
    if (determinant > 0) motion[v] = Vec3{dot(first, right), dot(second, right), dot(third, right)} / determinant;
  }
  return motion;
}

// Moves vertices along the surface towards the mean of their neighbours.
void FollowingMesh::spread(float share) {
  const std::vector<Vec3> means = averaged(mesh_.positions);
  for (size_t v = 0; v < means.size(); ++v) {
    const Vec3 way = means[v] - mesh_.positions[v], n = mesh_.normals[v];
    mesh_.positions[v] += (way - n * dot(way, n)) * share;
  }
}

FollowFigures FollowingMesh::follow(const SurfaceMesh& surface) {
  const auto nearest = nearestSurface(surface);
  const auto renewNormals = [&] { mesh_.normals = vertexNormals(mesh_.positions, mesh_.triangles); };
  const auto nearestPlaces = [&] { return placesOf(nearest->nearestFacing(mesh_.positions, mesh_.normals), surface.positions); };
  const auto settle = [&] {
    const std::vector<Vec3> places = nearestPlaces();
    for (size_t v = 0; v < places.size(); ++v)
      mesh_.positions[v] += mesh_.normals[v] * dot(places[v] - mesh_.positions[v], mesh_.normals[v]);
    renewNormals();
  };
  const std::vector<Vec3> before = mesh_.positions;
  for (const int smoothings : kSmoothings) {
    const std::vector<Vec3> motion = motionTo(nearestPlaces(), smoothings);
    for (size_t v = 0; v < motion.size(); ++v) mesh_.positions[v] += motion[v];
    renewNormals();
  }
  // Vertices are spread the more, the farther the surface has moved, so that a cloud that rests is left alone.
  const double edge = meanEdgeLength(mesh_), moved = edge > 0 ? rmsBetween(before, mesh_.positions) / edge : 0;
  spread(float(std::min(0.2, moved * moved)));
  renewNormals();
  settle();
  settle();

  // A fold opens if its vertices are smoothed freely before they are drawn to the surface again.
  std::vector<size_t> folded = foldedTriangles(mesh_, surface, *nearest);
  for (int round = 0; round < kUnfoldings && !folded.empty(); ++round) {
    std::vector<bool> loose(mesh_.positions.size());
    for (const size_t triangle : folded)
      for (const uint32_t v : mesh_.triangles[triangle]) {
        loose[v] = true;
        for (const uint32_t other : neighboursOf(v)) loose[other] = true;
      }
    for (int i = 0; i < 4; ++i) {
      const std::vector<Vec3> means = averaged(mesh_.positions);
      for (size_t v = 0; v < means.size(); ++v)
        if (loose[v]) mesh_.positions[v] = means[v];
    }
    renewNormals();
    settle();
    folded = foldedTriangles(mesh_, surface, *nearest);
  }

  FollowFigures figures;
  const double volume = signedVolume(surface), area = surfaceArea(mesh_);
  figures.volume = signedVolume(mesh_) / volume;
  if (area > 0) {
    const double most = edge / 4;
    const float out = float(std::clamp((volume - signedVolume(mesh_)) / area, -most, most));
    for (size_t v = 0; v < mesh_.positions.size(); ++v) mesh_.positions[v] += mesh_.normals[v] * out;
    renewNormals();
  }
  const std::vector<Vec3> places = placesOf(nearest->nearestTo(mesh_.positions), surface.positions);
  const double size = boundingBox(surface).longestSide();
  figures.distance.rms = rmsBetween(places, mesh_.positions) / size;
  for (size_t v = 0; v < places.size(); ++v)
    figures.distance.largest = std::max(figures.distance.largest, double(length(places[v] - mesh_.positions[v])) / size);
  figures.folded = double(folded.size()) / double(std::max<size_t>(1, mesh_.triangles.size()));
  figures.missed = missedShare(surface, mesh_);
  return figures;
}

SurfaceMesh outerShells(const SurfaceMesh& surface) {
  const SurfaceMesh welded = weldedByPosition(surface);
  const std::vector<Shell> shells = shellsOf(welded);
  double volume = 0;
  for (const Shell& shell : shells) volume += std::max(0.0, shell.volume);
  SurfaceMesh outer;
  constexpr uint32_t kNone = 0xFFFFFFFF;
  std::vector<uint32_t> places(welded.positions.size(), kNone);
  for (const Shell& shell : shells) {
    if (!(shell.volume > kCrumb * volume)) continue;
    for (const uint32_t triangle : shell.triangles) {
      Triangle t = welded.triangles[triangle];
      if (!hasDistinctCorners(t)) continue;
      for (uint32_t& v : t) {
        if (places[v] == kNone) {
          places[v] = uint32_t(outer.positions.size());
          outer.positions.push_back(welded.positions[v]);
        }
        v = places[v];
      }
      outer.triangles.push_back(t);
    }
  }
  outer.normals = vertexNormals(outer.positions, outer.triangles);
  return outer;
}

SurfaceTopology topologyOf(const SurfaceMesh& outer) {
  size_t edges = 0;
  forEachEdge(outer.positions.size(), outer.triangles, Degenerate::kLeftOut, [&](uint32_t, std::span<EdgeSide>) { ++edges; });
  SurfaceTopology topology;
  topology.shells = int(shellsOf(outer).size());
  // V − E + F = 2 (shells − handles)
  const auto euler = ptrdiff_t(outer.positions.size()) - ptrdiff_t(edges) + ptrdiff_t(outer.triangles.size());
  topology.handles = int(topology.shells - euler / 2);
  return topology;
}

}  // namespace cloudbake
