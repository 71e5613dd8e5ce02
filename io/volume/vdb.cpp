// Missing distances are computed from every voxel near the surface to the polygons of the surface (openvdb::tools::volumeToMesh,
// meshToVolume) and get the sign of the voxel in the file. So no flood from outside decides what is inside, and cavities are kept.
//
// The band of a level set that was clipped is not closed: active voxels end where the clip went through. Its surface is the one that
// volumeToMesh finds, which looks at every change of sign beside an active voxel, and it is closed by the changes of sign between inactive
// voxels and tiles, beside which volumeToMesh makes no polygon. io/volume/vdb_signs.h finds all of them. They are active in a copy of the
// grid that holds the voxels near them only.
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

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

#include "core/error.h"
#include "core/level_set_type.h"
#include "io/file/write_file.h"
#include "io/volume/vdb_file.h"
#include "io/volume/vdb_signs.h"

namespace cloudbake {

namespace {

namespace vdb = openvdb;

constexpr float kBand = kBandHalfWidth_voxels;
constexpr float kRoundOff = 0.01F;  // more than the rounding of half floats
constexpr float kKept = 0.25F;      // a distance of the file that the polygons agree with to so many voxels is more exact than theirs
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

void checkPlace(const IndexBox& box, const Refusal& refuse) {
  for (size_t a = 0; a < 3; ++a) {
    const auto low = double(box.low[a]), high = double(box.high[a]);
    if (high - low + 1 > kLargestIndex)
      refuse(fmt::format("is {:.0f} voxels long, more than the limit of {:.0f}: resample it with larger voxels", high - low + 1,
                         kLargestIndex));
    if (std::fmax(-low, high) > kLongestIndex) refuse("lies too far from its origin: move it there");
  }
}

struct Limits {
  uint64_t memory = 0;
  const Refusal& refuse;
  void requireBlocks(double blocks) const {
    requireMemory({fmt::format("grid '{}' with {:.0f} blocks of 8×8×8 voxels", refuse.grid, blocks), blocks * kBytesPerLeaf,
                   "resample it with larger voxels"},
                  memory, refuse.file);
  }
};

// Converts active tiles to voxels, except those deep inside or outside a level set, where there is no surface. Returns the box of what is
// active or inside a level set.
IndexBox checkSizeAndVoxelize(vdb::FloatGrid& grid, bool is_fog, double voxel_size, const Limits& limits) {
  vdb::FloatTree& tree = grid.tree();
  if (!is_fog) {
    auto tile = tree.beginValueOn();
    tile.setMaxDepth(vdb::FloatTree::ValueOnIter::LEAF_DEPTH - 1);
    for (; tile; ++tile)
      if (std::fabs(*tile) >= kBand * voxel_size) tile.setActiveState(false);
  }
  IndexBox box = activeBox(grid);
  if (!is_fog && grid.background() > 0) box.add(insideBox(grid, {}));
  if (box.isEmpty()) limits.refuse("is empty: export the volume again");
  checkPlace(box, limits.refuse);
  limits.requireBlocks(tree.leafCount() +
                       double(tree.activeTileCount() > 0 ? tree.activeVoxelCount() / vdb::FloatTree::LeafNodeType::SIZE : 0));
  tree.voxelizeActiveTiles();
  return box;
}

// The whole blocks from index 0 to the middle of a box.
vdb::Coord blocksToMiddle(const IndexBox& box) {
  constexpr int kBlock = vdb::FloatTree::LeafNodeType::DIM;
  vdb::Coord shift;
  for (int a = 0; a < 3; ++a)
    shift[a] = kBlock * int(std::round(0.5 * (double(box.low[size_t(a)]) + double(box.high[size_t(a)])) / kBlock));
  return shift;
}

void moveOrigin(GridFrame& frame, const vdb::Coord& shift) {
  for (int a = 0; a < 3; ++a) frame.origin[size_t(a)] += frame.voxel_size * shift[a];
}

// The leaves with active voxels, moved by whole leaves so that the middle of the shape is near index 0.
vdb::FloatGrid::Ptr centered(const vdb::FloatGrid& grid, GridFrame& frame) {
  using Leaf = vdb::FloatTree::LeafNodeType;
  const vdb::Coord shift = blocksToMiddle(activeBox(grid));
  moveOrigin(frame, shift);
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

struct SignedValue {
  float value;
  bool is_known;
};
SignedValue withSign(float distance, bool is_inside) { return {std::copysign(distance, is_inside ? -1.0F : 1.0F), false}; }

// Distances to the surface of `grid` at `iso`. `signedValue` gets a voxel and its distance and returns its value, and whether that is
// known from the file: such voxels are active.
template <class SignedValue>
vdb::FloatGrid::Ptr withDistances(const vdb::FloatGrid& grid, double iso, const SignedValue& signedValue) {
  std::vector<vdb::Vec3s> points;
  std::vector<vdb::Vec4I> quads;
  vdb::tools::volumeToMesh(grid, points, quads, iso);
  if (quads.empty()) return nullptr;
  const vdb::tools::QuadAndTriangleDataAdapter<vdb::Vec3s, vdb::Vec4I> mesh(points, quads);
  const auto transform = vdb::math::Transform::createLinearTransform(1.0);
  auto distances = vdb::tools::meshToVolume<vdb::FloatGrid>(mesh, *transform, kBand, kBand, vdb::tools::UNSIGNED_DISTANCE_FIELD);
  forEachVoxel(*distances, [&](const auto& value) {
    const auto [result, is_known] = signedValue(value.getCoord(), *value);
    if (is_known) value.setValueOn(true);
    value.setValue(result);
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

// --- bands that are not closed ---

struct FileVolume {
  const vdb::FloatGrid& grid;
  InsideRule inside;
  double voxel_size = 1;
  IndexBox box;

  // The value as in a level set, in voxels: below 0 inside, whatever is lost by rounding. A fog volume's has no unit.
  float phi(float value) const {
    constexpr double kFarthest = 1e6, kLeast = std::numeric_limits<float>::min();
    const double exact = std::clamp(inside.is_fog ? inside.iso - value : value / voxel_size, -kFarthest, kFarthest);
    return float(inside(value) ? std::fmin(exact, -kLeast) : exact);
  }
};

// The voxels near the surface, moved by `shift`. Active are those with a neighbour of opposite sign.
vdb::FloatGrid::Ptr nearSurface(const FileVolume& volume, const vdb::Coord& shift, const Limits& limits) {
  const vdb::MaskTree::Ptr mask = surfaceMask(volume.grid, volume.inside);
  limits.requireBlocks(double(volume.grid.tree().leafCount()) + double(mask->leafCount()));
  auto result = vdb::FloatGrid::create(kBand);
  const auto file = volume.grid.getConstAccessor();
  for (auto block = mask->cbeginLeaf(); block; ++block) {
    auto leaf = std::make_unique<vdb::FloatTree::LeafNodeType>(block->origin() - shift, kBand);
    for (vdb::Index n = 0; n < leaf->SIZE; ++n) {
      const float value = file.getValue(block->offsetToGlobalCoord(n));
      if (!std::isfinite(value)) refuseNonFinite(limits.refuse);
      leaf->setValueOnly(n, volume.phi(value));
      leaf->setActiveState(n, block->isValueOn(n));
    }
    result->tree().addLeaf(leaf.release());
  }
  return result;
}

// The surface is where the values of the file change sign, whether active or not. Keeps what the file knows of distances, except near the
// parts of the surface that the file has no distances to.
vdb::FloatGrid::Ptr closedWhereSignsChange(const FileVolume& volume, GridFrame& frame, const Limits& limits) {
  const vdb::Coord shift = blocksToMiddle(volume.box);
  moveOrigin(frame, shift);
  const auto file = volume.grid.getConstAccessor();
  const float background = volume.grid.background();
  const auto signedValue = [&](const vdb::Coord& ijk, float distance) -> SignedValue {
    float value = 0;
    const bool is_active = file.probeValue(ijk + shift, value);
    const bool is_distance = !volume.inside.is_fog && (is_active || std::fabs(std::fabs(value) - background) > kRoundOff * background);
    const float phi = volume.phi(value), magnitude = std::fabs(phi);
    if (is_distance && magnitude < kBand && std::fabs(magnitude - distance) < kKept) return {phi, true};
    return withSign(distance, volume.inside(value));
  };
  auto closed = withDistances(*nearSurface(volume, shift, limits), 0, signedValue);
  if (!closed) limits.refuse("has no surface: export it again");
  return closed;
}

// --- level sets and fog ---

vdb::FloatGrid::Ptr fromFog(const vdb::FloatGrid& file, std::optional<double>& iso, GridFrame& frame, const Limits& limits,
                            Warnings& warnings) {
  const Refusal& refuse = limits.refuse;
  GridFrame moved = frame;
  const vdb::FloatGrid::Ptr grid = centered(file, moved);
  const ValueRange range = activeRange(*grid, refuse);
  if (!std::isfinite(grid->background())) refuseNonFinite(refuse);
  forEachVoxel(*grid, [&](const auto& value) {
    if (!std::isfinite(*value)) refuseNonFinite(refuse);
  });
  if (!iso) {
    iso = kDefaultIsoShare * range.mean;
    warnings.add(WarningKind::kVolumeRebuilt, "fog volume '" + refuse.grid + "': the surface was placed at " +
                                                  fmt::format("{:.4g}, which is 5 % of the mean value: --iso sets it", *iso));
  }
  const InsideRule inside{true, *iso};
  if (!inside(file.background()) && isInactiveInside(file, inside)) {
    warnings.add(WarningKind::kVolumeRebuilt,
                 fmt::format("fog volume '{}' has inactive voxels above its surface's value: they were treated as inside", refuse.grid));
    const FileVolume volume{file, inside, frame.voxel_size, insideBox(file, inside)};
    checkPlace(volume.box, refuse);
    limits.requireBlocks(double(file.tree().leafCount()) + countSignChanges(file, inside).blocks);
    return closedWhereSignsChange(volume, frame, limits);
  }
  frame = moved;
  // Fog ends sharply where its active voxels end; beyond them is the background.
  const auto values = grid->getConstAccessor();
  auto level_set =
      withDistances(*grid, *iso, [&](const vdb::Coord& ijk, float distance) { return withSign(distance, values.getValue(ijk) > *iso); });
  if (!level_set)
    refuse(fmt::format("has no surface at {:.4g}, because its values are from {:.4g} to {:.4g}: choose another --iso", *iso, range.low,
                       range.high));
  return level_set;
}

// A level set whose band is closed: at every change of sign both voxels are active.
vdb::FloatGrid::Ptr fromClosedBand(vdb::FloatGrid::Ptr grid, double voxel_size, const Refusal& refuse, Warnings& warnings) {
  const bool narrow = isNarrow(*grid, voxel_size);
  grid = levelSetInVoxels(std::move(grid), voxel_size);
  if (!narrow) return grid;
  warnings.add(WarningKind::kVolumeRebuilt,
               "level set '" + refuse.grid + fmt::format("' has a band of under {:.0f} voxels per side: it was widened", kBand));
  const auto values = grid->getConstAccessor();
  auto widened = withDistances(*grid, 0, [&](const vdb::Coord& ijk, float distance) -> SignedValue {
    float value = 0;
    return values.probeValue(ijk, value) ? SignedValue{value, true} : withSign(distance, value < 0);
  });
  if (!widened) refuse("has no surface: export it again");
  return widened;
}

vdb::FloatGrid::Ptr fromLevelSet(const vdb::FloatGrid& file, const IndexBox& box, GridFrame& frame, const Limits& limits,
                                 Warnings& warnings) {
  const Refusal& refuse = limits.refuse;
  const ValueRange range = activeRange(file, refuse);
  if (!(file.background() > 0))
    refuse(fmt::format("has a background value of {:.4g}, but it must be above 0 (outside): export it again", file.background()));
  const FileVolume volume{file, {}, frame.voxel_size, box};
  const SignChanges changes = countSignChanges(file, volume.inside);
  if (changes.all() == 0)
    refuse(fmt::format("has no surface, because its values are from {:.4g} to {:.4g}: export it again", range.low, range.high));
  if (changes.all() == changes.both_active) {
    const vdb::FloatGrid::Ptr own = centered(file, frame);
    return fromClosedBand(own, frame.voxel_size, refuse, warnings);
  }
  limits.requireBlocks(double(file.tree().leafCount()) + changes.blocks);
  warnings.add(WarningKind::kVolumeRebuilt,
               fmt::format("level set '{}' has a band that is not closed, as where a volume was clipped: its surface was closed between "
                           "the {} pairs of neighbours of opposite sign that are not both active",
                           refuse.grid, changes.one_active + changes.none_active));
  return closedWhereSignsChange(volume, frame, limits);
}

// The place of (x, y, z) of a file with another axis up.
template <class T>
std::array<T, 3> turned(const std::array<T, 3>& p, UpAxis up) {
  std::array<T, 3> place;
  for (size_t row = 0; const auto& turn : turnOf(up)) place[row++] = T(turn[0]) * p[0] + T(turn[1]) * p[1] + T(turn[2]) * p[2];
  return place;
}

// Turns the lattice onto itself, so that no value changes.
vdb::FloatGrid::Ptr turned(const vdb::FloatGrid& grid, UpAxis up) {
  const auto at = [up](const vdb::Coord& ijk) {
    const auto [i, j, k] = turned(std::array{ijk.x(), ijk.y(), ijk.z()}, up);
    return vdb::Coord(i, j, k);
  };
  vdb::FloatGrid::Ptr result = grid.copyWithNewTree();
  vdb::FloatGrid::Accessor values = result->getAccessor();
  for (auto value = grid.cbeginValueAll(); value; ++value) {
    if (!value.isValueOn() && *value == grid.background()) continue;
    vdb::CoordBBox box;
    value.getBoundingBox(box);
    const vdb::Coord a = at(box.min()), b = at(box.max());
    if (value.isVoxelValue() && value.isValueOn())
      values.setValueOn(a, *value);
    else if (value.isVoxelValue())
      values.setValueOff(a, *value);
    else
      result->sparseFill(vdb::CoordBBox(vdb::Coord::minComponent(a, b), vdb::Coord::maxComponent(a, b)), *value, value.isValueOn());
  }
  return result;
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
  VdbVolume volume{{nullptr, frameOf(*grid, refuse)}, grid->getName(), settings.iso};
  GridFrame& frame = volume.level_set.frame;
  const Limits limits{settings.memory_limit, refuse};
  const IndexBox box = checkSizeAndVoxelize(*grid, is_fog, frame.voxel_size, limits);
  auto values = is_fog ? fromFog(*grid, volume.iso, frame, limits, warnings) : fromLevelSet(*grid, box, frame, limits, warnings);
  if (settings.up_axis != UpAxis::kY) {
    values = turned(*values, settings.up_axis);
    frame.origin = turned(frame.origin, settings.up_axis);
  }
  volume.level_set.grid = std::make_shared<LevelSetGrid>(LevelSetGrid{std::move(values)});
  return volume;
}

namespace {

// A VDB says how much memory its grid takes. It is that of a program of 64 bits on every system: 8 bytes for each child of a node, and for
// a leaf its values, its mask and 32 bytes (tools::memUsage in openvdb/tools/Count.h).
void putMemory(const vdb::FloatTree& tree, std::string& bytes) {
  constexpr std::string_view kBefore("file_mem_bytes\5\0\0\0int64\10\0\0\0", 14 + 4 + 5 + 4);
  const size_t found = bytes.find(kBefore);
  if (found == bytes.npos) return;
  constexpr uint64_t kTree = 1232 + 72;  // the tree and its root
  const auto of_node = [](uint64_t values) { return values * 8 + values / 4 + sizeof(vdb::Coord); };
  const std::vector<vdb::Index32> nodes = tree.nodeCount();
  const uint64_t memory = kTree + nodes[2] * of_node(1 << 15) + nodes[1] * of_node(1 << 12) + nodes[0] * uint64_t(512 * 4 + 512 / 8 + 32);
  std::memcpy(bytes.data() + found + kBefore.size(), &memory, sizeof memory);
}

}  // namespace

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
  if (sizeof(void*) != 8) putMemory(grid->tree(), bytes);
  bytes.replace(kUuidAt, 36, 36, '0');
  const std::string hash = hashBytes(bytes);
  const std::string uuid =
      hash.substr(0, 8) + "-" + hash.substr(8, 4) + "-" + hash.substr(12, 4) + "-" + hash.substr(16, 4) + "-" + hash.substr(20);
  return bytes.replace(kUuidAt, uuid.size(), uuid);
}

}  // namespace cloudbake
