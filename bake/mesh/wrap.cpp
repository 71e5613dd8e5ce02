// Alpha wrapping: C. Portaneri, M. Rouxel-Labbé, M. Hemmer, D. Cohen-Steiner, P. Alliez, "Alpha Wrapping with an Offset",
// ACM TOG 41(4), 2022, as implemented in CGAL: balls of radius α carve a Delaunay tetrahedralisation from outside, and the part that they
// cannot reach is the solid. The surface lies `offset` outside the input.
#include "bake/mesh/repair.h"

#include "core/error.h"
#include "core/parallel.h"

#ifdef CLOUDBAKE_CGAL
#include <CGAL/alpha_wrap_3.h>

#include <algorithm>
#include <array>
#include <set>

#include "bake/mesh/cgal_mesh.h"
#include "bake/mesh/mesh_topology.h"
#endif

namespace cloudbake {

#ifdef CLOUDBAKE_CGAL

namespace {

constexpr double kOffsetOfAlpha = 1.0 / 30;  // CGAL's user manual: small compared with α, but large enough to bound the mesh's size
constexpr double kHollowVolumeRatio = 0.6, kHollowShells = 2;
constexpr double kAlphaOfHole = 0.6;  // × the hole's diagonal: a ball with a radius of a little more than half the diagonal does not pass

// CGAL's wrap searches the last corners of all triangles in a tree (compute_reference_point in its splitting_helper.h), by recursion as
// deep as the most triangles that share one: a fan of 30,000 overflows the stack. There the corners take turns to be the last, and
// triangles that are there twice are left out. `soup` is welded by position.
void spreadLastCorners(Soup& soup) {
  constexpr size_t kDeepest = 1000;
  std::vector<size_t> used(soup.points.size(), 0);
  for (const auto& face : soup.faces) ++used[face[2]];
  if (used.empty() || *std::max_element(used.begin(), used.end()) <= kDeepest) return;

  std::set<std::array<size_t, 3>> met;
  std::erase_if(soup.faces, [&](const std::vector<size_t>& face) {
    std::array<size_t, 3> corners{face[0], face[1], face[2]};
    std::sort(corners.begin(), corners.end());
    return !met.insert(corners).second;
  });
  std::fill(used.begin(), used.end(), 0);
  for (auto& face : soup.faces) {
    const auto last = std::min_element(face.begin(), face.end(), [&](size_t a, size_t b) { return used[a] < used[b]; });
    ++used[*last];
    std::rotate(face.begin(), last + 1, face.end());
  }
}

SurfaceMesh wrapOnce(const Soup& soup, double alpha) {
  CgalMesh wrapped;
  CGAL::alpha_wrap_3(soup.points, soup.faces, alpha / soup.size, alpha / soup.size * kOffsetOfAlpha, wrapped);
  return fromCgal(wrapped, soup);
}

}  // namespace

Wrap wrapClosed(const SurfaceMesh& mesh, double detail) {
  Soup soup = toSoup(weldedByPosition(mesh));
  spreadLastCorners(soup);
  if (soup.faces.empty() || !(soup.size > 0))
    throw InputError("", "no triangle has an area, so there is nothing to close: repair the mesh");
  const double finest = std::max(detail, kAlphaOfHole * widestHole(mesh)), area = surfaceArea(mesh);
  Wrap best;
  for (double alpha = boundingBox(mesh).diagonal() / 2; best.mesh.triangles.empty() || alpha >= finest; alpha /= 2) {
    throwIfLoopsStop();
    Wrap wrap{wrapOnce(soup, alpha), alpha, 0};
    wrap.volume = signedVolume(wrap.mesh);
    const double shell = 2 * alpha * kOffsetOfAlpha * area;
    if (!best.mesh.triangles.empty() && wrap.volume < kHollowVolumeRatio * best.volume && wrap.volume < kHollowShells * shell) break;
    best = std::move(wrap);
  }
  return best;
}

#else

Wrap wrapClosed(const SurfaceMesh&, double) {
  throw InputError("", "the mesh is open, but this binary was built without CGAL (-DCLOUDBAKE_CGAL=OFF): close the holes");
}

#endif

}  // namespace cloudbake
