// Moves a mesh along with a surface that changes from frame to frame, so that all frames have the same triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/figures.h"
#include "core/types.h"

namespace cloudbake {

/// How well a moved mesh shows a frame's surface.
struct FollowFigures {
  SurfaceError distance;  ///< of the mesh's vertices to the surface, as shares of the surface's longest side
  double missed = 0;      ///< the share of the surface's area that is farther than kMissedFrom from the mesh
  double folded = 0;      ///< the share of the mesh's triangles that face against the surface beneath them
  double volume = 1;      ///< of the mesh, as a share of the surface's

  /// Whether the mesh can no longer stand for the surface: parts were born, have died, joined or parted.
  bool isLost() const { return missed > 0.03 || folded > 0.03 || distance.rms > 0.006 || volume < 0.9 || volume > 1.1; }
};

/// A share of the surface's longest side.
inline constexpr double kMissedFrom = 0.02;

/// A closed mesh on its way through the frames.
class FollowingMesh {
 public:
  /// `start` is closed and has no repeated vertices. It lies on the first surface.
  explicit FollowingMesh(SurfaceMesh start);

  /// Moves the mesh to a closed surface that is near it, and spreads its vertices evenly. The volume is that of the surface, as far as
  /// moving vertices by a quarter of an edge allows. The same meshes give the same result for any number of threads.
  FollowFigures follow(const SurfaceMesh& surface);

  /// Puts the vertices elsewhere, #V.
  void place(std::vector<Vec3> positions);

  /// With smooth normals.
  const SurfaceMesh& mesh() const { return mesh_; }

 private:
  using Sums = std::array<float, 9>;  ///< xx yy zz yz xz xy of Σ n nᵀ, and Σ e n

  std::span<const uint32_t> neighboursOf(size_t v) const;
  std::vector<Vec3> averaged(const std::vector<Vec3>& values) const;
  void smooth(std::vector<Sums>& values, int passes) const;
  std::vector<Vec3> motionTo(const std::vector<Vec3>& places, int smoothings) const;
  void spread(float share);

  SurfaceMesh mesh_;
  std::vector<uint32_t> first_, neighbours_;  ///< of each vertex: neighbours_[first_[v]] … neighbours_[first_[v + 1] − 1]
};

/// The rms of the distances between points, in their unit; 0 for none.
double rmsBetween(const std::vector<Vec3>& a, const std::vector<Vec3>& b);

/// The outer shells of a closed surface: without cavities, which nobody sees from outside, and without crumbs, shells of less than a
/// thousandth of its volume. Vertices that are no longer used are left out.
SurfaceMesh outerShells(const SurfaceMesh& surface);

/// What of a closed surface can change from frame to frame.
struct SurfaceTopology {
  int shells = 0;   ///< of the outer side
  int handles = 0;  ///< holes through the cloud, of all shells together
  friend bool operator==(const SurfaceTopology&, const SurfaceTopology&) = default;
};
SurfaceTopology topologyOf(const SurfaceMesh& outer);

}  // namespace cloudbake
