// What the page of `view` has of layers beside their settings.
#include "pipeline/page/layer_data.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/harmonics.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace cloudbake {
namespace {

std::shared_ptr<const HarmonicLattice> someLattice(int cells) {
  HarmonicLattice lattice;
  lattice.order = 3, lattice.extinction = 2, lattice.cell_size = 0.5F, lattice.cells = {cells, cells, cells}, lattice.origin = {1, 2, 3};
  lattice.coefficients.resize(size_t(cells) * size_t(cells) * size_t(cells) * harmonicCount(3));
  return std::make_shared<const HarmonicLattice>(lattice);
}

SceneDust dustOf(const std::shared_ptr<const HarmonicLattice>& lattice, float scale) {
  SceneDust dust;
  dust.lattice = lattice;
  dust.to_world = placement({1, 0, 0}, {}, {scale, scale, scale});
  return dust;
}

TEST(LayerData, APictureIsShrunkToTheMeansOfSquares) {
  Image picture = blankImage(5, 2);
  for (int x = 0; x < 5; ++x) picture.at(x, 0) = {float(x), 0, 1}, picture.at(x, 1) = {float(x), 4, 1};
  EXPECT_EQ(shrunkTo(picture, 5).pixels, picture.pixels);
  const Image small = shrunkTo(picture, 3);
  ASSERT_EQ(small.width, 3);
  ASSERT_EQ(small.height, 1);
  EXPECT_EQ(small.at(0, 0), (Vec3{0.5F, 2, 1}));
  EXPECT_EQ(small.at(1, 0), (Vec3{2.5F, 2, 1}));
  EXPECT_EQ(small.at(2, 0), (Vec3{4, 2, 1})) << "the last square is narrower";
}

TEST(LayerData, ALatticeIsStoredOnce) {
  SceneFile scene;
  const auto one = someLattice(3), other = someLattice(4);
  scene.dust = {dustOf(one, 1), dustOf(other, 2), dustOf(one, 2)};
  MeshPacker packer;
  const Json packed = packedLayers(scene, packer), places = dustPlaces(scene);
  ASSERT_EQ(packed["lattices"].size(), 2U);
  EXPECT_EQ(packed["lattices"][1], (Json{{"origin", {1, 2, 3}}, {"cell_size", 0.5}, {"cells", {4, 4, 4}}, {"coefficients", 16}}));
  EXPECT_FALSE(packed.contains("moon_picture"));
  ASSERT_EQ(places.size(), 3U);
  for (const auto& [at, lattice, extinction] : {std::tuple(0, 0, 1.0), std::tuple(1, 1, 0.5), std::tuple(2, 0, 0.5)}) {
    EXPECT_EQ(places[size_t(at)]["lattice"], lattice);
    EXPECT_EQ(places[size_t(at)]["extinction"], extinction) << "a larger copy is as much thinner";
  }
  EXPECT_EQ(places[1]["to_own"], (Json{0.5, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.5, -0.5, 0.0, 0.0}));
  scene.light.extinction = 3.0F;
  EXPECT_EQ(dustPlaces(scene)[1]["extinction"], 1.5);
}

TEST(LayerData, RefusesLatticesThatAreTooLarge) {
  SceneFile scene;
  scene.dust = {dustOf(someLattice(64), 1)};
  MeshPacker packer;
  EXPECT_NO_THROW(packedLayers(scene, packer));
  scene.dust.push_back(dustOf(someLattice(16), 1));
  expectError<UsageError>([&] { packedLayers(scene, packer); }, "--lattice-cells");
}

}  // namespace
}  // namespace cloudbake
