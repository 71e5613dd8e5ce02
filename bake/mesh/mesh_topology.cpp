// A closed oriented surface is one whose boundary is zero: there are as many directed edges a→b as b→a. Then, and only then, the winding
// number of a point is the same along every ray (the discrete form of Stokes' theorem).
#include "bake/mesh/mesh_topology.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/distinct_positions.h"
#include "core/parallel.h"
#include "core/vertex_normals.h"

namespace cloudbake {

namespace {

// (b−a)×(c−a) = 0 in doubles, which represent the differences of floats exactly and their products nearly exactly.
bool isOnLine(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double ux = double(b.x) - a.x, uy = double(b.y) - a.y, uz = double(b.z) - a.z;
  const double vx = double(c.x) - a.x, vy = double(c.y) - a.y, vz = double(c.z) - a.z;
  return uy * vz == uz * vy && uz * vx == ux * vz && ux * vy == uy * vx;
}

// Counts duplicate triangles. They share all their sides, so they are counted only at the side of their two lowest corners. All `sides`
// have the same ends.
void findDuplicates(std::span<const EdgeSide> sides, std::span<const Triangle> triangles, Defect& duplicates) {
  if (sides.size() < 2) return;
  std::vector<std::pair<uint32_t, uint32_t>> opposite;  // corner, triangle
  for (const EdgeSide& side : sides) {
    const uint32_t corner = triangles[side.triangle][(side.corner + 2) % 3];
    if (corner > side.high) opposite.emplace_back(corner, side.triangle);
  }
  std::sort(opposite.begin(), opposite.end());
  for (size_t i = 1; i < opposite.size(); ++i)
    if (opposite[i].first == opposite[i - 1].first) duplicates.meet(opposite[i].second);
}

// The mesh over distinct positions, and the new index of each original vertex.
SurfaceMesh welded(const SurfaceMesh& mesh, std::vector<uint32_t>& remap) {
  DistinctPositions distinct(mesh.positions.size());
  remap.clear();
  for (const Vec3& p : mesh.positions) remap.push_back(distinct.add(p));
  SurfaceMesh result;
  result.positions = std::move(distinct.positions);
  for (const Triangle& t : mesh.triangles) result.triangles.push_back({remap[t[0]], remap[t[1]], remap[t[2]]});
  return result;
}

}  // namespace

SurfaceMesh weldedByPosition(const SurfaceMesh& mesh) {
  std::vector<uint32_t> remap;
  return welded(mesh, remap);
}

std::vector<Vec3> smoothNormals(const SurfaceMesh& mesh) {
  std::vector<uint32_t> remap;
  const SurfaceMesh one = welded(mesh, remap);
  const std::vector<Vec3> normals = vertexNormals(one.positions, one.triangles);
  std::vector<Vec3> result;
  for (const uint32_t v : remap) result.push_back(normals[v]);
  return result;
}

namespace {

// The sides of triangles in buckets of so many lower ends, each in the order of the triangles.
class SideBuckets {
 public:
  SideBuckets(size_t vertex_count, std::span<const Triangle> triangles, Degenerate degenerate)
      : vertex_count_(vertex_count), first_((vertex_count >> kBits) + 2, 0) {
    // A counting sort: every chunk of triangles counts its sides per bucket, and then knows where to put them.
    constexpr size_t kMostChunks = 64, kLeastTriangles = 1 << 14;
    const size_t chunks = std::clamp<size_t>(triangles.size() / kLeastTriangles, 1, kMostChunks), buckets = count();
    const auto visitChunk = [&](size_t chunk, const auto& visit) {
      const size_t end = (chunk + 1) * triangles.size() / chunks;
      for (size_t f = chunk * triangles.size() / chunks; f < end; ++f) {
        const Triangle& t = triangles[f];
        if (degenerate == Degenerate::kLeftOut && !hasDistinctCorners(t)) continue;
        for (uint16_t i = 0; i < 3; ++i) {
          const uint32_t a = t[i], b = t[i == 2 ? 0 : i + 1];
          if (a != b) visit(std::min(a, b), EdgeSide{std::max(a, b), uint32_t(f), i, int16_t(a < b ? 1 : -1)});
        }
      }
    };
    std::vector<uint32_t> places(chunks * buckets, 0);  // first numbers of sides
    parallelFor(chunks, [&](size_t chunk) {
      visitChunk(chunk, [&](uint32_t low, const EdgeSide&) { ++places[chunk * buckets + (low >> kBits)]; });
    });
    for (size_t bucket = 0; bucket < buckets; ++bucket) {
      first_[bucket + 1] = first_[bucket];
      for (size_t chunk = 0; chunk < chunks; ++chunk)
        first_[bucket + 1] += std::exchange(places[chunk * buckets + bucket], first_[bucket + 1]);
    }
    lows_.resize(first_[buckets]), sides_.resize(first_[buckets]);
    parallelFor(chunks, [&](size_t chunk) {
      visitChunk(chunk, [&](uint32_t low, const EdgeSide& side) {
        const uint32_t place = places[chunk * buckets + (low >> kBits)]++;
        lows_[place] = uint16_t(low & (kSize - 1)), sides_[place] = side;
      });
    });
  }

  size_t count() const { return (vertex_count_ >> kBits) + 1; }

  // Calls body for the edges of a bucket, in order of their ends.
  void visit(size_t bucket, const std::function<void(uint32_t, std::span<EdgeSide>)>& body) const {
    const uint32_t begin = first_[bucket], end = first_[bucket + 1];
    // The sum makes first[v + 1] the place of the first side of v; it moves on with every side that is placed, and ends as the place of the
    // first side of v + 1.
    std::vector<uint32_t> first(kSize + 2, 0);
    for (uint32_t i = begin; i < end; ++i) ++first[size_t(lows_[i]) + 2];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<EdgeSide> sides(end - begin);
    for (uint32_t i = begin; i < end; ++i) sides[first[size_t(lows_[i]) + 1]++] = sides_[i];
    for (uint32_t v = 0; v < std::min(kSize, vertex_count_ - (bucket << kBits)); ++v) {
      const auto last = sides.begin() + first[v + 1];
      std::sort(sides.begin() + first[v], last, [](const EdgeSide& a, const EdgeSide& b) {
        return std::tie(a.high, a.triangle, a.corner) < std::tie(b.high, b.triangle, b.corner);
      });
      for (auto from = sides.begin() + first[v], to = from; from != last; from = to) {
        to = std::find_if(from, last, [&](const EdgeSide& side) { return side.high != from->high; });
        body(uint32_t(bucket << kBits) + v, {&*from, size_t(to - from)});
      }
    }
  }

 private:
  static constexpr size_t kBits = 14, kSize = size_t(1) << kBits;
  size_t vertex_count_;
  std::vector<uint32_t> first_;  // per bucket
  std::vector<uint16_t> lows_;   // lower ends, from the first of the bucket
  std::vector<EdgeSide> sides_;
};

}  // namespace

void forEachEdge(size_t vertex_count, const std::vector<Triangle>& triangles, Degenerate degenerate,
                 const std::function<void(uint32_t, std::span<EdgeSide>)>& body) {
  const SideBuckets buckets(vertex_count, triangles, degenerate);
  for (size_t bucket = 0; bucket < buckets.count(); ++bucket) buckets.visit(bucket, body);
}

VertexTriangles trianglesAtVertices(size_t vertex_count, std::span<const Triangle> triangles) {
  // A counting sort as above.
  VertexTriangles result{std::vector<uint32_t>(vertex_count + 2, 0), std::vector<uint32_t>(3 * triangles.size())};
  for (const Triangle& t : triangles)
    for (const uint32_t v : t) ++result.first[v + 2];
  std::partial_sum(result.first.begin(), result.first.end(), result.first.begin());
  for (uint32_t f = 0; f < triangles.size(); ++f)
    for (const uint32_t v : triangles[f]) result.triangles[result.first[v + 1]++] = f;
  result.first.pop_back();
  return result;
}

namespace {

// The first vertex with the same position, for every vertex; empty if all positions differ. Threads share a hash table with linear probing,
// in which a slot never changes its position.
std::vector<uint32_t> firstAlike(std::span<const Vec3> positions) {
  constexpr size_t kGrain = 1 << 14, kAhead = 16;
  std::vector<std::atomic<uint32_t>> table(std::bit_ceil(2 * positions.size() + 16));  // numbers of vertices from 1 on; 0: free
  std::vector<uint32_t> slots(positions.size());
  const size_t mask = table.size() - 1;
  std::atomic<size_t> distinct = 0;
  parallelBlocks(positions.size(), kGrain, [&](size_t begin, size_t end) {
    std::array<size_t, kAhead> ahead;
    size_t added = 0;
    for (size_t v = begin; v < end; ++v) {
      if ((v - begin) % kAhead == 0)
        for (size_t i = 0; i < std::min(kAhead, end - v); ++i) {
          ahead[i] = hashOfPosition(positions[v + i]) & mask;
          __builtin_prefetch(&table[ahead[i]], 1);
        }
      size_t slot = ahead[(v - begin) % kAhead];
      for (;; slot = (slot + 1) & mask) {
        uint32_t known = 0;
        if (table[slot].compare_exchange_strong(known, uint32_t(v) + 1, std::memory_order_relaxed)) {
          ++added;
          break;
        }
        if (!(positions[known - 1] == positions[v])) continue;
        while (v + 1 < known && !table[slot].compare_exchange_weak(known, uint32_t(v) + 1, std::memory_order_relaxed)) {
        }
        break;
      }
      slots[v] = uint32_t(slot);
    }
    distinct.fetch_add(added, std::memory_order_relaxed);
  });
  if (distinct == positions.size()) return {};
  parallelBlocks(slots.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) slots[v] = table[slots[v]].load(std::memory_order_relaxed) - 1;
  });
  return slots;
}

void add(MeshDefects& sum, const MeshDefects& more) {
  sum.unmatched_edges += more.unmatched_edges;
  for (const auto kind : {&MeshDefects::open_edges, &MeshDefects::turned_edges, &MeshDefects::non_manifold_edges,
                          &MeshDefects::degenerate_triangles, &MeshDefects::duplicate_triangles, &MeshDefects::unreferenced_vertices})
    (sum.*kind).add(more.*kind);
}

// Adds what meet(i, defects) finds, in parallel.
template <class Meet>
void addDefects(size_t count, size_t grain, MeshDefects& defects, const Meet& meet) {
  std::mutex mutex;
  parallelBlocks(count, grain, [&](size_t begin, size_t end) {
    MeshDefects found;
    for (size_t i = begin; i < end; ++i) meet(i, found);
    const std::lock_guard lock(mutex);
    add(defects, found);
  });
}

}  // namespace

MeshDefects findDefects(const SurfaceMesh& mesh) {
  constexpr size_t kGrain = 1 << 14;
  MeshDefects defects;
  std::vector<std::atomic<uint8_t>> used(mesh.positions.size());
  parallelBlocks(mesh.triangles.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f)
      for (const uint32_t v : mesh.triangles[f]) used[v].store(1, std::memory_order_relaxed);
  });
  addDefects(used.size(), kGrain, defects, [&](size_t v, MeshDefects& found) {
    if (!used[v]) found.unreferenced_vertices.meet(uint32_t(v));
  });

  std::vector<Triangle> welded;
  if (const std::vector<uint32_t> first = firstAlike(mesh.positions); !first.empty()) {
    welded.resize(mesh.triangles.size());
    parallelBlocks(welded.size(), kGrain, [&](size_t begin, size_t end) {
      for (size_t f = begin; f < end; ++f)
        for (size_t i = 0; i < 3; ++i) welded[f][i] = first[mesh.triangles[f][i]];
    });
  }
  const std::vector<Triangle>& triangles = welded.empty() ? mesh.triangles : welded;
  addDefects(triangles.size(), kGrain, defects, [&](size_t f, MeshDefects& found) {
    const Triangle& t = triangles[f];
    if (!hasDistinctCorners(t) || isOnLine(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]))
      found.degenerate_triangles.meet(uint32_t(f));
  });
  const SideBuckets buckets(mesh.positions.size(), triangles, Degenerate::kLeftOut);
  addDefects(buckets.count(), 1, defects, [&](size_t bucket, MeshDefects& found) {
    buckets.visit(bucket, [&](uint32_t, std::span<EdgeSide> sides) {
      int balance = 0;
      uint32_t triangle = UINT32_MAX;
      for (const EdgeSide& side : sides) balance += side.sense, triangle = std::min(triangle, side.triangle);
      found.unmatched_edges += uint64_t(std::abs(balance));
      if (sides.size() == 1) found.open_edges.meet(triangle);
      if (sides.size() == 2 && balance != 0) found.turned_edges.meet(triangle);
      if (sides.size() > 2) found.non_manifold_edges.meet(triangle);
      findDuplicates(sides, triangles, found.duplicate_triangles);
    });
  });
  return defects;
}

void reportDefects(const MeshDefects& defects, const PlaceName& place, Warnings& warnings) {
  const auto tell = [&](WarningKind kind, const char* what, const Defect& defect, bool is_vertex = false) {
    if (defect.count > 0) warnings.add(kind, what + (", first at " + place(defect.first, is_vertex)), defect.count);
  };
  tell(WarningKind::kOpenEdges, "an edge is open: the mesh does not bound a volume", defects.open_edges);
  tell(WarningKind::kTurnedTriangles, "neighbouring triangles have opposite winding", defects.turned_edges);
  tell(WarningKind::kNonManifoldEdges, "an edge has more than two triangles", defects.non_manifold_edges);
  tell(WarningKind::kDegenerateTriangle, "a triangle has no area", defects.degenerate_triangles);
  tell(WarningKind::kDuplicateTriangle, "a triangle appears twice", defects.duplicate_triangles);
  tell(WarningKind::kUnreferencedVertex, "a vertex belongs to no triangle", defects.unreferenced_vertices, true);
}

double signedVolume(const SurfaceMesh& mesh) {
  const Vec3 c = boundingBox(mesh).center();
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    double p[3][3];
    for (int i = 0; i < 3; ++i) {
      const Vec3 q = mesh.positions[t[i]];
      p[i][0] = double(q.x) - c.x, p[i][1] = double(q.y) - c.y, p[i][2] = double(q.z) - c.z;
    }
    sum += p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) + p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
           p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
  }
  return sum / 6;
}

double surfaceArea(const SurfaceMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    const double ux = double(b.x) - a.x, uy = double(b.y) - a.y, uz = double(b.z) - a.z;
    const double vx = double(c.x) - a.x, vy = double(c.y) - a.y, vz = double(c.z) - a.z;
    const double nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    sum += 0.5 * std::sqrt(nx * nx + ny * ny + nz * nz);
  }
  return sum;
}

double meanEdgeLength(const SurfaceMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles)
    for (size_t i = 0; i < 3; ++i) sum += length(mesh.positions[t[i]] - mesh.positions[t[(i + 1) % 3]]);
  return sum / (3 * std::max<double>(1, double(mesh.triangles.size())));
}

Box boundingBox(const SurfaceMesh& mesh) {
  Box box;
  for (const Vec3& p : mesh.positions) box.add(p);
  return box;
}

}  // namespace cloudbake
