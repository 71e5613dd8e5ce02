// The tree of the portable build against Embree, on a sculpt and on a grown cloud: what rays meet, and how long they are inside.
#ifndef CLOUDBAKE_PORTABLE
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "bake/lobe/directions.h"
#include "bake/truth/reference.h"
#include "core/ray_scene.h"
#include "core/triangle_tree.h"
#include "io/sculpt/read_mesh.h"
#include "tests/folders.h"
#include "tests/grown/grown_cloud.h"

namespace cloudbake {
namespace {

struct Agreement {
  size_t rays = 0, other_triangles = 0, other_chords = 0;
  double largest_difference = 0;
};

// The triangles that are met away from where the ray begins.
void addHit(const RayHit& hit, std::set<uint32_t>& met) {
  if (hit.t > 1e-5F) met.insert(hit.triangle);
}

double insideOf(std::vector<RayHit> hits) {
  std::sort(hits.begin(), hits.end(), [](const RayHit& a, const RayHit& b) { return a.t != b.t ? a.t < b.t : a.sign < b.sign; });
  double inside = 0;
  int winding = 0;
  for (size_t i = hits.size(); i-- > 0;) {
    winding += hits[i].sign;
    if (winding != 0) inside += hits[i].t - (i > 0 ? hits[i - 1].t : 0.0F);
  }
  return inside;
}

Agreement compare(SurfaceMesh mesh) {
  Box box;
  for (const Vec3& p : mesh.positions) box.add(p);
  for (Vec3& p : mesh.positions) p = (p - box.center()) / box.longestSide();
  const RayScene embree(mesh.positions, mesh.triangles);
  const TriangleTree tree(mesh.positions, mesh.triangles);
  const auto reference = meshReference(mesh);
  Agreement agreement;
  for (size_t v = 0; v < mesh.positions.size(); v += mesh.positions.size() / 60)
    for (const Vec3& direction : fibonacciDirections(500)) {
      const Ray ray{mesh.positions[v], direction};
      std::set<uint32_t> met, met_by_embree;
      std::vector<RayHit> hits;
      tree.forHits(ray, [&](const RayHit& hit) { addHit(hit, met), hits.push_back(hit); });
      embree.forHits(ray, [&](const RayHit& hit) { addHit(hit, met_by_embree); });
      const double difference = std::abs(insideOf(hits) - reference->insideLength(ray, INFINITY));
      ++agreement.rays;
      agreement.other_triangles += met != met_by_embree;
      agreement.other_chords += difference > 1e-5;
      agreement.largest_difference = std::max(agreement.largest_difference, difference);
    }
  std::printf("[figures] %zu triangles, %zu rays: other triangles %zu, other chords %zu, largest difference %.3g\n", mesh.triangles.size(),
              agreement.rays, agreement.other_triangles, agreement.other_chords, agreement.largest_difference);
  return agreement;
}

// The last bits of Embree's distances depend on the CPU, and by them a ray near an edge meets one of its triangles or the other.
void expectAgreement(const Agreement& agreement) {
  EXPECT_LE(agreement.other_triangles, agreement.rays / 10000);
  EXPECT_LE(agreement.other_chords, agreement.rays / 10000);
  EXPECT_LT(agreement.largest_difference, 1e-4);
}

TEST(TreeAgainstEmbree, OnASculpt) {
  Warnings warnings;
  const Sculpt sculpt = readMesh(sourceFolder() / "data/sculpts/wuson.obj", {}, warnings);
  ASSERT_EQ(sculpt.parts.size(), 1U);
  const Agreement agreement = compare({sculpt.parts[0].positions, {}, sculpt.parts[0].triangles});
  expectAgreement(agreement);
}

TEST(TreeAgainstEmbree, OnAGrownCloud) {
  const Agreement agreement = compare(grownCloud("humilis", {"vertices=10000"}).surface);
  expectAgreement(agreement);
}

}  // namespace
}  // namespace cloudbake
#endif
