// The pictures of `preview`: sizes, the files beside them, motion, and what is refused.
#include "pipeline/picture/picture.h"

#include "io/gltf/sequence/sequence_file.h"
#include "io/image/image.h"
#include "pipeline/asset/asset.h"
#include "pipeline/sources/sculpt.h"
#include "tests/io/io_helpers.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;

// A baked ball at out.glb. `material`: lines of its OBJ.
fs::path ballAsset(const TestFolder& folder, const std::string& material = "") {
  Settings settings = settingsFor({"rays=16", "voxels=16", "units=1", "up=y"}, SourceKind::kSculpt,
                                  folder.write("ball.obj", material + objText(ballMesh(1, 2))));
  settings.output.file = folder.path / "out.glb";
  BakeReport report;
  Stopwatch watch;
  writeAsset(readSculpt(settings, report, watch), settings, report, watch);
  return settings.output.file;
}

struct NamedFile {
  fs::path file;
  std::string bytes;
};

struct DrawnAsset {
  struct {
    std::string png;
    std::vector<NamedFile> beside;
  } pictures;
  BakeReport report;
};

void draw(const Scenery& scenery, DrawnAsset& drawn) {
  Stopwatch watch;
  const PictureSink sink{[&](std::string_view bytes) { drawn.pictures.png += bytes; },
                         [&](const fs::path& file, std::string_view bytes) {
                           drawn.pictures.beside.push_back({file, std::string(bytes)});
                         }};
  drawPictures(scenery, sink, drawn.report, watch);
}

DrawnAsset drawAsset(const fs::path& asset, std::vector<std::string> texts) {
  texts.insert(texts.end(), {"size=48x32"});
  const std::vector<Given> given = options(texts, kPreview);
  const Settings settings = resolve(sourceOf(SourceKind::kSculpt, asset), given);
  DrawnAsset drawn;
  const Scenery scenery = readScenery(settings, given, drawn.report);
  draw(scenery, drawn);
  return drawn;
}

Image decoded(const std::string& png) { return decodePng(png, "test.png"); }

double brightness(const Image& image, int from_column, int to_column) {
  double sum = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = from_column; x < to_column; ++x) {
      const Vec3 c = image.pixels[size_t(y) * size_t(image.width) + size_t(x)];
      sum += double(c.x) + c.y + c.z;
    }
  return sum;
}

TEST(Picture, HasTheSizeAndTheLightThatWereAskedFor) {
  const TestFolder folder;
  const fs::path asset = ballAsset(folder);
  const DrawnAsset right = drawAsset(asset, {"look=plain", "sun=90,0"}), left = drawAsset(asset, {"look=plain", "sun=-90,0"});
  const Image from_right = decoded(right.pictures.png), from_left = decoded(left.pictures.png);
  ASSERT_EQ(from_right.width, 48);
  ASSERT_EQ(from_right.height, 32);
  EXPECT_GT(brightness(from_right, 24, 48), brightness(from_right, 0, 24));
  EXPECT_LT(brightness(from_left, 24, 48), brightness(from_left, 0, 24));
  EXPECT_EQ(right.report.vertices, ballMesh(1, 2).positions.size());
  EXPECT_TRUE(right.pictures.beside.empty());
}

TEST(Picture, WhatIsWatchedIsBakedUnlessItIsAnAsset) {
  const TestFolder folder;
  const fs::path asset = ballAsset(folder);
  const auto bake = [](const fs::path& file, const std::vector<std::string>& texts, BakeReport& report) {
    const std::vector<Given> given = options(texts, kView);
    return bakeScenery(resolve(sourceOf(sourceKindOf(file), file), given), given, report);
  };
  BakeReport of_sculpt, of_asset, of_recipe;
  const Scenery sculpt = bake(folder.path / "ball.obj", {"rays=36", "voxels=16", "units=1", "up=y", "sun=10,20", "look=plain"}, of_sculpt);
  const Scenery baked = bake(asset, {"sun=10,20", "look=plain"}, of_asset);
  const Scenery recipe = bake(folder.write("c.toml", "premise='F'\nrules='F=F'\n[bake]\nrays=16\nvoxels=16\n"), {"rays=36"}, of_recipe);
  EXPECT_EQ(of_sculpt.info.rays, 36);
  EXPECT_EQ(of_asset.info.rays, 16);
  EXPECT_EQ(of_recipe.info.rays, 36) << "an option overrides the recipe";
  for (const BakeReport* report : {&of_sculpt, &of_asset}) EXPECT_EQ(report->vertices, ballMesh(1, 2).positions.size());
  ASSERT_EQ(sculpt.instances.size(), 1U);
  EXPECT_EQ(sculpt.instances[0].mesh->lobes.size(), baked.instances.at(0).mesh->lobes.size());
  EXPECT_EQ(sculpt.scene.view.sun_azimuth_degrees, 10);
  EXPECT_EQ(sculpt.scene.light.sky.to_sun.x, baked.scene.light.sky.to_sun.x);
  BakeReport report;
  expectError<UsageError>([&] { bake(asset, {"sun=10,20", "rays=36"}, report); }, "--rays: " + asset.string() + " is baked already");
}

// The material of a sculpt goes from its file through the bake to the picture.
TEST(Picture, HasTheColorsOfTheSculpt) {
  const TestFolder folder;
  const Vec3 white = decoded(drawAsset(ballAsset(folder), {}).pictures.png).at(24, 16);
  EXPECT_GT(white.y, 0.8F * white.x);
  folder.write("red.mtl", "newmtl red\nKd 1 0 0\n");
  const fs::path asset = ballAsset(folder, "mtllib red.mtl\nusemtl red\n");
  for (const char* look : {"painted", "plain"}) {
    const Vec3 red = decoded(drawAsset(asset, {std::string("look=") + look}).pictures.png).at(24, 16);
    EXPECT_GT(red.x, 0.3F) << look;
    EXPECT_LT(red.y, 0.5F * red.x) << look << ": only the fog is not red";
  }
  const std::vector<Given> given = options({"rays=16", "voxels=16", "units=1", "up=y"}, kView);
  BakeReport report;
  const Scenery watched = bakeScenery(resolve(sourceOf(SourceKind::kSculpt, folder.path / "ball.obj"), given), given, report);
  EXPECT_EQ(watched.instances.at(0).mesh->colors, std::vector<Vec3>(watched.instances[0].mesh->lobes.size(), {1, 0, 0}));
}

TEST(Picture, ChannelsAndStepsAreFilesBesideIt) {
  const TestFolder folder;
  const DrawnAsset drawn = drawAsset(ballAsset(folder), {"channels=c", "steps=s"});
  std::string names;
  for (const NamedFile& file : drawn.pictures.beside) {
    names += file.file.string() + " ";
    EXPECT_EQ(decoded(file.bytes).width, 48) << file.file;
  }
  EXPECT_EQ(names,
            "c_sun.png c_sky.png c_opacity.png c_depth.png s_1_drawn.png s_2_depth_spread.png s_3_softened.png s_4_distorted.png "
            "s_5_eroded.png ");
  const DrawnAsset floats = drawAsset(folder.path / "out.glb", {"channels=c.exr"});
  ASSERT_EQ(floats.pictures.beside.size(), 1U);
  EXPECT_TRUE(floats.pictures.beside[0].bytes.starts_with("\x76\x2f\x31\x01")) << "the magic number of OpenEXR";
}

TEST(Picture, FramesOfATurnAreNumberedFromOne) {
  const TestFolder folder;
  const DrawnAsset drawn = drawAsset(ballAsset(folder), {"turntable=3", "frames=f", "look=plain"});
  ASSERT_EQ(drawn.pictures.beside.size(), 3U);
  EXPECT_EQ(drawn.pictures.beside[0].file, "f_0001.png");
  EXPECT_EQ(drawn.pictures.beside[2].file, "f_0003.png");
  EXPECT_NE(drawn.pictures.png.find("acTL"), std::string::npos) << "the chunk of an animation";
}

TEST(Picture, MotionBeginsAtTheStartOfAScene) {
  const TestFolder folder;
  const fs::path scene =
      folder.write("s.toml", "[picture]\ntime = 5\nstart = 30\n[camera]\nposition = [0, 0, 9]\ntarget = [0, 0, 0]\n[[slab]]\n");
  const auto timeOf = [&](std::vector<std::string> words, bool is_live) {
    words.push_back("scene=" + scene.string());
    const std::vector<Given> given = options(words, kPreview);
    Settings settings = resolve({}, given);
    settings.picture.is_live = is_live;
    BakeReport report;
    const Scenery scenery = readScenery(settings, given, report);
    return filmOf(scenery.scene, false).moments.empty() ? scenery.scene.view.time_seconds
                                                        : filmOf(scenery.scene, false).moments.front().time_seconds;
  };
  EXPECT_EQ(timeOf({}, false), 5) << "a still";
  EXPECT_EQ(timeOf({"animate=3"}, false), 30);
  EXPECT_EQ(timeOf({"turntable=3"}, false), 30);
  EXPECT_EQ(timeOf({"animate=3", "time=7"}, false), 7) << "a time that is asked for";
  EXPECT_EQ(timeOf({}, true), 30) << "the page of view";
}

// A ball that grows from 1 to 2 in its first second, and fades to a ball of 1 during the next.
fs::path growingBall(const TestFolder& folder) {
  const auto keyOf = [](double frame, float radius) {
    const BakedMesh ball = bakedBall(radius, {}, 3);
    return SequenceKey{frame, ball.surface.positions, ball.surface.normals, ball.lobes};
  };
  CloudSequence sequence;
  sequence.info = bakedBall().info;
  sequence.frames_per_second = 10;
  sequence.period = 30;
  const std::vector<Triangle> triangles = bakedBall(1, {}, 3).surface.triangles;
  sequence.segments = {{triangles, {keyOf(0, 1), keyOf(10, 2), keyOf(20, 2)}}, {triangles, {keyOf(10, 1), keyOf(30, 1)}}};
  return folder.write("grows.glb", encodeSequence(sequence, SequenceForm::kMorph));
}

TEST(Picture, ShowsACloudThatChangesAtItsTime) {
  const TestFolder folder;
  const fs::path file = growingBall(folder);
  const auto differenceOf = [](const Image& a, const Image& b) {
    double sum = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) sum += double(length(a.pixels[i] - b.pixels[i]));
    return sum / double(a.pixels.size());
  };
  const auto at = [&](const char* look, const char* time) {
    return decoded(drawAsset(file, {std::string("look=") + look, std::string("time=") + time}).pictures.png);
  };
  const Image begins = at("plain", "0"), grown = at("plain", "1"), small = at("plain", "2");
  EXPECT_GT(differenceOf(begins, grown), 0.02);
  EXPECT_LT(differenceOf(begins, small), 1e-3) << "the camera is the same at all times";
  EXPECT_EQ(at("plain", "9").pixels, small.pixels) << "it stays as it ends";
  Image half = grown;
  for (size_t i = 0; i < half.pixels.size(); ++i) half.pixels[i] = (grown.pixels[i] + small.pixels[i]) * 0.5F;
  EXPECT_LT(differenceOf(at("plain", "1.5"), half), 1.5 / 255) << "halfway through a fade";
  EXPECT_GT(differenceOf(at("painted", "0"), at("painted", "1")), 0.02);

  const std::vector<Given> given = options({"animate=3", "look=plain"}, kPreview);
  BakeReport report;
  const Scenery scenery = readScenery(resolve(sourceOf(SourceKind::kSculpt, file), given), given, report);
  EXPECT_EQ(filmOf(scenery.scene, true, true).moving.back(), "clouds that change");
  Settings live = resolve(sourceOf(SourceKind::kSculpt, file), {});
  live.picture.is_live = live.picture.compare = true;
  EXPECT_TRUE(contains(refusalOf<UsageError>([&] { readScenery(live, {}, report); }), "a sequence has none"));
}

TEST(Picture, ADaySunRisesAndSetsBelowTheHorizon) {
  const TestFolder folder;
  const DrawnAsset drawn = drawAsset(ballAsset(folder), {"sun-sweep=3", "frames=f", "look=plain", "sun=0,60"});
  ASSERT_EQ(drawn.pictures.beside.size(), 3U);
  const double morning = brightness(decoded(drawn.pictures.beside[0].bytes), 0, 48),
               noon = brightness(decoded(drawn.pictures.beside[1].bytes), 0, 48),
               evening = brightness(decoded(drawn.pictures.beside[2].bytes), 0, 48);
  EXPECT_GT(noon, 1.2 * morning);
  EXPECT_GT(noon, 1.2 * evening);
  for (const std::string low : {"sun=-90,0", "sun=90,0"})
    EXPECT_LT(std::max(morning, evening), brightness(decoded(drawAsset(folder.path / "out.glb", {"look=plain", low}).pictures.png), 0, 48))
        << low;
}

TEST(Picture, ASceneWithoutMeshCloudsHasNoChannels) {
  const TestFolder folder;
  const fs::path scene = folder.write("s.toml", "[camera]\nposition = [0, 0, 9]\ntarget = [0, 0, 0]\n[[slab]]\n");
  EXPECT_TRUE(contains(refusalOf<UsageError>([&] {
                         drawAsset({}, {"scene=" + scene.string(), "channels=c", "quality=draft"});
                       }),
                       "--channels and --steps show mesh clouds"));
}

// --- Levels of detail ---

// A baked ball of 2562 vertices with levels of 1800 and 900 at ball.glb.
BakeReport leveledBall(const TestFolder& folder) {
  Settings settings = settingsFor({"rays=32", "voxels=24", "units=1", "up=y", "lods=1800,900", "lobe=mean"}, SourceKind::kSculpt,
                                  folder.write("ball.obj", objText(ballMesh(1, 4))));
  settings.output.file = folder.path / "ball.glb";
  BakeReport report;
  Stopwatch watch;
  writeAsset(readSculpt(settings, report, watch), settings, report, watch);
  return report;
}

// A scene of one cloud, in which the longest side of the ball, 2 units, covers so many pixels.
DrawnAsset drawLeveled(const TestFolder& folder, const std::string& cloud, double pixels) {
  const double tangent = std::tan(35 * kPi / 360), distance = 1 + 2 * 320 / (2 * tangent * pixels);
  const fs::path scene = folder.write("scene.toml", "[picture]\nwidth = 48\nheight = 320\n[camera]\nposition = [0, 0, " +
                                                        std::to_string(distance) + "]\ntarget = [0, 0, 0]\n[[cloud]]\n" + cloud);
  const std::vector<Given> given = options({"scene=" + scene.string()}, kPreview);
  const Settings settings = resolve({}, given);
  DrawnAsset drawn;
  const Scenery scenery = readScenery(settings, given, drawn.report);
  draw(scenery, drawn);
  return drawn;
}

TEST(PictureLevels, EachIsDrawnAsAnAssetOfItsOwn) {
  const TestFolder folder;
  leveledBall(folder);
  const DrawnAsset full = drawAsset(folder.path / "ball.glb", {"look=plain"});
  for (const auto& [name, vertices] : {std::pair("ball_lod1.glb", 1800U), std::pair("ball_lod2.glb", 900U)}) {
    const DrawnAsset level = drawAsset(folder.path / name, {"look=plain"});
    EXPECT_EQ(level.report.vertices, vertices);
    EXPECT_NE(level.pictures.png, full.pictures.png);
    EXPECT_NEAR(brightness(decoded(level.pictures.png), 0, 48) / brightness(decoded(full.pictures.png), 0, 48), 1, 0.03) << name;
  }
}

TEST(PictureLevels, ASceneDrawsTheLevelOfItsDistance) {
  const TestFolder folder;
  const BakeReport report = leveledBall(folder);
  ASSERT_EQ(report.levels.size(), 2U);
  const double first = report.levels[0].switch_pixels, second = report.levels[1].switch_pixels;
  ASSERT_GT(first, 1.2 * second);
  ASSERT_GT(second, 0);
  const struct {
    double pixels;
    uint64_t vertices;
    std::string file;
  } cases[] = {{1.03 * first, 2562, "ball.glb"},
               {0.97 * first, 1800, "ball_lod1.glb"},
               {1.03 * second, 1800, "ball_lod1.glb"},
               {0.97 * second, 900, "ball_lod2.glb"}};
  for (const auto& one : cases) {
    const DrawnAsset drawn = drawLeveled(folder, "file = 'ball.glb'\nlevels = true\n", one.pixels);
    EXPECT_EQ(drawn.report.vertices, one.vertices) << one.pixels;
    EXPECT_EQ(drawn.pictures.png, drawLeveled(folder, "file = '" + one.file + "'\n", one.pixels).pictures.png) << one.pixels;
    EXPECT_EQ(drawLeveled(folder, "file = 'ball.glb'\n", one.pixels).report.vertices, 2562U) << "without the key";
  }
}

TEST(PictureLevels, OfAnotherAssetAreRefused) {
  const TestFolder folder;
  leveledBall(folder);
  const std::string key = "levels = true\n", ball = "file = 'ball.glb'\n" + key;
  const auto refusal = [&](const std::string& cloud) { return refusalOf([&] { drawLeveled(folder, cloud, 100); }); };
  EXPECT_TRUE(contains(refusal("preset = 'hero'\n" + key), "'levels' belongs to a file"));
  EXPECT_TRUE(contains(refusal("file = 'ball_lod2.glb'\n" + key), "there is no ball_lod2_lod1.glb beside it"));
  fs::copy_file(folder.path / "ball_lod2.glb", folder.path / "ball_lod1.glb", fs::copy_options::overwrite_existing);
  EXPECT_TRUE(contains(refusal(ball), "ball_lod1.glb: this is not level 1 of "));
}

// A level is lit with the constants of the full asset. One of another bake of the same sculpt has others.
TEST(PictureLevels, OfAnotherBakeAreRefused) {
  const TestFolder folder;
  leveledBall(folder);
  const fs::path level = folder.path / "ball_lod1.glb";
  const std::string right = readFileBytes(level), scene = "file = 'ball.glb'\nlevels = true\n";
  // Replaces a value of the metadata by one of the same length.
  const auto refusal = [&](const std::string& before, const std::string& after) {
    std::string changed = right;
    EXPECT_NE(changed.find(before), std::string::npos) << before;
    EXPECT_EQ(before.size(), after.size());
    writeFileAtomically(level, changed.replace(changed.find(before), before.size(), after));
    return refusalOf([&] { drawLeveled(folder, scene, 100); });
  };
  EXPECT_EQ(refusal("\"seed\":1", "\"seed\":1"), "") << "the level itself";
  const std::string of = ", but that of " + (folder.path / "ball.glb").string() + " is ",
                    cure = ": bake both again with --lods, or leave out levels = true";
  EXPECT_TRUE(contains(refusal("\"lobe\":\"mean\"", "\"lobe\":\"fit\" "), "ball_lod1.glb: its lobe is fit" + of + "mean" + cure));
  EXPECT_TRUE(contains(refusal("\"exponent\":3.0", "\"exponent\":4.0"), "its exponent is 4" + of + "3" + cure));
  EXPECT_TRUE(contains(refusal("\"extinction\":3.5", "\"extinction\":4.5"), "its extinction is 4.5" + of + "3.5" + cure));
  EXPECT_TRUE(contains(refusal("\"bias\":-0.006", "\"bias\":-0.007"), "its bias is -0.007" + of + "-0.006" + cure));
}

}  // namespace
}  // namespace cloudbake
