// What the page of `view` contains; tests/browser/view.mjs looks at it in a browser.
#include "pipeline/page/live_page.h"

#include <gtest/gtest.h>
#include <zlib.h>
#include <memory>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/impostor.h"
#include "io/gltf/asset_info.h"
#include "pipeline/page/live_layers.h"
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

// What the page reads: base64, deflated.
std::string meshBytes(const LiveScene& scene) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/", text = scene.scene["mesh"]["data"];
  std::string packed;
  for (size_t at = 0, bits = 0, value = 0; at < text.size() && text[at] != '='; ++at) {
    value = (value << 6 | digits.find(text[at])) & 0xffff;
    if ((bits += 6) >= 8) packed.push_back(char(value >> (bits -= 8)));
  }
  std::string bytes(100 * packed.size(), '\0');
  uLongf size = bytes.size();
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size, reinterpret_cast<const Bytef*>(packed.data()), packed.size()), Z_OK);
  bytes.resize(size);
  return bytes;
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

TEST(LivePage, HasASizeIfOneIsGiven) {
  Scenery scenery = oneBall();
  EXPECT_FALSE(liveScene(scenery, "ball").scene.contains("size"));
  scenery.scene.view.width = 320, scenery.scene.view.height = 100, scenery.scene.view.is_sized = true;
  EXPECT_EQ(liveScene(scenery, "ball").scene["size"], Json({320, 100}));
}

// Looks that are the same are there once.
TEST(LivePage, ScenesShareTheirLooks) {
  const LiveScene scenes[] = {liveScene(oneBall(), "a"), liveScene(oneBall(), "b")};
  const Json page = Json::parse(livePageData(scenes));
  EXPECT_EQ(page["looks"].size(), 3U);
  EXPECT_EQ(page["scenes"][0]["looks"], page["scenes"][1]["looks"]);
  EXPECT_EQ(page["scenes"][1]["name"], "b");
}

// Eight whole numbers of four bytes per vertex, and an index for each corner; tests/browser/view.mjs unpacks them.
TEST(LivePage, HoldsVerticesAndTriangles) {
  Scenery scenery = oneBall();
  const BakedMesh& ball = *scenery.instances[0].mesh;
  scenery.instances.push_back({&ball, placement({9, 0, 0}, {}, {1, 1, 1})});  // a mirrored one is no copy
  const LiveScene live = liveScene(scenery, "ball");
  const size_t vertices = 2 * ball.surface.positions.size(), indices = 6 * ball.surface.triangles.size();
  EXPECT_EQ(live.scene["mesh"]["vertices"], vertices);
  EXPECT_EQ(meshBytes(live).size(), 32 * vertices + 4 * indices);
}

// What the march of a single cloud needs: how its volume shows light, and whether the mesh has an inside.
TEST(LivePage, SaysHowTheVolumeOfASingleCloudShowsLight) {
  Scenery scenery = oneBall();
  const auto partOf = [&] { return liveScene(scenery, "ball").scene["parts"][0]; };
  EXPECT_EQ(partOf()["volume"], Json({{"view_extinction", 1.0}, {"asymmetry", 0.0}, {"octaves", {0, 0.5, 0.5, 0.5}}}))
      << "single scattering where the lobes were fitted to no volume";
  EXPECT_FALSE(partOf().contains("is_open"));
  BakedMesh& ball = scenery.meshes["ball"];
  ball.info.volume = VolumeLight{2, {3, 0.25F, 0.75F, 0.5F}, -0.5F};
  ball.surface.triangles.pop_back();
  EXPECT_EQ(partOf()["volume"], Json({{"view_extinction", 2.0}, {"asymmetry", -0.5}, {"octaves", {3, 0.25, 0.75, 0.5}}}));
  EXPECT_EQ(partOf()["is_open"], true);
  scenery.instances.push_back({&ball, placement({9, 0, 0}, {}, {1, 1, 1})});
  EXPECT_FALSE(partOf().contains("volume") || partOf().contains("is_open")) << "of several clouds no volume is marched";
}

// A ball of 1 that becomes one of 2, then a finer one of 2, in two places; the second is mirrored.
Scenery growingBalls() {
  Scenery scenery;
  const auto keyOf = [](double frame, const BakedMesh& ball) {
    return SequenceKey{frame, ball.surface.positions, ball.surface.normals, ball.lobes};
  };
  const BakedMesh small = bakedBall(1, {}, 2), large = bakedBall(2, {}, 2), fine = bakedBall(2, {}, 3);
  BakedMesh& first = scenery.meshes["grows"] = small;
  SceneSequence& own = scenery.sequences[&first];
  own.sequence.info = small.info;
  own.sequence.frames_per_second = 12, own.sequence.loops = true, own.sequence.period = 20;
  own.sequence.segments = {{small.surface.triangles, {keyOf(0, small), keyOf(10, large)}}, {fine.surface.triangles, {keyOf(8, fine)}}};
  own.whole = drawnBox(fine.surface);
  for (const float x : {-5.0F, 5.0F}) scenery.instances.push_back({&first, placement({x, 0, 0}, {}, {x / 5, 1, 1})});
  for (Instance& instance : scenery.instances) instance.whole = own.whole;
  scenery.scene.light = lightFor(scenery.scene.post, 130, 28);
  return scenery;
}

// Eight whole numbers of four bytes per vertex and key, and an index for each corner; tests/browser/sequences.mjs unpacks them. There is
// room for the largest mesh in each place.
TEST(LivePage, HoldsTheKeysOfACloudThatChanges) {
  const Scenery scenery = growingBalls();
  const CloudSequence& sequence = scenery.sequences.begin()->second.sequence;
  const LiveScene live = liveScene(scenery, "grows");
  const Json &mesh = live.scene["mesh"], &parts = live.scene["parts"];
  ASSERT_EQ(mesh["sequences"].size(), 1U) << "which both places share";
  const size_t coarse = sequence.segments[0].keys[0].positions.size(), fine = sequence.segments[1].keys[0].positions.size();
  const size_t corners = 3 * sequence.segments[0].triangles.size(), fine_corners = 3 * sequence.segments[1].triangles.size();
  EXPECT_EQ(mesh["sequences"][0]["segments"], Json({{{"frames", {0.0, 10.0}}, {"vertices", coarse}, {"corners", corners}},
                                                    {{"frames", {8.0}}, {"vertices", fine}, {"corners", fine_corners}}}));
  EXPECT_EQ(mesh["sequences"][0]["frames_per_second"], 12);
  EXPECT_EQ(mesh["sequences"][0]["period"], 20);
  EXPECT_EQ(mesh["sequences"][0]["loops"], true);
  EXPECT_EQ(meshBytes(live).size(), 32 * (2 * coarse + fine) + 4 * (corners + fine_corners));
  EXPECT_EQ(mesh["vertices"], 2 * fine);
  for (const size_t i : {0, 1}) {
    EXPECT_EQ(parts[i]["vertices"], fine);
    EXPECT_EQ(parts[i]["first_vertex"], i * fine);
    EXPECT_EQ(parts[i]["count"], fine_corners);
    EXPECT_EQ(parts[i]["sequence"]["of"], 0);
    EXPECT_EQ(parts[i]["sequence"]["by"], affineJson(scenery.instances[i].to_world));
  }
  float lowest = 0;
  for (const Json& corner : live.scene["corners"]) lowest = std::min(lowest, corner[1].get<float>());
  EXPECT_NEAR(lowest, -2, 0.1) << "the box of all times";
}

// A copy has its own place among the vertices, and says how it is made of those that are stored.
TEST(LivePage, HoldsACloudAndItsCopiesOnce) {
  Scenery scenery = oneBall();
  const BakedMesh& ball = *scenery.instances[0].mesh;
  scenery.instances.push_back({&ball, placement({9, 0, 0}, {0, 90, 0}, {-6, 6, 6})});
  scenery.instances.push_back({&ball, placement({0, 9, 0}, {}, {1, 2, 1})});
  const LiveScene live = liveScene(scenery, "ball");
  const size_t vertices = ball.surface.positions.size(), corners = 3 * ball.surface.triangles.size();
  EXPECT_EQ(live.scene["mesh"]["vertices"], 3 * vertices);
  EXPECT_EQ(meshBytes(live).size(), 32 * 2 * vertices + 4 * 2 * corners) << "a stretched one is stored";
  const Json& parts = live.scene["parts"];
  EXPECT_FALSE(parts[0].contains("copy") || parts[2].contains("copy"));
  ASSERT_TRUE(parts[1].contains("copy"));
  EXPECT_EQ(parts[1]["first_vertex"], vertices);
  EXPECT_EQ(parts[1]["copy"]["of"], 0);
  Affine by;
  for (size_t i = 0; i < 9; ++i) by.linear[i % 3][i / 3] = parts[1]["copy"]["by"][i].get<double>();
  for (size_t i = 0; i < 3; ++i) by.offset[i] = parts[1]["copy"]["by"][9 + i].get<double>();
  const Vec3 first = ball.surface.positions[5], moved = transformPoint(by, transformPoint(scenery.instances[0].to_world, first));
  EXPECT_NEAR(length(moved - transformPoint(scenery.instances[1].to_world, first)), 0, 1e-5);
}

// A level follows the cloud that it is drawn for; copies of it are copies.
TEST(LivePage, HoldsLevels) {
  Scenery scenery = oneBall();
  const BakedMesh& ball = *scenery.instances[0].mesh;
  BakedMesh level = bakedBall(1, {}, 1);
  level.info.switch_pixels = 40;
  const BakedMesh* levels[] = {&level};
  scenery.instances[0].levels = levels;
  scenery.instances.push_back({&ball, placement({9, 0, 0}, {}, {-1, 1, 1}), nullptr, {}, levels});
  const Json parts = liveScene(scenery, "ball").scene["parts"];
  ASSERT_EQ(parts.size(), 4U);
  EXPECT_EQ(parts[1]["level"], (Json{{"of", 0}, {"pixels", 40}}));
  EXPECT_EQ(parts[3]["level"]["of"], 2);
  EXPECT_EQ(parts[3]["copy"]["of"], 1);
  EXPECT_EQ(parts[3]["first"], parts[2]["first"].get<size_t>() + parts[2]["count"].get<size_t>());
  EXPECT_EQ(parts[0]["seen"]["longest"], 4);
  EXPECT_EQ(parts[0]["seen"]["low"], Json({3, -2, -2}));
  EXPECT_FALSE(parts[1].contains("seen"));
}

// A ball's impostor as a level of it.
BakedMesh impostorLevel(int pixels) {
  ImpostorInfo info;
  info.views = 2, info.frame = 8;
  info.center = {0, 0.5F, 0}, info.radius = 1.5F;
  info.box.add({-1, -1, -1}), info.box.add({1, 1, 1});
  info.extinction = 3;
  info.level = 2, info.switch_pixels = pixels;
  Impostor impostor = blankImpostor(info);
  addMipLevels(impostor);
  return boxWithImpostor(std::move(impostor));
}

// A level that is an impostor has the corners of its box, at which light is found, no triangles, and its pictures once.
TEST(LivePage, HoldsImpostorsAsLevels) {
  Scenery scenery = oneBall();
  const BakedMesh& ball = *scenery.instances[0].mesh;
  BakedMesh level = bakedBall(1, {}, 1);
  level.info.switch_pixels = 40;
  const BakedMesh far = impostorLevel(20);
  const BakedMesh* levels[] = {&level, &far};
  scenery.instances[0].levels = levels;
  scenery.instances.push_back({&ball, placement({9, 0, 0}, {}, {1, 1, 1}), nullptr, {}, levels});
  scenery.fields.push_back({ScatterSettings{}, {}, {{&ball, {}, nullptr, {}, levels}, {&far, {}}}});
  scenery.scene.fields.emplace_back();
  const Json scene = liveScene(scenery, "ball").scene, &parts = scene["parts"], &scattered = scene["scattered"];
  ASSERT_EQ(parts.size(), 6U);
  for (const size_t full : {0U, 3U}) {
    const Json &part = parts[full + 2], &mesh = parts[full + 1];
    EXPECT_FALSE(parts[full].contains("impostor") || mesh.contains("impostor"));
    EXPECT_EQ(part["level"], (Json{{"of", full}, {"pixels", 20}}));
    EXPECT_EQ(part["count"], 0);
    EXPECT_EQ(part["first"], mesh["first"].get<size_t>() + mesh["count"].get<size_t>());
    EXPECT_EQ(part["first_vertex"], mesh["first_vertex"].get<size_t>() + mesh["vertices"].get<size_t>());
    EXPECT_EQ(part["vertices"], 8);
    EXPECT_EQ(part["impostor"]["picture"], 0);
  }
  const Json& impostor = parts[2]["impostor"];
  EXPECT_EQ(impostor["center"], Json({5, 1, 0}));
  EXPECT_EQ(impostor["radius"], 3);
  EXPECT_EQ(impostor["own_radius"], 1.5);
  EXPECT_EQ(impostor["atlas"], Json({2, 8, 1, 0}));
  EXPECT_EQ(impostor["extinction"], 1.5) << "per world unit";
  EXPECT_EQ(scene["mesh"]["impostors"], Json({3 * 16 * 16}));

  ASSERT_EQ(scattered["parts"].size(), 4U);
  EXPECT_EQ(scattered["parts"][2]["level"], (Json{{"of", 0}, {"pixels", 20}}));
  EXPECT_EQ(scattered["parts"][2]["impostor"]["center"], Json({0, 0.5, 0}));
  EXPECT_TRUE(scattered["parts"][3].contains("impostor")) << "a field may be of impostors";
  EXPECT_FALSE(scattered["parts"][3].contains("level"));
  EXPECT_EQ(scattered["fields"][0]["meshes"][1]["part"], 3);
  EXPECT_EQ(scattered["mesh"]["impostors"].size(), 1U);
}

// A field has its meshes once, and six numbers for each cloud.
TEST(LivePage, HoldsFields) {
  Scenery scenery = oneBall();
  const BakedMesh& ball = *scenery.instances[0].mesh;
  BakedMesh level = bakedBall(1, {}, 1);
  const BakedMesh* levels[] = {&level};
  ScatterSettings settings;
  settings.low = {-50, 3, -50}, settings.high = {50, 4, 50}, settings.count = 300, settings.drift = {1, 0, 2};
  const std::vector<double> weights{1, 1};
  scenery.fields.push_back({settings, scatterClouds(settings, weights), {{&ball, {}, nullptr, {}, levels}, {&level, {}}}});
  scenery.scene.fields.push_back({std::vector<SceneCloud>(2), weights, settings});
  Json scene = liveScene(scenery, "field").scene;
  EXPECT_EQ(scene["parts"].size(), 1U);
  EXPECT_FALSE(scene["noise"].contains("wind")) << "the noise stays with the cloud that is placed";
  EXPECT_EQ(scene["corners"].size(), 16U) << "of the cloud and of the field";
  const Json &scattered = scene["scattered"], &field = scattered["fields"][0];
  EXPECT_EQ(scattered["parts"].size(), 3U);
  EXPECT_TRUE(scattered["parts"][2].contains("copy")) << "it is the level of the other";
  EXPECT_EQ(scattered["mesh"]["vertices"], ball.surface.positions.size() + 2 * level.surface.positions.size());
  EXPECT_EQ(field["clouds"].size(), 6 * 300U);
  EXPECT_EQ(field["meshes"][0]["part"], 0);
  EXPECT_EQ(field["meshes"][1]["part"], 2) << "behind the level";
  EXPECT_EQ(field["drift"], Json({1, 0, 2}));
  EXPECT_FALSE(field["has_world_extinction"]);
  for (size_t i = 0; i < 300; ++i) {
    const ScatteredCloud& cloud = scenery.fields[0].clouds[i];
    EXPECT_NEAR(field["clouds"][6 * i].get<float>(), cloud.place.x, 1e-4);
    EXPECT_EQ(field["clouds"][6 * i + 5], cloud.mesh);
  }
  scenery.instances.clear();
  scene = liveScene(scenery, "field").scene;
  EXPECT_EQ(scene["noise"]["wind"], Json({1, 0, 2}));
  EXPECT_TRUE(scene["parts"].empty());
}

// Each cloud has steps of its own: far from the others it keeps its accuracy.
TEST(LivePage, RoundsPositionsByTheSizeOfACloud) {
  Scenery scenery = oneBall();
  const BakedMesh& ball = *scenery.instances[0].mesh;
  scenery.instances.push_back({&ball, placement({9000, 0, 0}, {}, {1, 1, 1})});
  const Json parts = liveScene(scenery, "ball").scene["parts"];
  EXPECT_NEAR(parts[0]["step"].get<double>(), 4.0 / (1 << 20), 1e-8);
  EXPECT_NEAR(parts[1]["step"].get<double>(), 2.0 / (1 << 20), 1e-8);
  EXPECT_NEAR(parts[1]["low"][0].get<double>(), 8999, 1e-2);
}

// Harmonics are whole vectors of four per vertex; a compared mesh adds its lobes.
TEST(LivePage, HoldsHarmonicsAndComparedLobes) {
  Scenery scenery = oneBall();
  const BakedMesh& ball = *scenery.instances[0].mesh;
  BakedMesh other = ball;
  other.info.lobe = "fit";
  other.info.harmonic_order = 2;
  other.harmonics.assign(9 * ball.lobes.size(), 0.5F);
  const size_t plain = meshBytes(liveScene(scenery, "ball")).size();
  scenery.compared.emplace(&ball, other);
  const LiveScene live = liveScene(scenery, "ball");
  const Json& scene = live.scene;
  EXPECT_EQ(scene["mesh"]["harmonics"], 12);
  EXPECT_TRUE(scene["mesh"].contains("compared"));
  EXPECT_EQ(scene["parts"][0]["compared"]["lobe"], "fit");
  EXPECT_EQ(meshBytes(live).size() - plain, ball.lobes.size() * 4 * (12 + 3));
  EXPECT_NEAR(scene["parts"][0]["harmonics"]["to_own"][0].get<double>(), -0.5, 1e-12);
}

// Own colours are three floats per vertex of all clouds, and a key of the scene.
TEST(LivePage, HoldsOwnColors) {
  Scenery scenery = oneBall();
  const BakedMesh& ball = *scenery.instances[0].mesh;
  BakedMesh red = ball;
  scenery.instances.push_back({&red, placement({9, 0, 0}, {}, {1, 1, 1})});
  scenery.scene.clouds.resize(2);
  const LiveScene white = liveScene(scenery, "ball");
  EXPECT_FALSE(white.scene["mesh"]["is_colored"]);
  red.colors.assign(red.lobes.size(), {1, 0.25F, 0});
  const LiveScene live = liveScene(scenery, "ball");
  EXPECT_TRUE(live.scene["mesh"]["is_colored"]);
  EXPECT_EQ(meshBytes(live).size() - meshBytes(white).size(), 2 * ball.lobes.size() * 4 * 3) << "also of the white one";
  const auto hasKey = [](const LiveScene& one) {
    const Json& keys = one.scene["keys"];
    return std::any_of(keys.begin(), keys.end(), [](const Json& key) { return key["name"] == "own_colors"; });
  };
  EXPECT_TRUE(hasKey(live));
  EXPECT_FALSE(hasKey(white));
}

// The parabola of the page through three rows is the colour at any height between.
TEST(LivePage, ColorsFollowTheSun) {
  for (const bool is_published : {false, true}) {
    const PostSettings post = is_published ? publishedPost() : PostSettings();
    const Json looks = liveScene(oneBall(), "ball").looks, table = looks[is_published ? "published" : "painted"]["colors"];
    const Json &heights = table["heights"], &ground = table["colors"]["ground"], &sun = table["colors"]["sun_color"];
    ASSERT_EQ(heights.size() % 2, 1U);
    EXPECT_EQ(heights.back(), 1);
    for (size_t low = 0; low + 2 < heights.size(); low += 2)
      for (const float t : {0.0F, 0.3F, 0.8F}) {
        const float from = heights[low], to = heights[low + 2];
        const SkyColors expected = skyColorsFor(post, from + t * (to - from));
        const auto mixed = [&](const Json& rows) {
          return (1 - t) * (1 - 2 * t) * rows[low][0].get<float>() + 4 * t * (1 - t) * rows[low + 1][0].get<float>() +
                 t * (2 * t - 1) * rows[low + 2][0].get<float>();
        };
        EXPECT_NEAR(mixed(ground), expected.ground.x, 1e-6) << from;
        EXPECT_NEAR(mixed(sun), expected.sun_color.x, 1e-6) << from;
      }
  }
}

// A colour that a scene sets is the same at every height, and ambient light follows it there.
TEST(LivePage, ColorsOfASceneStay) {
  const auto colorsOf = [](const std::string& colors) {
    Scenery scenery = oneBall();
    scenery.read = [colors](const std::optional<Moment>& moment) {
      return readSceneFile("scene", colors + "[[cloud]]\nfile = 'ball.glb'\n",
                           [&](const PictureSettings& view) { return moment ? viewAt(view, *moment) : view; });
    };
    scenery.scene = scenery.read(std::nullopt);
    return liveScene(scenery, "ball").looks["painted"]["colors"]["colors"];
  };
  const Json free = colorsOf(""), set = colorsOf("[sky.colors]\nzenith = [0.5, 0.25, 0.125]\n");
  EXPECT_NE(free["zenith"].front(), free["zenith"].back());
  for (const Json& color : set["zenith"]) EXPECT_EQ(color, Json({0.5, 0.25, 0.125}));
  for (const char* same : {"low_sky", "horizon", "sun_color"}) EXPECT_EQ(set[same], free[same]);
  for (const char* other : {"ground", "ambient_ground"}) EXPECT_NE(set[other].front(), set[other].back()) << other;
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
TEST(LivePage, NamesMayBeMarksOfTheTemplate) {
  const Scenery scenery = oneBall();
  const std::string plain = pageOf(scenery, "a plain name");
  for (const std::string name : {"@SCRIPTS@", "@NAME@", "@CONNECT@", "@NAME@@SCRIPTS@"}) {
    std::string page = pageOf(scenery, name);
    EXPECT_NE(page.find("<title>" + name + "</title>"), std::string::npos) << name;
    EXPECT_EQ(Json::parse(scriptOf(page, "page"))["scenes"][0]["name"], name);
    for (size_t at = 0; (at = page.find(name, at)) != std::string::npos;) page.replace(at, name.size(), "a plain name");
    EXPECT_EQ(page, plain) << name;
  }
}

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
  EXPECT_FALSE(refused([](SceneFile& s) { s.terrain.emplace(); }));
  EXPECT_TRUE(refused([](SceneFile& s) { s.terrain.emplace(), s.view.plain = true; }));
  EXPECT_FALSE(refused([](SceneFile& s) { s.compares_techniques = true, s.slabs.resize(1); }));
  EXPECT_FALSE(refused([](SceneFile& s) { s.compares_techniques = true, s.clouds.resize(1); }));
  EXPECT_TRUE(refused([](SceneFile& s) { s.compares_techniques = true; })) << "no cloud of the scene";
  EXPECT_FALSE(refused([](SceneFile& s) { s.slabs.resize(4), s.density_clouds.resize(4); }));
  EXPECT_TRUE(refused([](SceneFile& s) { s.slabs.resize(5), s.density_clouds.resize(4); }));
  Scenery empty;
  EXPECT_FALSE(refusalOf<UsageError>([&] { liveScene(empty, "nothing"); }).empty());
}

}  // namespace
}  // namespace cloudbake
