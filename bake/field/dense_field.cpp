// Why a march may assume that φ keeps its sign within 0.9 |φ|: a distance changes by at most 1 per voxel, and its trilinear interpolation
// by hardly more (at most √3 along a diagonal, if every edge of a cell had slope 1). tests/bake/lobe/sphere_rays_test.cpp compares the
// march with one that reads every sample. A constant brick whose nearest band brick is n bricks away keeps its sign for (n − 1)·8 voxels. φ
// also keeps its sign in a cube of plain blocks, that is, blocks whose lattice values all have one sign: neighbouring blocks share lattice
// values, so their sign is the same. |φ| is small near a surface, on both sides of it and in all directions, but the cube is large for a
// ray that leads away from the surface. The bumps of bake/field/sphere_field are normalised by the slope at a point, so that φ may be up to
// half again too large beside their creases. This is rare, and no bake error caused by it was observed.
#include "bake/field/dense_field.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "core/error.h"
#include "core/level_set_type.h"
#include "core/parallel.h"

namespace cloudbake {

namespace {

constexpr int kBrick = DenseField::kBrick, kValues = DenseField::kBrickValues;
constexpr int kFarthest = 1 << 20;
constexpr float kSafeShare = 0.9F;
constexpr int kMostBlocks = 64;
constexpr size_t kClearanceBytes = 2 << 20;  // lower bound of the memory limit

using Brick = std::array<float, kValues>;

openvdb::Coord lowCorner(const DenseField& field, size_t brick) {
  const int x = int(brick % size_t(field.bricks[0])), y = int(brick / size_t(field.bricks[0]) % size_t(field.bricks[1])),
            z = int(brick / size_t(field.bricks[0]) / size_t(field.bricks[1]));
  return {field.first[0] + kBrick * x, field.first[1] + kBrick * y, field.first[2] + kBrick * z};
}

bool touchesBand(const openvdb::FloatGrid::ConstAccessor& accessor, const openvdb::Coord& low) {
  for (int n = 0; n < 8; ++n)
    if (accessor.probeConstLeaf(low.offsetBy(n & 1 ? kBrick : 0, n & 2 ? kBrick : 0, n & 4 ? kBrick : 0))) return true;
  return false;
}

// Reads a brick. Returns false if all its values are equal.
bool readBrick(const openvdb::FloatGrid::ConstAccessor& accessor, const openvdb::Coord& low, Brick& values) {
  bool same = true;
  const float first = accessor.getValue(low);
  for (int k = 0; k <= kBrick; ++k)
    for (int j = 0; j <= kBrick; ++j)
      for (int i = 0; i <= kBrick; ++i) {
        const float phi = accessor.getValue(low.offsetBy(i, j, k));
        same = same && phi == first;
        float* record = values.data() + k * DenseField::kPlane + j * DenseField::kRow + 2 * i;
        if (j < kBrick) record[0] = phi;
        if (j > 0) record[1 - DenseField::kRow] = phi;
      }
  return !same;
}

// Computes the distance in bricks, by the largest component, to the nearest band brick. Each of two passes visits half of the 26 neighbours
// (A. Rosenfeld and J. Pfaltz, "Sequential Operations in Digital Picture Processing", JACM 13(4), 1966). Initially each distance is 0 or
// kFarthest.
void spreadDistances(const std::array<int, 3>& bricks, std::vector<int>& distance) {
  const int bx = bricks[0], by = bricks[1], bz = bricks[2];
  const auto index = [&](int x, int y, int z) { return (size_t(z) * size_t(by) + size_t(y)) * size_t(bx) + size_t(x); };
  const auto relax = [&](int x, int y, int z, int sense) {
    int& here = distance[index(x, y, z)];
    for (int n = 0; n < 13; ++n) {
      const int dx = n % 3 - 1, dy = n / 3 % 3 - 1, dz = n / 9 - 1;  // the 13 neighbours before the centre of the 27
      const int nx = x + sense * dx, ny = y + sense * dy, nz = z + sense * dz;
      if (nx < 0 || ny < 0 || nz < 0 || nx >= bx || ny >= by || nz >= bz) continue;
      here = std::min(here, distance[index(nx, ny, nz)] + 1);
    }
  };
  for (int z = 0; z < bz; ++z)
    for (int y = 0; y < by; ++y)
      for (int x = 0; x < bx; ++x) relax(x, y, z, 1);
  for (int z = bz; z-- > 0;)
    for (int y = by; y-- > 0;)
      for (int x = bx; x-- > 0;) relax(x, y, z, -1);
}

// The number of blocks per axis, and below the number of all blocks.
std::array<int, 3> blockCounts(const DenseField& field) {
  const int blocks = kBrick >> field.block_bits;
  return {field.bricks[0] * blocks, field.bricks[1] * blocks, field.bricks[2] * blocks};
}
size_t product(const std::array<int, 3>& n) { return size_t(n[0]) * size_t(n[1]) * size_t(n[2]); }

// Whether φ has both signs in a block of a brick.
bool isMixed(const float* block, int cells) {
  int inside = 0;
  for (int k = 0; k <= cells; ++k)
    for (int j = 0; j < cells; ++j)
      for (int n = 0; n < 2 * (cells + 1); ++n) inside += block[k * DenseField::kPlane + j * DenseField::kRow + n] < 0;
  return inside != 0 && inside != 2 * cells * (cells + 1) * (cells + 1);
}

// 0 for blocks with both signs, 255 for the others.
std::vector<uint8_t> plainBlocks(const DenseField& field) {
  const int cells = 1 << field.block_bits;
  const auto counts = blockCounts(field);
  std::vector<uint8_t> plain(product(counts), 255);
  for (int z = 0; z < counts[2]; ++z)
    for (int y = 0; y < counts[1]; ++y)
      for (int x = 0; x < counts[0]; ++x) {
        const int i = x * cells, j = y * cells, k = z * cells;
        const size_t brick =
            (size_t(k / kBrick) * size_t(field.bricks[1]) + size_t(j / kBrick)) * size_t(field.bricks[0]) + size_t(i / kBrick);
        const float* values = field.values.data() + field.offsets[brick];
        if (values[0] == values[1] && std::fabs(values[0]) > field.band) continue;
        values += k % kBrick * DenseField::kPlane + j % kBrick * DenseField::kRow + 2 * (i % kBrick);
        if (isMixed(values, cells)) plain[(size_t(z) * size_t(counts[1]) + size_t(y)) * size_t(counts[0]) + size_t(x)] = 0;
      }
  return plain;
}

// The largest plain cube, of at most kMostBlocks per side, that extends from each block into one octant. It is 1 + the smallest cube of the
// seven neighbours in that octant (as for the largest square of ones in an image). In a row e(x) = min of v(x + k) + k over k ≥ 0, which is
// computed by doubling.
void growCubes(const std::array<int, 3>& counts, const std::vector<uint8_t>& plain, int octant, uint8_t* cubes) {
  const int bx = counts[0], by = counts[1], bz = counts[2];
  const int sx = octant & 1 ? -1 : 1, sy = octant & 2 ? -1 : 1, sz = octant & 4 ? -1 : 1;
  // Rows are padded by kMostBlocks at either end, because everything beyond the box is plain.
  const std::vector<uint8_t> beyond(size_t(bx), kMostBlocks);
  std::vector<uint8_t> first(size_t(bx + 2 * kMostBlocks), kMostBlocks), second = first;
  uint8_t *line = first.data() + kMostBlocks, *next = second.data() + kMostBlocks;
  const auto row = [&](int y, int z) { return (size_t(z) * size_t(by) + size_t(y)) * size_t(bx); };
  const auto finished = [&](int y, int z) { return y < 0 || z < 0 || y >= by || z >= bz ? beyond.data() : cubes + row(y, z); };
  for (int nz = 0; nz < bz; ++nz)
    for (int ny = 0; ny < by; ++ny) {
      const int z = sz < 0 ? nz : bz - 1 - nz, y = sy < 0 ? ny : by - 1 - ny;
      const uint8_t *a = finished(y + sy, z), *b = finished(y, z + sz), *c = finished(y + sy, z + sz), *mask = plain.data() + row(y, z);
      for (int x = 0; x < bx; ++x) next[x] = std::min(a[x], std::min(b[x], c[x]));
      for (int x = 0; x < bx; ++x) line[x] = uint8_t(std::min(int(std::min(next[x], next[x + sx])), kMostBlocks - 1) + 1) & mask[x];
      for (int step = 1; step < kMostBlocks; step *= 2, std::swap(line, next))
        for (int x = 0; x < bx; ++x) next[x] = std::min(line[x], uint8_t(line[x + sx * step] + step));
      std::copy(line, line + bx, cubes + row(y, z));
    }
}

void addClearances(DenseField& field) {
  const size_t most_bytes = std::min(std::max(kClearanceBytes, field.values.size() * sizeof(float)), size_t(INT32_MAX));
  while (field.block_bits < 3 && 8 * product(blockCounts(field)) > most_bytes) ++field.block_bits;
  const auto counts = blockCounts(field);
  const size_t blocks = product(counts);
  const std::vector<uint8_t> plain = plainBlocks(field);
  field.clearances.resize(8 * blocks);
  parallelFor(8, [&](int octant) {
    uint8_t* cubes = field.clearances.data() + size_t(octant) * blocks;
    growCubes(counts, plain, octant, cubes);
    for (size_t b = 0; b < blocks; ++b) cubes[b] = uint8_t(std::max(1, int(cubes[b])) - 1);
  });
}

// The band bricks, and for each other brick nothing and whether it is inside.
struct BandBricks {
  std::vector<std::unique_ptr<Brick>> bricks;
  std::vector<uint8_t> inside;
};
BandBricks bandBricks(const openvdb::FloatGrid& grid, const DenseField& field) {
  BandBricks band;
  band.bricks.resize(size_t(field.bricks[0]) * size_t(field.bricks[1]) * size_t(field.bricks[2]));
  band.inside.resize(band.bricks.size());
  parallelBlocks(band.bricks.size(), 16, [&](size_t begin, size_t end) {
    const auto accessor = grid.getConstAccessor();
    Brick values;
    for (size_t b = begin; b < end; ++b) {
      const openvdb::Coord low = lowCorner(field, b);
      if (touchesBand(accessor, low) && readBrick(accessor, low, values)) band.bricks[b] = std::make_unique<Brick>(values);
      band.inside[b] = accessor.getValue(low) < 0;
    }
  });
  return band;
}

}  // namespace

DenseField denseFromLevelSet(const LevelSet& level_set) {
  const openvdb::FloatGrid& grid = *level_set.grid->vdb;
  DenseField field{level_set.frame, {}, {}, grid.background(), {}, {}, 0, {}};

  // The box of the leaves plus one brick on every side. Leaves begin at multiples of 8.
  openvdb::CoordBBox box;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) box.expand(leaf->getNodeBoundingBox());
  if (box.empty()) box = openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(kBrick - 1));
  for (size_t a = 0; a < 3; ++a) {
    field.first[a] = box.min()[int(a)] - kBrick;
    field.bricks[a] = (box.max()[int(a)] + 1 - box.min()[int(a)]) / kBrick + 2;
  }

  // Band bricks in order, then a constant brick for each sign and distance that occurs.
  const BandBricks band = bandBricks(grid, field);
  std::vector<int> distance(band.bricks.size());
  for (size_t b = 0; b < distance.size(); ++b) distance[b] = band.bricks[b] ? 0 : kFarthest;
  spreadDistances(field.bricks, distance);
  std::map<std::pair<int, bool>, int32_t> constant_bricks;
  const auto append = [&](const float* values) {
    if (field.values.size() > size_t(INT32_MAX) - kValues) throw InputError("", "the level set has too many bricks: use fewer --voxels");
    field.values.insert(field.values.end(), values, values + kValues);
    return int32_t(field.values.size()) - kValues;
  };
  for (size_t b = 0; b < distance.size(); ++b) {
    if (band.bricks[b]) {
      field.offsets.push_back(append(band.bricks[b]->data()));
      continue;
    }
    const auto [found, is_new] = constant_bricks.try_emplace({distance[b], band.inside[b] != 0}, 0);
    if (is_new) {
      Brick constant;
      const float phi = std::max(field.band, float(std::min(distance[b], 1024) - 1) * kBrick / kSafeShare);
      constant.fill(band.inside[b] ? -phi : phi);
      found->second = append(constant.data());
    }
    field.offsets.push_back(found->second);
  }
  addClearances(field);
  return field;
}

}  // namespace cloudbake
