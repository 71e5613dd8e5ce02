// The seal notices what was changed, says by how much, and does not mind what changes nothing.
#include "core/seal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

struct Sealed {
  SculptPart part;
  std::vector<LobeUvs> uvs;
  std::vector<float> harmonics;
};

// An ellipsoid whose lobes have nothing in common.
Sealed sealedShape() {
  Sealed shape;
  const SurfaceMesh mesh = ballMesh(1, 3);
  shape.part.positions = mesh.positions;
  shape.part.triangles = mesh.triangles;
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    Vec3& p = shape.part.positions[v];
    p = {2 * p.x, p.y, 0.5F * p.z};
    const auto draw = [&](uint32_t i) { return uniformFloat(hashDraw(11, uint32_t(v), i)); };
    const Vec3 o = *normalized({draw(0) - 0.5F, draw(1) - 0.5F, draw(2) - 0.5F});
    shape.uvs.push_back({{o.x, o.y}, {o.z, 0.1F + draw(3)}});
    for (uint32_t i = 0; i < 4; ++i) shape.harmonics.push_back(draw(4 + i));
  }
  return shape;
}

AssetInfo someInfo() {
  AssetInfo info;
  info.extinction = 2;
  info.harmonic_order = 1;
  return info;
}

AssetSeal sealOf(const std::vector<Sealed>& parts, const AssetInfo& info = someInfo()) {
  SealMaker maker;
  for (const Sealed& one : parts) maker.add(one.part, one.uvs, one.harmonics);
  return maker.finished(info);
}
AssetSeal sealOf(const Sealed& shape) { return sealOf(std::vector<Sealed>{shape}); }

SealDifference changedBy(const auto& change) {
  Sealed shape = sealedShape();
  const AssetSeal before = sealOf(shape);
  change(shape);
  return differenceOf(before, sealOf(shape));
}

void expectNothing(const SealDifference& difference, const char* what) {
  EXPECT_FALSE(difference.mesh || difference.constants) << what;
  EXPECT_LT(difference.shape, 1e-6) << what;
  EXPECT_LT(difference.lobes, 1e-6) << what;
  EXPECT_LT(difference.harmonics, 1e-6) << what;
}

// The vertices in another order, each triangle beginning elsewhere.
void reorder(Sealed& shape) {
  const size_t count = shape.uvs.size();
  Sealed other = shape;
  for (size_t v = 0; v < count; ++v) {
    const size_t to = (v * 7 + 3) % count;  // count is no multiple of 7
    other.part.positions[to] = shape.part.positions[v];
    other.uvs[to] = shape.uvs[v];
    std::copy_n(&shape.harmonics[4 * v], 4, &other.harmonics[4 * to]);
  }
  std::reverse(other.part.triangles.begin(), other.part.triangles.end());
  for (Triangle& t : other.part.triangles) {
    for (uint32_t& v : t) v = uint32_t((v * 7 + 3) % count);
    std::rotate(t.begin(), t.begin() + 1, t.end());
  }
  shape = other;
}

// Every triangle with corners of its own, and a vertex that nothing uses.
void split(Sealed& shape) {
  Sealed other;
  for (const Triangle& t : shape.part.triangles) {
    other.part.triangles.push_back({});
    for (size_t i = 0; i < 3; ++i) {
      other.part.triangles.back()[i] = uint32_t(other.uvs.size());
      other.part.positions.push_back(shape.part.positions[t[i]]);
      other.uvs.push_back(shape.uvs[t[i]]);
      other.harmonics.insert(other.harmonics.end(), &shape.harmonics[4 * t[i]], &shape.harmonics[4 * t[i]] + 4);
    }
  }
  other.part.positions.push_back({9, 9, 9});
  other.uvs.push_back({{1, 0}, {0, 5}});
  other.harmonics.resize(4 * other.uvs.size());
  shape = other;
}

TEST(Seal, DoesNotMindOrderSplitVerticesAndTrianglesWithoutArea) {
  ASSERT_NE(sealedShape().uvs.size() % 7, 0U);
  expectNothing(changedBy(reorder), "order");
  expectNothing(changedBy(split), "split");
  expectNothing(changedBy([](Sealed& shape) { shape.part.triangles.push_back({5, 5, 6}); }), "a triangle without area");
  expectNothing(changedBy([](Sealed& shape) {
                  for (Vec3& p : shape.part.positions) p = {p.x == 0 ? -0.0F : p.x, p.y == 0 ? -0.0F : p.y, p.z};
                }),
                "minus zero");
}

TEST(Seal, ShapesBeyondFloatAreNotFinite) {
  for (const float size : {1e37F, 1e38F, 3e38F}) {
    Sealed shape = sealedShape();
    for (Vec3& p : shape.part.positions) p = {p.x / 2 * size, p.y * size, p.z * size};
    SealMaker maker;
    maker.add(shape.part, shape.uvs, shape.harmonics);
    EXPECT_EQ(isFinite(maker.finished(someInfo())), size < 3e38F) << size;
  }
  Sealed shape = sealedShape();
  for (LobeUvs& uv : shape.uvs) uv.second.y = 3e38F;
  SealMaker maker;
  maker.add(shape.part, shape.uvs);
  EXPECT_FALSE(isFinite(maker.finished({})));
}

TEST(Seal, DoesNotMindWhereTheWholeAssetIs) {
  expectNothing(changedBy([](Sealed& shape) {
                  const double c = std::cos(0.3), s = std::sin(0.3);
                  shape.part.to_scene = {{{{c, 0, s}, {0, 1, 0}, {-s, 0, c}}}, {7, -3, 40}};
                }),
                "turned and moved");
}

TEST(Seal, NoticesAMovedVertexATurnedTriangleAndAMissingOne) {
  EXPECT_TRUE(changedBy([](Sealed& shape) { shape.part.positions[4].x = std::nextafter(shape.part.positions[4].x, 9.0F); }).mesh);
  EXPECT_TRUE(changedBy([](Sealed& shape) { std::swap(shape.part.triangles[4][0], shape.part.triangles[4][1]); }).mesh);
  EXPECT_TRUE(changedBy([](Sealed& shape) { shape.part.triangles.pop_back(); }).mesh);
  EXPECT_TRUE(changedBy([](Sealed& shape) { shape.part.triangles.push_back(shape.part.triangles.back()); }).mesh);
}

TEST(Seal, TellsTheShapesInTheSceneApart) {
  const auto difference = [](Affine map) { return changedBy([&](Sealed& shape) { shape.part.to_scene = map; }); };
  const auto placed = [&](Affine map) { return difference(map).shape; };
  const Affine twice{{{{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}}, {}}, longer{{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1.1}}}, {}};
  EXPECT_TRUE(difference(twice).isReshaped() && !difference(twice).isDeformed());
  EXPECT_TRUE(difference(longer).isReshaped() && difference(longer).isDeformed());
  EXPECT_GT(placed(twice), 2.999) << "the area is four times as large";
  EXPECT_GT(placed({{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1.1}}}, {}}), 0.005);
  EXPECT_GT(placed({{{{1, 0.1, 0}, {0, 1, 0}, {0, 0, 1}}}, {}}), 0.001);
  Sealed other = sealedShape();
  other.part.to_scene.offset = {5, 0, 0};
  const AssetSeal before = sealOf({sealedShape(), other});
  other.part.to_scene.offset = {5.1, 0, 0};
  const SealDifference moved = differenceOf(before, sealOf({sealedShape(), other}));
  EXPECT_FALSE(moved.mesh);
  EXPECT_GT(moved.shape, 0.01);
}

// The estimate has a standard error of 1/√32 = 18 %: three of them are allowed.
TEST(Seal, SaysByHowMuchLobesAndCoefficientsChanged) {
  const auto unit = [](size_t v, uint32_t i) { return uniformFloat(hashDraw(3, uint32_t(v), i)) - 0.5F; };
  for (const double share : {1e-4, 1e-3, 1e-2, 0.1, 1.0}) {
    double change = 0, size = 0;
    const SealDifference difference = changedBy([&](Sealed& shape) {
      for (size_t v = 0; v < shape.uvs.size(); ++v) {
        LobeUvs& uv = shape.uvs[v];
        const double before = uv.second.y;
        uv.second.y *= float(1 + share * unit(v, 0));
        change += std::pow(uv.second.y - before, 2), size += before * before;
      }
    });
    const double expected = std::sqrt(change / size);
    EXPECT_NEAR(difference.lobes, expected, 0.55 * expected) << share;
    EXPECT_LT(difference.harmonics, 1e-6);
    EXPECT_FALSE(difference.mesh || difference.constants);
  }
  EXPECT_GT(changedBy([](Sealed& shape) { shape.harmonics[9] += 3; }).harmonics, 0.01);
  EXPECT_GT(changedBy([](Sealed& shape) { std::swap(shape.uvs[3], shape.uvs[90]); }).lobes, 0.01) << "two vertices";
  EXPECT_FALSE(changedBy([](Sealed& shape) { shape.uvs[3].second.y = NAN; }).lobes <= 1) << "a NaN is a change";
}

TEST(Seal, NoticesEveryConstant) {
  const Sealed shape = sealedShape();
  const AssetSeal before = sealOf({shape}, someInfo());
  const auto changed = [&](const auto& change) {
    AssetInfo info = someInfo();
    change(info);
    return differenceOf(before, sealOf({shape}, info)).constants;
  };
  EXPECT_FALSE(changed([](AssetInfo& info) { info.seed = 9, info.rays = 7, info.input_hash = "x", info.level = 2; }));
  EXPECT_TRUE(changed([](AssetInfo& info) { info.lobe = "fit"; }));
  EXPECT_TRUE(changed([](AssetInfo& info) { info.shape.exponent = 4; }));
  EXPECT_TRUE(changed([](AssetInfo& info) { info.shape.bias = 1e-7F; }));
  EXPECT_TRUE(changed([](AssetInfo& info) { info.extinction = std::nextafter(2.0F, 3.0F); }));
  EXPECT_TRUE(changed([](AssetInfo& info) { info.extinction_low = 1; }));
  EXPECT_TRUE(changed([](AssetInfo& info) { info.extinction_high = 3; }));
  EXPECT_TRUE(changed([](AssetInfo& info) { info.ray_length = 1; }));
  EXPECT_TRUE(changed([](AssetInfo& info) { info.harmonic_order = 2; }));
  EXPECT_TRUE(changed([](AssetInfo& info) { info.sun_arc.emplace(); }));
  EXPECT_TRUE(changed([](AssetInfo& info) { info.volume.emplace(); }));
}

}  // namespace
}  // namespace cloudbake
