// What the page of `view` contains; tests/browser/view.mjs looks at it in a browser.
#include "pipeline/picture/live_page.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/gltf/asset_info.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

Scenery oneBall() {
  Scenery scenery;
  BakedMesh& ball = scenery.meshes["ball"] = bakedBall(1);
  scenery.instances = {{&ball, placement({5, 0, 0}, {}, {-2, 2, 2})}};
  scenery.scene.light = lightFor(scenery.scene.post, 130, 28);
  return scenery;
}

// The text of the script element with this id.
std::string scriptOf(const std::string& page, const std::string& id) {
  const size_t at = page.find("id=\"" + id + "\">") + id.size() + 6;
  return page.substr(at, page.find("</script>", at) - at);
}

TEST(LivePage, HoldsTheSceneAsJson) {
  const Scenery scenery = oneBall();
  const Json page = Json::parse(scriptOf(livePage(scenery, "ball"), "page"));
  const BakedMesh& ball = *scenery.instances[0].mesh;
  EXPECT_EQ(page["name"], "ball");
  EXPECT_EQ(page["mesh"]["vertices"], ball.surface.positions.size());
  EXPECT_EQ(page["parts"].size(), 1U);
  EXPECT_EQ(page["parts"][0]["count"], 3 * ball.surface.triangles.size());
  EXPECT_FLOAT_EQ(page["parts"][0]["extinction"].get<float>(), ball.info.extinction / 2) << "per world unit";
  EXPECT_FLOAT_EQ(page["parts"][0]["shape"][1].get<float>(), 2 * ball.info.shape.bias);
  EXPECT_EQ(page["samples"].size(), 16U);
  EXPECT_EQ(page["corners"].size(), 8U);
  EXPECT_NEAR(page["camera"]["at"][0].get<float>(), 5, 1e-5);
  EXPECT_NEAR(page["view"]["elevation"].get<float>(), kPaintedView.camera_elevation, 1e-3);
  EXPECT_FLOAT_EQ(page["composite"]["phase"][0].get<float>(), scenery.scene.post.composite.phase.share);
  EXPECT_FLOAT_EQ(page["erode"]["shrink"].get<float>(), scenery.scene.post.painted.erode.shrink);
}

// Ten floats per vertex, and indices of two bytes where they suffice.
TEST(LivePage, HoldsVerticesAndTriangles) {
  const auto bytesOf = [](int subdivisions) {
    Scenery scenery = oneBall();
    BakedMesh& ball = scenery.meshes["ball"] = bakedBall(1, {}, subdivisions);
    scenery.instances = {{&ball, {}}, {&ball, placement({9, 0, 0}, {}, {1, 1, 1})}};
    const std::string text = scriptOf(livePage(scenery, "ball"), "mesh");
    const size_t vertices = 2 * ball.surface.positions.size(), indices = 6 * ball.surface.triangles.size();
    const size_t bytes = text.size() / 4 * 3 - size_t(std::count(text.end() - 2, text.end(), '='));
    return double(bytes - 40 * vertices) / double(indices);
  };
  EXPECT_EQ(bytesOf(4), 2);
  EXPECT_EQ(bytesOf(7), 4);
}

// The table has the colours of every hour; a colour that the scene sets is the same at all of them.
TEST(LivePage, ColorsFollowTheSunUnlessTheySet) {
  Scenery scenery = oneBall();
  scenery.scene.light.sky.colors.zenith = {0.5F, 0.25F, 0.125F};
  const Json colors = Json::parse(scriptOf(livePage(scenery, "ball"), "page"))["colors"];
  ASSERT_EQ(colors["names"][0], "zenith");
  ASSERT_EQ(colors["names"][1], "horizon");
  const Json &night = colors["rows"].front(), &day = colors["rows"].back();
  EXPECT_EQ(night[0], day[0]);
  EXPECT_EQ(day[0], (Json{0.5, 0.25, 0.125}));
  EXPECT_NE(night[1], day[1]);
  EXPECT_FLOAT_EQ(day[1][2].get<float>(), skyColorsFor(scenery.scene.post, 1).horizon.z);
}

TEST(LivePage, NamesCannotEndTheScript) {
  const std::string page = livePage(oneBall(), "</script><b>&");
  EXPECT_EQ(page.find("</script><b>"), std::string::npos);
  EXPECT_EQ(Json::parse(scriptOf(page, "page"))["name"], "</script><b>&");
  EXPECT_EQ(page.find("@NAME@"), std::string::npos);
  EXPECT_EQ(page.find("@SCRIPTS@"), std::string::npos);
  EXPECT_NE(page.find("<title>&lt;/script&gt;&lt;b&gt;&amp;</title>"), std::string::npos);
}

TEST(LivePage, RefusesWhatItCannotShow) {
  const auto refused = [](const std::function<void(SceneFile&)>& change) {
    Scenery scenery = oneBall();
    change(scenery.scene);
    return !refusalOf<UsageError>([&] { livePage(scenery, "ball"); }).empty();
  };
  EXPECT_FALSE(refused([](SceneFile&) {}));
  EXPECT_TRUE(refused([](SceneFile& s) { s.terrain.emplace(); }));
  EXPECT_TRUE(refused([](SceneFile& s) { s.slabs.emplace_back(); }));
  EXPECT_TRUE(refused([](SceneFile& s) { s.distance_clouds.emplace_back(); }));
  EXPECT_TRUE(refused([](SceneFile& s) { s.density_clouds.emplace_back(); }));
  EXPECT_TRUE(refused([](SceneFile& s) { s.post = publishedPost(); }));
  EXPECT_TRUE(refused([](SceneFile& s) { s.light.sky.moon.emplace(); }));
  EXPECT_TRUE(refused([](SceneFile& s) { s.light.sky.sun_disc = SunDisc::kSmooth; }));
  EXPECT_TRUE(refused([](SceneFile& s) { s.grade.vignette.emplace(); }));
  Scenery empty;
  EXPECT_FALSE(refusalOf<UsageError>([&] { livePage(empty, "nothing"); }).empty());
}

}  // namespace
}  // namespace cloudbake
