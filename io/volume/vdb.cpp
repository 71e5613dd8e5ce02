// Missing distances are computed from every voxel near the surface to the polygons of the surface (openvdb::tools::volumeToMesh,
// meshToVolume) and get the sign of the voxel in the file. So no flood from outside decides what is inside, and cavities are kept.
//
// The default iso value: OpenVDB's own fog volumes (tools::sdfToFogVolume) are 0 outside and grow to 1 at three voxels below the surface. A
// surface at δ/3, found by linear interpolation along an axis between a clamped 0 and a value inside, is off the true surface by
// (1 − δ) − (1 − δ²)/2 + δ ln δ − δ² voxels on average, which vanishes at δ = 0.18. 5 % of the mean is δ = 0.15, which is within 0.05
// voxels. The default is relative because the densities of a simulation have no unit.
#include "io/volume/vdb.h"

#include <fmt/format.h>

#include <openvdb/io/Stream.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <cmath>
#include <sstream>

#include "core/error.h"
#include "core/level_set_type.h"
#include "io/file/write_file.h"
#include "io/volume/vdb_file.h"

namespace cloudbake {

namespace {

namespace vdb = openvdb;

constexpr float kBand = kBandHalfWidth_voxels;
constexpr float kRoundOff = 0.01F;  // more than the rounding of half floats
constexpr double kDefaultIsoShare = 0.05;
constexpr double kLargestIndex = 8000;     // the same as for every other level set
constexpr double kBytesPerLeaf = 16384;    // its values here and in a dense field, masks, the distance builder's index, its surface
constexpr double kLongestIndex = 1 << 30;  // far below the limit of openvdb::Coord

// Throws errors that name the grid.
struct Refusal {
  std::string file, grid;
  [[noreturn]] void operator()(const std::string& what) const { throw InputError(file, "grid '" + grid + "' " + what); }
};

// --- the lattice ---

// The rows of the matrix are the steps along i, j, k.
GridFrame frameOf(const vdb::FloatGrid& grid, const Refusal& refuse) {
  constexpr double kTolerance = 1e-5;
  const char* cure = ": resample it to cubic voxels along the axes (Houdini: VDB Resample)";
  if (!grid.transform().isLinear()) refuse(std::string("lies in a frustum") + cure);
  vdb::Mat4d m;
  try {
    m = grid.transform().baseMap()->getAffineMap()->getMat4();
  } catch (const vdb::ArithmeticError&) {  // the determinant is below 3e-15
    refuse("has a transform that is singular, or voxels too small for OpenVDB: export it again, scaled up");
  }
  double length[3], off_axis = 0, skew = 0;
  for (int r = 0; r < 3; ++r) {
    length[r] = vdb::Vec3d(m(r, 0), m(r, 1), m(r, 2)).length();
    if (!(length[r] > 0) || !std::isfinite(length[r]) || !std::isfinite(m(3, r)))
      refuse("has a transform that is singular: export it again");
    for (int c = 0; c < 3; ++c)
      if (c != r) {
        off_axis = std::fmax(off_axis, std::fabs(m(r, c)) / length[r]);
        skew = std::fmax(skew, std::fabs(m(r, 0) * m(c, 0) + m(r, 1) * m(c, 1) + m(r, 2) * m(c, 2)) / (length[r] * length[r]));
      }
  }
  const double size = length[0];
  if (off_axis > kTolerance) refuse(std::string(skew > kTolerance ? "is sheared" : "is rotated or mirrored") + cure);
  if (m(0, 0) < 0 || m(1, 1) < 0 || m(2, 2) < 0) refuse(std::string("is mirrored") + cure);
  if (std::fabs(length[1] / size - 1) > kTolerance || std::fabs(length[2] / size - 1) > kTolerance)
    refuse(fmt::format("has voxels of {:.6g} × {:.6g} × {:.6g}", size, length[1], length[2]) + cure);
  return {{m(3, 0), m(3, 1), m(3, 2)}, size};
}

// Converts active tiles to voxels, except those deep inside or outside a level set, where there is no surface.
void checkSizeAndVoxelize(vdb::FloatGrid& grid, bool is_fog, double voxel_size, const VdbSettings& settings, const Refusal& refuse) {
  vdb::FloatTree& tree = grid.tree();
  if (!is_fog) {
    auto tile = tree.beginValueOn();
    tile.setMaxDepth(vdb::FloatTree::ValueOnIter::LEAF_DEPTH - 1);
    for (; tile; ++tile)
      if (std::fabs(*tile) >= kBand * voxel_size) tile.setActiveState(false);
  }
  vdb::CoordBBox box;
  if (!tree.evalActiveVoxelBoundingBox(box)) refuse("is empty: export the volume again");
  const double leaves =
      tree.leafCount() + double(tree.activeTileCount() > 0 ? tree.activeVoxelCount() / vdb::FloatTree::LeafNodeType::SIZE : 0);
  for (int a = 0; a < 3; ++a) {
    const double low = box.min()[a], high = box.max()[a];
    if (high - low + 1 > kLargestIndex)
      refuse(fmt::format("is {:.0f} voxels long, more than the limit of {:.0f}: resample it with larger voxels", high - low + 1,
                         kLargestIndex));
    if (std::fmax(-low, high) > kLongestIndex) refuse("lies too far from its origin: move it there");
  }
  requireMemory({fmt::format("grid '{}' with {:.0f} blocks of 8×8×8 voxels", refuse.grid, leaves), leaves * kBytesPerLeaf,
                 "resample it with larger voxels"},
                settings.memory_limit, refuse.file);
  tree.voxelizeActiveTiles();
}

// The leaves with active voxels, moved by whole leaves so that the middle of the shape is near index 0.
vdb::FloatGrid::Ptr centered(const vdb::FloatGrid& grid, GridFrame& frame) {
  using Leaf = vdb::FloatTree::LeafNodeType;
  const vdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  vdb::Coord shift;
  for (int a = 0; a < 3; ++a) {
    const double middle = 0.5 * (double(box.min()[a]) + double(box.max()[a]));
    shift[a] = int(Leaf::DIM) * int(std::round(middle / Leaf::DIM));
    frame.origin[size_t(a)] += frame.voxel_size * shift[a];
  }
  auto moved = vdb::FloatGrid::create(grid.background());
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    if (leaf->isEmpty()) continue;
    auto copy = std::make_unique<Leaf>(*leaf);
    copy->setOrigin(leaf->origin() - shift);
    moved->tree().addLeaf(copy.release());
  }
  return moved;
}

// --- the values ---

// Visits every voxel of every leaf. After `centered` there are no others except the background.
template <class Body>
void forEachVoxel(vdb::FloatGrid& grid, const Body& body) {
  for (auto leaf = grid.tree().beginLeaf(); leaf; ++leaf)
    for (auto value = leaf->beginValueAll(); value; ++value) body(value);
}
template <class Body>
void forEachVoxel(const vdb::FloatGrid& grid, const Body& body) {
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf)
    for (auto value = leaf->cbeginValueAll(); value; ++value) body(value);
}

vdb::FloatGrid::Ptr filled(vdb::FloatGrid::Ptr grid) {
  vdb::tools::signedFloodFillWithValues(grid->tree(), kBand, -kBand);
  grid->tree().root().setBackground(kBand, false);
  grid->setGridClass(vdb::GRID_LEVEL_SET);
  return grid;
}

// Converts world units to voxels and clamps at the band.
vdb::FloatGrid::Ptr levelSetInVoxels(vdb::FloatGrid::Ptr grid, double voxel_size) {
  forEachVoxel(*grid, [voxel_size](const auto& value) {
    const auto phi = float(*value / voxel_size);
    const bool in_band = value.isValueOn() && std::fabs(phi) < kBand;
    value.setValue(in_band ? phi : std::copysign(kBand, phi));
    value.setValueOn(in_band);
  });
  return filled(std::move(grid));
}

// Whether a voxel outside the file's band lies within the band needed here.
bool isNarrow(const vdb::FloatGrid& grid, double voxel_size) {
  const double least = (1 - kRoundOff) * kBand * voxel_size;
  bool is_narrow = grid.background() < least;
  forEachVoxel(grid, [&](const auto& value) { is_narrow = is_narrow || (!value.isValueOn() && std::fabs(*value) < least); });
  return is_narrow;
}

// Distances to the surface at `iso`. Active voxels of `keep` are already known and kept.
template <class IsInside>
vdb::FloatGrid::Ptr withDistances(const vdb::FloatGrid& grid, double iso, const vdb::FloatGrid* keep, const IsInside& is_inside) {
  std::vector<vdb::Vec3s> points;
  std::vector<vdb::Vec4I> quads;
  vdb::tools::volumeToMesh(grid, points, quads, iso);
  if (quads.empty()) return nullptr;
  const vdb::tools::QuadAndTriangleDataAdapter<vdb::Vec3s, vdb::Vec4I> mesh(points, quads);
  const auto transform = vdb::math::Transform::createLinearTransform(1.0);
  auto distances = vdb::tools::meshToVolume<vdb::FloatGrid>(mesh, *transform, kBand, kBand, vdb::tools::UNSIGNED_DISTANCE_FIELD);
  const auto file = grid.getConstAccessor();
  forEachVoxel(*distances, [&](const auto& value) {
    const vdb::Coord ijk = value.getCoord();
    const bool known = keep && keep->tree().isValueOn(ijk);
    if (known) value.setValueOn(true);
    value.setValue(known ? file.getValue(ijk) : std::copysign(*value, is_inside(file.getValue(ijk)) ? -1.0F : 1.0F));
  });
  return filled(distances);
}

[[noreturn]] void refuseNonFinite(const Refusal& refuse) { refuse("has values that are not finite: repair the volume"); }

struct ValueRange {
  double low = INFINITY, high = -INFINITY, mean = 0;
};
ValueRange activeRange(const vdb::FloatGrid& grid, const Refusal& refuse) {
  ValueRange range;
  uint64_t count = 0;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf)
    for (auto value = leaf->cbeginValueOn(); value; ++value, ++count) {
      if (!std::isfinite(*value)) refuseNonFinite(refuse);
      range.low = std::fmin(range.low, *value);
      range.high = std::fmax(range.high, *value);
      range.mean += *value;
    }
  range.mean /= double(std::max<uint64_t>(count, 1));
  return range;
}

vdb::FloatGrid::Ptr fromFog(const vdb::FloatGrid& grid, std::optional<double> iso, const Refusal& refuse, Warnings& warnings) {
  const ValueRange range = activeRange(grid, refuse);
  if (!std::isfinite(grid.background())) refuseNonFinite(refuse);
  forEachVoxel(grid, [&](const auto& value) {
    if (!std::isfinite(*value)) refuseNonFinite(refuse);
  });
  if (!iso) {
    iso = kDefaultIsoShare * range.mean;
    warnings.add(WarningKind::kVolumeRebuilt, "fog volume '" + refuse.grid + "': the surface was placed at " +
                                                  fmt::format("{:.4g}, which is 5 % of the mean value: --iso sets it", *iso));
  }
  // Fog ends sharply where its active voxels end; beyond them is the background.
  auto level_set = withDistances(grid, *iso, nullptr, [iso](float value) { return value > *iso; });
  if (!level_set)
    refuse(fmt::format("has no surface at {:.4g}, because its values are from {:.4g} to {:.4g}: choose another --iso", *iso, range.low,
                       range.high));
  return level_set;
}

vdb::FloatGrid::Ptr fromLevelSet(vdb::FloatGrid::Ptr grid, double voxel_size, const Refusal& refuse, Warnings& warnings) {
  const ValueRange range = activeRange(*grid, refuse);
  if (!(grid->background() > 0))
    refuse(fmt::format("has a background value of {:.4g}, but it must be above 0 (outside): export it again", grid->background()));
  if (!(range.low < 0 && range.high > 0))
    refuse(fmt::format("has no surface, because its values are from {:.4g} to {:.4g}: export it again", range.low, range.high));
  const bool narrow = isNarrow(*grid, voxel_size);
  grid = levelSetInVoxels(std::move(grid), voxel_size);
  if (!narrow) return grid;
  warnings.add(WarningKind::kVolumeRebuilt,
               "level set '" + refuse.grid + fmt::format("' has a band of under {:.0f} voxels per side: it was widened", kBand));
  auto widened = withDistances(*grid, 0, grid.get(), [](float value) { return value < 0; });
  if (!widened) refuse("has no surface: export it again");
  return widened;
}

}  // namespace

VdbVolume decodeVdb(const std::filesystem::path& file, std::string bytes, const VdbSettings& settings, Warnings& warnings) {
  const vdb::FloatGrid::Ptr grid = readScalarGrid(file, std::move(bytes), settings.grid, settings.memory_limit, warnings);
  const Refusal refuse{file.string(), grid->getName()};
  const vdb::GridClass kind = grid->getGridClass();
  const bool is_fog = kind == vdb::GRID_FOG_VOLUME;
  if (!is_fog && kind != vdb::GRID_LEVEL_SET)
    refuse("is of class '" + vdb::GridBase::gridClassToString(kind) +
           "': set its class to level set or fog volume (Houdini: VDB, or Primitive Properties)");
  if (!is_fog && settings.iso) throw UsageError("--iso is for fog volumes: grid '" + grid->getName() + "' is a level set");
  VdbVolume volume{{nullptr, frameOf(*grid, refuse)}, grid->getName(), is_fog};
  GridFrame& frame = volume.level_set.frame;
  checkSizeAndVoxelize(*grid, is_fog, frame.voxel_size, settings, refuse);
  const vdb::FloatGrid::Ptr own = centered(*grid, frame);
  auto values = is_fog ? fromFog(*own, settings.iso, refuse, warnings) : fromLevelSet(own, frame.voxel_size, refuse, warnings);
  volume.level_set.grid = std::make_shared<LevelSetGrid>(LevelSetGrid{std::move(values)});
  return volume;
}

std::string encodeVdb(const LevelSet& level_set) {
  initializeVdb();
  const GridFrame& frame = level_set.frame;
  const auto h = float(frame.voxel_size);
  auto grid = level_set.grid->vdb->deepCopy();
  for (auto value = grid->beginValueAll(); value; ++value) value.setValue(*value * h);
  grid->tree().root().setBackground(grid->background() * h, false);
  grid->setName("surface");
  grid->setGridClass(vdb::GRID_LEVEL_SET);
  grid->setCreator("cloudbake " CLOUDBAKE_VERSION);
  vdb::Mat4d matrix = vdb::Mat4d::identity();
  matrix.setToScale(vdb::Vec3d(frame.voxel_size));
  matrix.setTranslation(vdb::Vec3d(frame.origin[0], frame.origin[1], frame.origin[2]));
  try {
    grid->setTransform(vdb::math::Transform::createLinearTransform(matrix));
  } catch (const vdb::ArithmeticError&) {
    throw InputError("", fmt::format("voxels of {:.3g} are too small for a VDB: scale the cloud up", frame.voxel_size));
  }
  std::ostringstream out(std::ios::binary);
  vdb::io::Stream(out).write(vdb::GridCPtrVec{grid});

  // The header ends with a random UUID: 36 characters after the magic number, three versions and a flag. It is replaced by a hash of the
  // content, so that equal level sets give equal bytes.
  constexpr size_t kUuidAt = 8 + 3 * 4 + 1;
  std::string bytes = out.str();
  bytes.replace(kUuidAt, 36, 36, '0');
  const std::string hash = hashBytes(bytes);
  const std::string uuid =
      hash.substr(0, 8) + "-" + hash.substr(8, 4) + "-" + hash.substr(12, 4) + "-" + hash.substr(16, 4) + "-" + hash.substr(20);
  return bytes.replace(kUuidAt, uuid.size(), uuid);
}

}  // namespace cloudbake
