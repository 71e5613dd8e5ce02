// The small picture of an asset in a report.
#include "pipeline/batch/thumbnail.h"

#include <nlohmann/json.hpp>

#include "io/gltf/asset_info.h"
#include "pipeline/library/cloudbake.h"
#include "tests/pipeline/batch/batch_helpers.h"

namespace cloudbake {
namespace {

float brightness(const Vec3& pixel) { return (pixel.x + pixel.y + pixel.z) / 3; }

// The sun is at azimuth 105° and the camera at 0°, so that one side of a ball is brighter than the other; round it is sky.
TEST(Thumbnail, ShowsTheAssetInTheSun) {
  const TestFolder folder;
  const BakeResult baked = bake(ballMesh(3, 3, {100, 0, 0}), {{"rays", "16"}, {"voxels", "24"}});
  const auto asset = folder.write("ball.glb", baked.glb);
  const Image picture = drawThumbnail(asset);
  ASSERT_EQ(picture.width, 180);
  ASSERT_EQ(picture.height, 120);
  const auto at = [&](int x, int y) { return picture.pixels[size_t(y) * 180 + size_t(x)]; };
  const Vec3 sky = at(2, 60), middle = at(90, 60);
  EXPECT_GT(length(middle - sky), 0.05) << "the ball is in the middle, wherever it lies in the scene";
  EXPECT_LT(length(at(177, 60) - sky), 0.02) << "and all of it is in the picture";
  EXPECT_NE(brightness(at(68, 60)), brightness(at(112, 60)));
  const std::string jpeg = thumbnailOf(asset);
  EXPECT_EQ(jpeg.substr(0, 3), "\xFF\xD8\xFF") << "a JPEG";
  EXPECT_EQ(thumbnailOf(asset), jpeg) << "the same bytes each time";
}

// The page has the asset's name, and the look, sun and side of the thumbnail.
TEST(Thumbnail, TheLiveViewBeginsWithIt) {
  const TestFolder folder;
  const auto asset = folder.write("my ball.glb", bake(ballMesh(3, 3), {{"rays", "16"}, {"voxels", "24"}}).glb);
  const std::string page = liveViewOf(asset);
  const size_t begin = page.find('{', page.find("id=\"page\""));
  const Json scene = Json::parse(page.substr(begin, page.find("</script>", begin) - begin))["scenes"][0];
  EXPECT_EQ(scene["name"], "my ball");
  EXPECT_EQ(scene["look"], "plain");
  EXPECT_EQ(scene["view"]["sun"], (Json{kPlainView.sun_azimuth, kPlainView.sun_elevation}));
  EXPECT_NEAR(scene["view"]["azimuth"].get<float>(), kPlainView.camera_azimuth, 1e-3);
  EXPECT_NEAR(scene["view"]["elevation"].get<float>(), kPlainView.camera_elevation, 1e-3);
  EXPECT_EQ(liveViewOf(asset), page) << "the same bytes each time";
}

TEST(Thumbnail, OfWhatIsNoAsset) {
  const TestFolder folder;
  EXPECT_FALSE(refusalOf<IoError>([&] { thumbnailOf(folder.path / "no.glb"); }).empty());
  const std::string told = refusalOf<InputError>([&] { thumbnailOf(folder.write("a.glb", "text")); });
  EXPECT_TRUE(contains(told, "a.glb")) << told;
  EXPECT_EQ(refusalOf<InputError>([&] { liveViewOf(folder.path / "a.glb"); }), told);
}

}  // namespace
}  // namespace cloudbake
