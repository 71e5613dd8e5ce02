// The light of a retained cloud is that of its bake.
#include "pipeline/library/cloud_light.h"

#include <cmath>

#include "bake/lobe/directions.h"
#include "core/error.h"
#include "io/file/write_file.h"
#include "tests/io/io_helpers.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;

// A ball as an asset, in a folder of its own.
struct BallFile {
  TestFolder folder;
  SurfaceMesh mesh = ballMesh(1.5F, 4, {4, 0, 0});
  fs::path file = folder.path / "ball.glb";
  BallFile() { writeFileAtomically(file, bake(mesh, {{"rays", "16"}}).glb); }
};

// Of a ball of radius R the chord from p along ω is max(0, −2 n·ω) R.
TEST(CloudLight, LengthsAreTheChordsOfABall) {
  const BallFile ball;
  const CloudLight light(ball.file, {});
  ASSERT_EQ(light.vertexCount(), ball.mesh.positions.size());
  for (const Vec3 direction : {Vec3{0, 1, 0}, *normalized(Vec3{1, -2, 0.5F}), *normalized(Vec3{-1, 0.1F, -0.3F})}) {
    const std::vector<float> lengths = light.lengths(direction);
    double sum = 0;
    for (size_t v = 0; v < lengths.size(); ++v) {
      const Vec3 normal = (ball.mesh.positions[v] - Vec3{4, 0, 0}) / 1.5F;
      ASSERT_GE(lengths[v], 0);
      sum += std::fabs(lengths[v] - std::max(0.0F, -2 * dot(normal, direction)) * 1.5F);
    }
    EXPECT_LT(sum / double(lengths.size()), 0.02);  // a voxel is 0.03
  }
}

TEST(CloudLight, LobesAreThoseOfABake) {
  const BallFile ball;
  const CloudLight light(ball.file, {{"voxels", "40"}});
  const Options options{{"voxels", "40"}, {"lobe", "fit"}, {"rays", "64"}, {"extinction", "1:3"}, {"sun-arc", "10:40,0:90"}};
  const CloudLight::Lobes lobes = light.lobes(options);
  const BakeResult baked = bake(ball.file, options);
  EXPECT_EQ(lobes.shape.exponent, baked.info.shape.exponent);
  EXPECT_EQ(lobes.shape.bias, baked.info.shape.bias);
  EXPECT_EQ(lobes.extinction, baked.info.extinction);
  EXPECT_FALSE(lobes.fit.empty());
  ASSERT_EQ(lobes.lobes.size(), baked.lobes.size());
  for (size_t v = 0; v < baked.lobes.size(); ++v) {
    // The asset's are rounded once more.
    ASSERT_LT(length(lobes.lobes[v].direction - baked.lobes[v].direction), 3e-7F) << v;
    ASSERT_FLOAT_EQ(lobes.lobes[v].thickness, baked.lobes[v].thickness) << v;
  }
}

TEST(CloudLight, RefusesWhatABakeRefuses) {
  const BallFile ball;
  EXPECT_THROW(CloudLight(ball.folder.path / "missing.glb", {}), IoError);
  EXPECT_THROW(CloudLight(ball.file, {{"json", "report.json"}}), UsageError);
  EXPECT_THROW(CloudLight(ball.file, {}).lobes({{"rays", "7"}}), UsageError);
}

}  // namespace
}  // namespace cloudbake
