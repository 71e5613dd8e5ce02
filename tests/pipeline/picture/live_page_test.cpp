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

std::string pageOf(const Scenery& scenery, const std::string& name) {
  const LiveScene scene = liveScene(scenery, name);
  return livePage({&scene, 1});
}

TEST(LivePage, HoldsTheSceneAsJson) {
  const Scenery scenery = oneBall();
  const Json page = Json::parse(scriptOf(pageOf(scenery, "ball"), "page"));
  const BakedMesh& ball = *scenery.instances[0].mesh;
  ASSERT_EQ(page["scenes"].size(), 1U);
  const Json& scene = page["scenes"][0];
  EXPECT_EQ(scene["name"], "ball");
  EXPECT_EQ(scene["mesh"]["vertices"], ball.surface.positions.size());
  EXPECT_EQ(scene["parts"].size(), 1U);
  EXPECT_EQ(scene["parts"][0]["count"], 3 * ball.surface.triangles.size());
  EXPECT_FLOAT_EQ(scene["parts"][0]["extinction"].get<float>(), ball.info.extinction / 2) << "per world unit";
  EXPECT_FLOAT_EQ(scene["parts"][0]["shape"][1].get<float>(), 2 * ball.info.shape.bias);
  EXPECT_EQ(scene["corners"].size(), 8U);
  EXPECT_NEAR(scene["camera"]["at"][0].get<float>(), 5, 1e-5);
  EXPECT_NEAR(scene["view"]["elevation"].get<float>(), kPaintedView.camera_elevation, 1e-3);
  EXPECT_EQ(scene["look"], "painted");
  const Json& painted = page["looks"][scene["looks"]["painted"].get<size_t>()];
  EXPECT_EQ(painted["samples"].size(), 16U);
  EXPECT_FLOAT_EQ(painted["chain"]["composite"]["phase"][0].get<float>(), scenery.scene.post.composite.phase.share);
  EXPECT_FLOAT_EQ(painted["chain"]["erode"]["shrink"].get<float>(), scenery.scene.post.painted.erode.shrink);
  const Json& published = page["looks"][scene["looks"]["published"].get<size_t>()];
  EXPECT_EQ(published["chain"]["divisor"], 4);
  EXPECT_FLOAT_EQ(published["half_lambert"].get<float>(), LightSettings().half_lambert);
}

// A scene file says how it is drawn, and σ of all its clouds.
TEST(LivePage, ASceneFileHasItsOwnLook) {
  Scenery scenery = oneBall();
  scenery.scene.clouds.resize(1);
  scenery.scene.post = publishedPost();
  scenery.scene.light.extinction = 0.125F;
  const LiveScene live = liveScene(scenery, "ball");
  EXPECT_EQ(live.scene["look"], "published");
  EXPECT_EQ(live.looks.size(), 1U);
  EXPECT_TRUE(live.looks.contains("published"));
  EXPECT_EQ(live.scene["parts"][0]["extinction"], 0.125);
}

// Looks that are the same are there once.
TEST(LivePage, ScenesShareTheirLooks) {
  const LiveScene scenes[] = {liveScene(oneBall(), "a"), liveScene(oneBall(), "b")};
  const Json page = Json::parse(livePageData(scenes));
  EXPECT_EQ(page["looks"].size(), 3U);
  EXPECT_EQ(page["scenes"][0]["looks"], page["scenes"][1]["looks"]);
  EXPECT_EQ(page["scenes"][1]["name"], "b");
}

// Ten floats per vertex, and indices of two bytes where they suffice.
TEST(LivePage, HoldsVerticesAndTriangles) {
  const auto bytesOf = [](int subdivisions) {
    Scenery scenery = oneBall();
    BakedMesh& ball = scenery.meshes["ball"] = bakedBall(1, {}, subdivisions);
    scenery.instances = {{&ball, {}}, {&ball, placement({9, 0, 0}, {}, {1, 1, 1})}};
    const std::string text = liveScene(scenery, "ball").scene["mesh"]["data"];
    const size_t vertices = 2 * ball.surface.positions.size(), indices = 6 * ball.surface.triangles.size();
    const size_t bytes = text.size() / 4 * 3 - size_t(std::count(text.end() - 2, text.end(), '='));
    return double(bytes - 40 * vertices) / double(indices);
  };
  EXPECT_EQ(bytesOf(4), 2);
  EXPECT_EQ(bytesOf(7), 4);
}

// Harmonics are whole vectors of four per vertex; a compared mesh adds its lobes.
TEST(LivePage, HoldsHarmonicsAndComparedLobes) {
  Scenery scenery = oneBall();
  const BakedMesh& ball = *scenery.instances[0].mesh;
  BakedMesh other = ball;
  other.info.lobe = "fit";
  other.info.harmonic_order = 2;
  other.harmonics.assign(9 * ball.lobes.size(), 0.5F);
  const size_t plain = liveScene(scenery, "ball").scene["mesh"]["data"].get<std::string>().size();
  scenery.compared.emplace(&ball, other);
  const Json scene = liveScene(scenery, "ball").scene;
  EXPECT_EQ(scene["mesh"]["harmonics"], 12);
  EXPECT_EQ(scene["mesh"]["compared"], true);
  EXPECT_EQ(scene["parts"][0]["compared"]["lobe"], "fit");
  EXPECT_NEAR(double(scene["mesh"]["data"].get<std::string>().size() - plain) * 0.75, double(ball.lobes.size()) * 4 * (12 + 4), 3);
  EXPECT_NEAR(scene["parts"][0]["harmonics"]["to_own"][0].get<double>(), -0.5, 1e-12);
}

// The page decodes the names of colours and the bytes of their table.
TEST(LivePage, ColorsFollowTheSunUnlessTheySet) {
  Scenery scenery = oneBall();
  scenery.scene.clouds.resize(1);
  const std::string free = liveScene(scenery, "ball").looks["painted"]["colors"]["rows"];
  scenery.scene.light.sky.colors.zenith = {0.5F, 0.25F, 0.125F};
  const Json colors = liveScene(scenery, "ball").looks["painted"]["colors"];
  ASSERT_EQ(colors["names"][0], "zenith");
  const std::string set = colors["rows"];
  const size_t row = 6 * 12 / 3 * 4;  // characters of 6 colours of 12 bytes
  ASSERT_EQ(set.size(), 161 * row);
  EXPECT_NE(free.substr(0, 16), free.substr(160 * row, 16));
  EXPECT_EQ(set.substr(0, 16), "AAAAPwAAgD4AAAA+") << "0.5, 0.25, 0.125";
  EXPECT_EQ(set.substr(160 * row, 16), set.substr(0, 16));
  EXPECT_EQ(set.substr(16, row - 16), free.substr(16, row - 16));
}

TEST(LivePage, NamesCannotEndTheScript) {
  const std::string page = pageOf(oneBall(), "</script><b>&");
  EXPECT_EQ(page.find("</script><b>"), std::string::npos);
  EXPECT_EQ(Json::parse(scriptOf(page, "page"))["scenes"][0]["name"], "</script><b>&");
  EXPECT_EQ(page.find("@NAME@"), std::string::npos);
  EXPECT_EQ(page.find("@SCRIPTS@"), std::string::npos);
  EXPECT_NE(page.find("<title>&lt;/script&gt;&lt;b&gt;&amp;</title>"), std::string::npos);
}

// A file may have any name.
TEST(LivePage, BytesOfANameThatAreNotUtf8AreReplaced) {
  const std::string page = pageOf(oneBall(), "\xff");
  EXPECT_EQ(Json::parse(scriptOf(page, "page"))["scenes"][0]["name"], "\uFFFD");
  EXPECT_NE(page.find("<title>\uFFFD</title>"), std::string::npos);
}

// A file may not ask for anything; a served page receives from its server.
TEST(LivePage, OnlyServedPagesMayConnect) {
  const LiveScene scene = liveScene(oneBall(), "ball");
  const std::string file = livePage({&scene, 1}), served = livePage({&scene, 1}, PageKind::kServed);
  EXPECT_NE(file.find("connect-src 'none'"), std::string::npos);
  EXPECT_EQ(file.find("data-events"), std::string::npos);
  EXPECT_NE(served.find("connect-src 'self'"), std::string::npos);
  EXPECT_NE(served.find("data-events"), std::string::npos);
}

TEST(LivePage, RefusesWhatItCannotShow) {
  const auto refused = [](const std::function<void(SceneFile&)>& change) {
    Scenery scenery = oneBall();
    change(scenery.scene);
    return !refusalOf<UsageError>([&] { liveScene(scenery, "ball"); }).empty();
  };
  EXPECT_FALSE(refused([](SceneFile&) {}));
  EXPECT_TRUE(refused([](SceneFile& s) { s.terrain.emplace(); }));
  EXPECT_TRUE(refused([](SceneFile& s) { s.slabs.emplace_back(); }));
  EXPECT_TRUE(refused([](SceneFile& s) { s.distance_clouds.emplace_back(); }));
  EXPECT_TRUE(refused([](SceneFile& s) { s.density_clouds.emplace_back(); }));
  EXPECT_TRUE(refused([](SceneFile& s) { s.light.sky.moon.emplace(); }));
  EXPECT_TRUE(refused([](SceneFile& s) { s.light.sky.sun_disc = SunDisc::kSmooth; }));
  EXPECT_TRUE(refused([](SceneFile& s) { s.grade.vignette.emplace(); }));
  Scenery empty;
  EXPECT_FALSE(refusalOf<UsageError>([&] { liveScene(empty, "nothing"); }).empty());
}

}  // namespace
}  // namespace cloudbake
