// Every struct that crosses a stage, on one page. World units, right-handed, +Y up, unless a name says otherwise.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/affine.h"
#include "core/vec3.h"
#include "core/warnings.h"

namespace cloudbake {

/// One puff of a grown cloud.
struct Sphere {
  Vec3 center;
  float radius = 0;
};

using Triangle = std::array<uint32_t, 3>;

/// An indexed triangle mesh. Counter-clockwise triangles face outwards. May be open or non-manifold.
struct SurfaceMesh {
  std::vector<Vec3> positions;      ///< #V
  std::vector<Vec3> normals;        ///< #V unit vectors, or empty
  std::vector<Triangle> triangles;  ///< #F, indices into positions
};

/// A ray; `direction` is unit length, so t is a distance.
struct Ray {
  Vec3 origin, direction;
};

/// Points to bake, world units: #V positions and #V unit normals (or none).
struct BakePoints {
  std::span<const Vec3> positions;
  std::span<const Vec3> normals;
};

/// Where the cloud's bulk lies and how thick it is there: the four floats of a vertex.
struct Lobe {
  Vec3 direction;       ///< o, unit: the mean occlusion direction, into the bulk
  float thickness = 0;  ///< d, world units: cloud along o; the published "density", and so named in reports and assets
};

/// The constants of the lobe formula (core/lobe_lighting.h).
struct LobeShape {
  float exponent = 3;  ///< k
  float bias = 0;      ///< b, world units
};

/// The lattice of an integration field: world = origin + voxel_size · index. The origin is the centre of the shape, so that
/// index coordinates stay small and exact wherever the shape lies and whatever its size.
struct GridFrame {
  std::array<double, 3> origin{0, 0, 0};
  double voxel_size = 1;  ///< world units
  Vec3 toIndex(Vec3 p) const {
    return {float((p.x - origin[0]) / voxel_size), float((p.y - origin[1]) / voxel_size), float((p.z - origin[2]) / voxel_size)};
  }
  Vec3 toWorld(Vec3 index) const {
    return {float(origin[0] + voxel_size * index.x), float(origin[1] + voxel_size * index.y), float(origin[2] + voxel_size * index.z)};
  }
};

/// The OpenVDB grid of a level set (core/level_set_type.h), unseen by those who only hand it on.
struct LevelSetGrid;

/// A narrow-band signed distance, negative inside, in index space: voxel size 1, values in voxels, interior filled.
struct LevelSet {
  std::shared_ptr<LevelSetGrid> grid;
  GridFrame frame;
};

/// Inside fraction of every cell of a box of the lattice: what a sweep adds up. Cell (i, j, k) is the cube of side 1 around the
/// index position first + (i, j, k). The outermost two cells on every side of the shape are empty.
struct CoverageField {
  GridFrame frame;
  std::array<int, 3> first{}, cells{};  ///< per axis
  std::vector<float> fractions;         ///< 0 … 1, x fastest: (k·cells[1] + j)·cells[0] + i
};

enum class Method { kRays, kSweep };
enum class Sampler { kStratified, kFibonacci, kUniform };
enum class Quadrature { kCrossing, kMidpoint, kEnd };

/// How the directions of a bake are chosen and integrated. A sweep takes its own directions and integrates by slices: of these only N, L
/// count.
struct BakeSettings {
  Method method = Method::kSweep;
  Sampler sampler = Sampler::kStratified;
  Quadrature quadrature = Quadrature::kCrossing;
  int rays = 100;                   ///< N, directions per vertex
  int steps = 100;                  ///< S, samples per ray
  std::optional<float> ray_length;  ///< L, world units; unset: the diagonal of the bounding box
  uint64_t seed = 1;
  bool rotate_directions = true;  ///< fibonacci only: one random rotation per vertex, or one fixed set for all
};

/// Where the sun goes, for whom a fit or a scene is made. Azimuth about +y, 0 = +z, 90 = +x.
struct SunArc {
  float elevation_low_degrees = 0, elevation_high_degrees = 90, azimuth_low_degrees = 0, azimuth_high_degrees = 360;
};

/// What `asset.extras.cloudbake` records: a copy for people and tools, no part of the decoding.
struct AssetInfo {
  std::string layout = "lobe-uv";                 ///< name of the layout in docs/asset_format.md
  int version = 1;                                ///< of the layout
  int first_uv_set = 0;                           ///< n: the sets are n and n+1
  std::string lobe = "mean";                      ///< how the lobe was made: "mean" or "fit"
  LobeShape shape;                                ///< k, and b in world units
  float extinction = 0;                           ///< σ, per world unit; of a fit over a range: its geometric mean
  float extinction_low = 0, extinction_high = 0;  ///< the range of a fit; 0: no fit
  std::optional<SunArc> sun_arc;                  ///< of a fit for a sun, not for the whole sphere
  std::string method = "rays", field, sampler, quadrature;
  int rays = 0, steps = 0;
  int smooth = 0;          ///< passes of smoothing after the bake
  int harmonic_order = 0;  ///< of the spherical harmonics beside the lobes; 0: there are none
  bool separate = false;   ///< every object was baked as if alone
  float ray_length = 0;    ///< L, world units
  float voxel_size = 0;    ///< of the integration field, world units
  uint64_t seed = 0;
  std::string input_hash;  ///< XXH3-128 of the input's bytes, hexadecimal
};

/// A mesh with its lobes in scene space: what the previewer and the error figures work on.
struct BakedMesh {
  SurfaceMesh surface;
  std::vector<Lobe> lobes;  ///< #V
  AssetInfo info;
  std::vector<float> harmonics;  ///< #V × (info.harmonic_order + 1)² of T at info.extinction (core/harmonics.h), scene axes; or empty
};

/// What --repair changed.
struct RepairSummary {
  uint64_t turned_triangles = 0, filled_holes = 0, added_triangles = 0;
};

/// How a cloud grew: what the rules gave, and what became of the turtle's points.
struct GrowthSummary {
  std::vector<std::map<char, uint64_t>> generations;        ///< how often each symbol stands in the string, from the premise on
  std::string expansion;                                    ///< the last string, cut at 4000 characters
  uint64_t points = 0, leaves = 0;                          ///< of the turtle
  uint64_t without_radius = 0, hidden = 0, over_count = 0;  ///< spheres dropped: radius 0, inside another, beyond `count`
  int parts = 0;                                            ///< that the spheres form
  bool connected = false;                                   ///< parts were pulled together
  std::vector<float> radii;                                 ///< of the spheres that are left, world units
};

}  // namespace cloudbake
