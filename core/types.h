// Every struct that crosses a stage, on one page. World units, right-handed, +Y up, unless a name says otherwise.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

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

/// Where the cloud's bulk lies and how thick it is there: the four floats of a vertex.
struct Lobe {
  Vec3 direction;     ///< o, unit: the mean occlusion direction, into the bulk
  float density = 0;  ///< d, world units: cloud along o
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

/// A narrow-band signed distance copied out of its tree into bricks of 8³ cells. Bricks that the band does not meet share constant ones.
/// Lattice positions are index positions relative to `first`; every brick on the border is outside.
struct DenseField {
  static constexpr int kBrick = 8;
  static constexpr int kRow = 2 * (kBrick + 1), kPlane = kRow * kBrick, kBrickValues = kPlane * (kBrick + 1);
  GridFrame frame;
  std::array<int, 3> first{}, bricks{};  ///< index position of the lowest corner; bricks per axis
  float band = 0;                        ///< where |φ| is clipped, voxels
  std::vector<int32_t> offsets;          ///< per brick, x fastest: where in `values` it begins
  /// φ, voxels, rows in pairs so that the four corners of a cell's face follow each other: at k·kPlane + j·kRow + 2 i of a brick lie the
  /// corners (i, j, k) and (i, j + 1, k). |φ| > band in constant bricks; a march may take φ to keep its sign within 0.9 |φ| everywhere.
  std::vector<float> values;
  int block_bits = 0;  ///< blocks of 2^block_bits cells a side, a whole number of them in a brick
  /// Per octant of directions (bit a of its number: component a < 0) and block, x fastest, n: from anywhere in the block, φ keeps its sign
  /// on the way into that octant for n blocks' sides along the direction's largest component. Beyond the box all is outside.
  std::vector<uint8_t> clearances;
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

/// One drawn piece of a sculpt, in its own space: a glTF primitive under one node, or a mesh of another format.
struct SculptPart {
  std::string name;
  std::vector<Vec3> positions;      ///< #V
  std::vector<Vec3> normals;        ///< #V, or empty
  std::vector<Vec2> uvs;            ///< #V, or empty; glTF's convention (v grows downwards). Unused where the source is glTF
  std::vector<Triangle> triangles;  ///< #F
  Affine to_scene;                  ///< own space → scene space
  int object = 0;                   ///< parts of one object (a node of glTF, FBX, …) share a number
  bool repaired = false;            ///< triangles and normals are no longer the file's
};

/// The parsed glTF that a sculpt came from, kept whole for the output (io/gltf.cpp knows its inside).
struct GltfDocument;

/// A sculpt as read: parts that occlude each other, vertex order and count as in the file.
struct Sculpt {
  std::vector<SculptPart> parts;
  std::shared_ptr<const GltfDocument> gltf;  ///< set where the source is glTF
  std::string frame{};                       ///< unit and up axis, and who says so
};

/// How near a fitted lobe comes to exp(−σℓ), beside the mean lobe at the default k and b: rms of T over directions that the fit did not
/// see.
struct FitError {
  double extinction = 0, mean_rms = 0, fitted_rms = 0;
};

/// How near spherical harmonics come to exp(−σℓ), beside the lobe: rms of T over directions that the fit did not see.
struct HarmonicError {
  int order = 0;
  double lobe_rms = 0, rms = 0;
};

/// What was asked of a bake and what it was measured to keep, on some vertices against exact chords.
struct TargetReport {
  std::string quantity;  ///< "direction rms, degrees" or "transmittance rms"
  double target = 0, measured = 0;
  std::string truth;  ///< how it was found
  uint64_t vertices = 0;
  int voxels = 0;  ///< chosen, along the longest side
};

/// How far the points of a new surface lie from the sculpt that it replaces, as shares of the sculpt's longest side.
struct SurfaceError {
  double rms = 0, largest = 0;
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

/// What one run did, for people and for the JSON report.
struct BakeReport {
  std::string command, input, output;
  AssetInfo info;
  std::vector<FitError> fit;  ///< one per σ; empty without a fit
  std::optional<TargetReport> target;
  std::optional<SurfaceError> surface_error;  ///< where --vertices or --remesh gave a sculpt a new mesh
  std::optional<RepairSummary> repair;
  std::string volume;  ///< what bounds the volume of an open sculpt
  std::optional<GrowthSummary> growth;
  uint64_t vertices = 0, triangles = 0, undefined_directions = 0;
  std::vector<std::pair<std::string, double>> seconds;  ///< per stage, in order
  std::string frame;                                    ///< unit and up axis of a sculpt: found, given or assumed
  Warnings warnings;
  Warnings findings;  ///< of --inspect: nothing that spoils a bake
};

}  // namespace cloudbake
