// The structs that are passed between stages. World units, right-handed, +Y up, unless a name says otherwise.
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

/// Points to bake, in world units: #V positions and #V unit normals (or none).
struct BakePoints {
  std::span<const Vec3> positions;
  std::span<const Vec3> normals;
};

/// The four floats of a vertex: in which direction the bulk of the cloud lies and how thick the cloud is there.
struct Lobe {
  Vec3 direction;       ///< o, unit: the mean occlusion direction, into the bulk
  float thickness = 0;  ///< d, world units: length of cloud along o. The paper, reports and assets call it "density"
};

/// The constants of the lobe formula (core/lobe_lighting.h).
struct LobeShape {
  float exponent = 3;  ///< k
  float bias = 0;      ///< b, world units
};

/// Light that was scattered more than once, as octaves i = 0, 1, …: S(τ) = Σ bⁱ p(cⁱ g) exp(−aⁱ τ) / Σ bⁱ.
struct OctaveSettings {
  int count = 0;              ///< octaves beyond the first, 0 … kMostLightOctaves; 0 = single scattering
  float extinction = 0.5F;    ///< a, 0 … 1
  float contribution = 0.5F;  ///< b, 0 … 1
  float eccentricity = 0.5F;  ///< c, 0 … 1
};
inline constexpr int kMostLightOctaves = 15;

/// How a volume shows the light inside it.
struct VolumeLight {
  float view_extinction = 1;  ///< σ along the view, in units of the σ towards the light; > 0
  OctaveSettings octaves;
  float asymmetry = 0;  ///< g of the phase function of Henyey and Greenstein, −1 < g < 1; 0: the same in every direction
};

/// The lattice of an integration field: world = origin + voxel_size · index. The origin is the centre of the shape, so that
/// index coordinates are small and exact for any position and size of the shape.
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

/// The OpenVDB grid of a level set. Only code that looks inside needs its definition (core/level_set_type.h).
struct LevelSetGrid;

/// A narrow-band signed distance field, negative inside, in index space: voxel size 1, values in voxels, interior filled.
struct LevelSet {
  std::shared_ptr<LevelSetGrid> grid;
  GridFrame frame;
};

/// The fraction of every cell in a box of the lattice that is inside the shape. A sweep adds these up. Cell (i, j, k) is the cube of
/// side 1 around the index position first + (i, j, k). The outermost two cells on every side are empty.
struct CoverageField {
  GridFrame frame;
  std::array<int, 3> first{}, cells{};  ///< per axis
  std::vector<float> fractions;         ///< 0 … 1, x fastest: (k·cells[1] + j)·cells[0] + i
};

enum class Method { kRays, kSweep };
enum class Sampler { kStratified, kFibonacci, kUniform };
enum class Quadrature { kCrossing, kMidpoint, kEnd };

/// How the directions of a bake are chosen and integrated. A sweep chooses its own directions and integrates by slices: it uses only N and
/// L of these.
struct BakeSettings {
  Method method = Method::kSweep;
  Sampler sampler = Sampler::kStratified;
  Quadrature quadrature = Quadrature::kCrossing;
  int rays = 100;                   ///< N, directions per vertex
  int steps = 100;                  ///< S, samples per ray
  std::optional<float> ray_length;  ///< L, world units; unset = the diagonal of the bounding box
  uint64_t seed = 1;
  bool rotate_directions = true;  ///< fibonacci only: one random rotation per vertex, or one fixed set for all
};

/// The range of sun positions that a fit or a scene is made for. Azimuth turns about +y: 0 = +z, 90 = +x.
struct SunArc {
  float elevation_low_degrees = 0, elevation_high_degrees = 90, azimuth_low_degrees = 0, azimuth_high_degrees = 360;
};

/// Levels of detail of an asset.
inline constexpr size_t kMostLevels = 8;

/// Sums of a sketch (core/seal.h).
inline constexpr size_t kSketchSize = 16;

/// The record that a bake makes of its asset (core/seal.h).
struct AssetSeal {
  std::string mesh, constants;             ///< hashes, 16 hexadecimal digits
  float size = 0;                          ///< the square root of the surface's area in scene space: the unit of what follows
  std::array<float, 3> moments{};          ///< of the surface's covariance: trace, sum of the principal 2 × 2 minors, determinant
  std::array<float, kSketchSize> lobes{};  ///< a sketch of the stored vectors o·d
  std::optional<std::array<float, kSketchSize>> harmonics{};  ///< likewise of the coefficients, if there are any
};

struct Impostor;  // core/impostor.h

/// The layouts of assets (docs/asset_format.md). A reader that does not know one refuses it.
inline constexpr const char *kLayoutName = "lobe-uv", *kPackedLayoutName = "lobe-packed";

/// How far a packed asset may be from the one that it was made of (core/certificate.h).
struct PackingCertificate {
  float transmittance = 0;                        ///< the most that T changes at a vertex, under any light
  float extinction_low = 0, extinction_high = 0;  ///< for any σ in this range, per world unit
};

/// The contents of `asset.extras.cloudbake`: information for people and tools. Decoding the lobes does not need it.
struct AssetInfo {
  std::string layout = kLayoutName;               ///< name of the layout (docs/asset_format.md)
  int version = 1;                                ///< version of the layout
  int first_uv_set = 0;                           ///< n: the UV sets are n and n+1
  std::string lobe = "mean";                      ///< how the lobe was made: "mean" or "fit"
  LobeShape shape;                                ///< k, and b in world units
  float extinction = 0;                           ///< σ, per world unit; for a fit over a range, the range's geometric mean
  float extinction_low = 0, extinction_high = 0;  ///< the range of a fit; 0 = no fit
  std::optional<SunArc> sun_arc;                  ///< set if the fit is for a range of suns, not for the whole sphere
  std::optional<VolumeLight> volume;              ///< set if the fit is to the picture of this volume, not to the transmittance
  std::string method = "rays", field, sampler, quadrature;
  int rays = 0, steps = 0;
  int smooth = 0;          ///< passes of smoothing after the bake
  int harmonic_order = 0;  ///< order of the spherical harmonics stored with the lobes; 0 = there are none
  bool separate = false;   ///< every object was baked as if it were alone
  bool wrapped = false;    ///< a wrap around the mesh bounded the volume (--close wrap)
  float ray_length = 0;    ///< L, world units
  float voxel_size = 0;    ///< voxel size of the integration field, world units
  uint64_t seed = 0;
  int level = 0;                    ///< which level of detail it is, from 1; 0: the full asset
  int switch_pixels = 0;            ///< of a level: the most pixels that the longest side may cover where it is drawn; 0: none
  std::string input_hash;           ///< XXH3-128 of the input's bytes, hexadecimal
  std::optional<AssetSeal> seal{};  ///< of the asset; set by encodeGlb
  /// Of a packed asset: the largest d, in the space of its meshes (core/lobe_packing.h); 0: the four floats are stored as they are. Both
  /// are set by encodeGlb.
  float density_max = 0;
  std::optional<PackingCertificate> certificate{};
};

/// A mesh with its lobes in scene space. The previewer and the error figures work on it.
struct BakedMesh {
  SurfaceMesh surface;
  std::vector<Lobe> lobes;  ///< #V
  AssetInfo info;
  std::vector<float>
      harmonics;  ///< #V × (info.harmonic_order + 1)² coefficients of T at info.extinction (core/harmonics.h) in scene axes, or empty
  std::vector<Vec3> colors{};                  ///< #V base colours of the sculpt, linear, 0 … 1; empty: white, or not read
  std::shared_ptr<const Impostor> impostor{};  ///< is drawn in place of the triangles, which are then the cloud's box without lobes
};

/// The changes of --repair.
struct RepairSummary {
  uint64_t turned_triangles = 0, filled_holes = 0, added_triangles = 0;
};

/// The changes of --refine. The errors are the rms of T of blended lobes against lobes baked at the same points, the middles of the edges.
struct RefineSummary {
  uint64_t vertices_before = 0, vertices_after = 0;
  double blending_before = 0, blending_after = 0;
};

/// How a cloud grew: what the rules produced and what became of the turtle's points.
struct GrowthSummary {
  std::vector<std::map<char, uint64_t>> generations;        ///< number of each symbol in the string, per generation from the premise on
  std::string expansion;                                    ///< the final string, cut off after 4000 characters
  uint64_t points = 0, leaves = 0;                          ///< points and leaves of the turtle
  uint64_t without_radius = 0, hidden = 0, over_count = 0;  ///< spheres dropped: radius 0, inside another, beyond `count`
  int parts = 0;                                            ///< number of parts that the spheres form
  bool connected = false;                                   ///< whether parts were pulled together
  std::vector<float> radii;                                 ///< radii of the remaining spheres, world units
};

}  // namespace cloudbake
