// The sheet of `preview --compare`, on balls, whose light is known in closed form.
#include "pipeline/picture/compare.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "io/gltf/asset/write.h"
#include "pipeline/scene/scene_file.h"
#include "preview/camera.h"
#include "preview/compare/sheet.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

constexpr int kSize = 32;

// A ball as an asset with the lobes that it must have. With `half_height` it is flattened to a needle along x, of which the truth has
// fewer cells; its lobes are then not right.
struct Compared {
  Comparison comparison;
  BakeReport report;
  std::vector<std::string> stages;
};
Compared compareBall(const AssetInfo& changes, const std::vector<std::string>& texts, const std::vector<float>& harmonics = {},
                     float half_height = 1, int width = kSize, int height = kSize) {
  const BakedMesh ball = bakedBall(1, {}, half_height < 1 ? 2 : 4);
  AssetInfo info = ball.info;
  info.lobe = changes.lobe;
  info.sun_arc = changes.sun_arc;
  info.volume = changes.volume;
  info.harmonic_order = changes.harmonic_order;
  std::vector<float> coefficients;
  for (size_t v = 0; v < ball.lobes.size(); ++v) coefficients.insert(coefficients.end(), harmonics.begin(), harmonics.end());
  Sculpt sculpt;
  sculpt.parts = {partOf(ball.surface, "ball", 0, placement({}, {}, {1, half_height, half_height}))};
  const std::vector<std::vector<Lobe>> lobes_per_part{ball.lobes};
  Warnings warnings;
  const TestFolder folder;
  const auto file = folder.write("ball.glb", encodeGlb(sculpt, lobes_per_part, info, {}, warnings, coefficients));
  std::vector<std::string> all = texts;
  all.insert(all.end(), {"compare", "size=" + std::to_string(2 * width) + "x" + std::to_string(2 * height)});
  Compared c;
  Stopwatch watch([&](const std::string& stage) { c.stages.push_back(stage); });
  c.comparison = compareAsset(resolve(sourceOf(SourceKind::kSculpt, file), options(all, kPreview)), c.report, watch);
  return c;
}
const Compared& plain() {
  static const Compared compared = compareBall({}, {"sun=50,20", "camera=0,0"});
  return compared;
}
const Compared& withSuns() {
  static const Compared compared = [] {
    AssetInfo info;
    info.lobe = "fit";
    info.sun_arc = SunArc{};
    info.sun_arc->azimuth_low_degrees = 60, info.sun_arc->azimuth_high_degrees = 120;
    info.sun_arc->elevation_low_degrees = 10, info.sun_arc->elevation_high_degrees = 40;
    info.harmonic_order = 1;
    // Y₀ of this weight is T = 0.5 in every direction.
    return compareBall(info, {"suns=3"}, {0.5F * 3.5449077F, 0, 0, 0}, 0.2F);
  }();
  return compared;
}

std::vector<std::string> picturesOf(const SunComparison& sun) {
  std::vector<std::string> names;
  for (const ComparedPicture& picture : sun.pictures) names.push_back(picture.name);
  return names;
}
std::vector<std::string> modelsOf(const SunComparison& sun) {
  std::vector<std::string> names;
  for (const auto& [name, rms] : sun.surface_rms) names.push_back(name);
  return names;
}

TEST(Compare, SevenPictures) {
  const SunComparison& sun = plain().comparison.sun;
  EXPECT_EQ(picturesOf(sun), (std::vector<std::string>{"volume", "truth", "exact T", "mean lobe", "Lambert", "lobe + Lambert", "painted"}));
  EXPECT_EQ(modelsOf(sun), (std::vector<std::string>{"mean lobe", "half-Lambert", "Lambert"}));
  EXPECT_NEAR(sun.azimuth_degrees, 50, 1e-3);
  EXPECT_NEAR(sun.elevation_degrees, 20, 1e-3);
  EXPECT_TRUE(plain().comparison.suns.empty());
}

// The volume and the truth are each compared with both, and with themselves they agree.
TEST(Compare, ErrorsToVolumeAndTruth) {
  const std::vector<ComparedPicture>& pictures = plain().comparison.sun.pictures;
  for (size_t i = 0; i < pictures.size(); ++i) {
    const auto& [name, to_truth, to_volume, spread] = pictures[i];
    EXPECT_GT(spread, 0) << name;
    EXPECT_EQ(to_volume.rms == 0, i == 0) << name;
    EXPECT_EQ(to_truth.rms == 0, i == 1) << name;
    EXPECT_EQ(std::isinf(to_truth.psnr), i == 1) << name;
    EXPECT_EQ(to_truth.ssim == 1, i == 1) << name;
    if (i != 1) {
      EXPECT_NEAR(to_truth.psnr, -20 * std::log10(to_truth.rms), 1e-3) << name;
    }
  }
  EXPECT_DOUBLE_EQ(pictures[0].to_truth.rms, pictures[1].to_volume.rms);
  EXPECT_LT(plain().comparison.sun.surface_rms[0].second, plain().comparison.sun.surface_rms[2].second)
      << "the lobe is nearer than Lambert";
  EXPECT_LT(pictures[1].to_volume.rms, 0.3 * pictures[2].to_volume.rms) << "two marches are nearer than the light at the surface";
}

// Light that is scattered again fills the volume's shadows: it is brighter, and less of it is shade.
TEST(Compare, OctavesFillTheVolumesShadows) {
  const std::vector<ComparedPicture>& once = plain().comparison.sun.pictures;
  const std::vector<ComparedPicture> often = compareBall({}, {"sun=50,20", "camera=0,0", "octaves=6"}).comparison.sun.pictures;
  EXPECT_LT(often[0].luminance_spread, 0.8 * once[0].luminance_spread);
  for (size_t i = 1; i < once.size(); ++i) EXPECT_NE(often[i].to_volume.rms, once[i].to_volume.rms) << once[i].name;
}

// The volume is the one that the lobes were fitted to, unless another is asked for.
TEST(Compare, TheVolumeIsThatOfTheFit) {
  AssetInfo fitted;
  fitted.lobe = "fit";
  fitted.volume = VolumeLight{0.5F, {6}, 0.3F};
  const auto volumeOf = [](const AssetInfo& info, std::vector<std::string> texts) {
    texts.insert(texts.end(), {"sun=50,20", "camera=0,0"});
    const ComparedPicture volume = compareBall(info, texts, {}, 1, kSize / 2, kSize / 2).comparison.sun.pictures[0];
    return std::pair(volume.luminance_spread, volume.to_truth.rms);
  };
  const auto as_fitted = volumeOf(fitted, {}), asked = volumeOf({}, {"view-extinction=0.5", "octaves=6", "phase=0.3"});
  EXPECT_EQ(as_fitted, asked);
  EXPECT_NE(as_fitted, volumeOf({}, {}));
  for (const char* other : {"view-extinction=1", "octaves=0", "phase=0"}) EXPECT_NE(volumeOf(fitted, {other}), as_fitted) << other;
}

// On a ball ℓ towards the sun is −2R n·l where the sun is behind, and 0 where it is before: T is known at every pixel that a ray meets.
TEST(Compare, SurfaceErrorsOfABall) {
  const Vec3 to_sun = directionFromAngles(50, 20);
  const Camera camera = frameCamera({{-1, -1, -1}, {1, 1, 1}}, 0, 0, 35, kSize, kSize);
  double lambert = 0, half_lambert = 0;
  int count = 0;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const Ray ray = cameraRay(camera, float(x) + 0.5F, float(y) + 0.5F);
      const double b = dot(ray.origin, ray.direction), c = double(dot(ray.origin, ray.origin)) - 1, square = b * b - c;
      if (square <= 0) continue;
      const Vec3 n = ray.origin + ray.direction * float(-b - std::sqrt(square));
      const double cosine = dot(n, to_sun), truth = std::exp(-3.5 * std::max(0.0, -2 * cosine));
      lambert += std::pow(std::max(0.0, cosine) - truth, 2);
      half_lambert += std::pow(0.5 * cosine + 0.5 - truth, 2);
      ++count;
    }
  const SunComparison& sun = plain().comparison.sun;
  EXPECT_NEAR(sun.surface_rms[1].second, std::sqrt(half_lambert / count), 0.02);
  EXPECT_NEAR(sun.surface_rms[2].second, std::sqrt(lambert / count), 0.02);
  EXPECT_GT(sun.surface_rms[0].second, 0);
}

// Two blocks of four columns: pictures, and below them their errors. The last block has a panel less.
TEST(Compare, TheSheetHoldsTwoBlocksOfPanels) {
  const Image& sheet = plain().comparison.sheet;
  EXPECT_GT(sheet.width, 4 * kSize);
  EXPECT_GT(sheet.height, 4 * kSize);
  EXPECT_EQ(sheet.pixels.size(), size_t(sheet.width) * size_t(sheet.height));
  for (int block = 0; block < 2; ++block)
    for (int column = 0; column < 4; ++column) {
      std::set<float> tones;
      for (int y = sheet.height * block / 2; y < sheet.height * (block + 1) / 2; ++y)
        for (int x = sheet.width * column / 4; x < sheet.width * (column + 1) / 4; ++x) tones.insert(sheet.at(x, y).x);
      if (block == 1 && column == 3)
        EXPECT_EQ(tones.size(), 1U);
      else
        EXPECT_GT(tones.size(), 10U) << block << ' ' << column;
    }
}

// The widest word of a caption is narrower than these panels.
TEST(Compare, PanelsAreHalfAsLargeAsThePicture) {
  const Image low = compareBall({}, {}, {}, 0.5, 100, 8).comparison.sheet, high = compareBall({}, {}, {}, 0.5, 100, 16).comparison.sheet;
  EXPECT_EQ(low.width, 4 * 100 + 5 * SheetSettings().gap);
  EXPECT_EQ(high.width, low.width);
  EXPECT_EQ(high.height, low.height + 4 * 8);
}

TEST(Compare, RecordsTheAsset) {
  const BakeReport& report = plain().report;
  EXPECT_EQ(report.vertices, 2562U);
  EXPECT_EQ(report.triangles, 5120U);
  EXPECT_EQ(report.info.extinction, 3.5F);
  EXPECT_TRUE(report.input.ends_with("ball.glb"));
  EXPECT_EQ(plain().stages.back(), "render");
  EXPECT_EQ(withSuns().stages.back(), "suns");
}

// A fitted asset is set beside the mean lobe too, and harmonics have a panel of their own.
TEST(Compare, FitsHarmonicsAndSuns) {
  const Comparison& c = withSuns().comparison;
  EXPECT_EQ(picturesOf(c.sun), (std::vector<std::string>{"volume", "truth", "exact T", "fitted lobe", "mean lobe", "Lambert",
                                                         "lobe + Lambert", "harmonics", "painted"}));
  EXPECT_EQ(modelsOf(c.sun), (std::vector<std::string>{"fitted lobe", "mean lobe", "harmonics", "half-Lambert", "Lambert"}));
  EXPECT_EQ(c.suns.size(), 3U);
  for (const SunComparison& sun : c.suns) {
    EXPECT_GE(sun.azimuth_degrees, 60 - 0.01);
    EXPECT_LE(sun.azimuth_degrees, 120 + 0.01);
    EXPECT_GE(sun.elevation_degrees, 10 - 0.01);
    EXPECT_LE(sun.elevation_degrees, 40 + 0.01);
    EXPECT_EQ(picturesOf(sun), picturesOf(c.sun));
    EXPECT_EQ(modelsOf(sun), modelsOf(c.sun));
    // The truth is between 0 and 1, so that T = 0.5 is at most 0.5 off.
    EXPECT_GT(sun.surface_rms[2].second, 0.1);
    EXPECT_LE(sun.surface_rms[2].second, 0.5);
  }
}

TEST(Compare, OnlyAssetsCanBeCompared) {
  const TestFolder folder;
  BakeReport report;
  Stopwatch watch;
  const Settings settings = resolve(sourceOf(SourceKind::kSculpt, folder.write("a.glb", "no glTF at all")), options({"compare"}, kPreview));
  EXPECT_FALSE(refusalOf<InputError>([&] { compareAsset(settings, report, watch); }).empty());
}

// --- The figures as text and JSON ---

SunComparison sunOf(double rms, double other) {
  SunComparison sun;
  sun.azimuth_degrees = 45, sun.elevation_degrees = 30;
  sun.pictures = {{"truth", {0, INFINITY, 1}, {rms, 20, 0.5}, 0.25}, {"lobe", {rms, 12.5, 0.25}, {2 * rms, 6, 0.125}, 0.5}};
  sun.surface_rms = {{"mean lobe", rms}, {"Lambert", other}};
  return sun;
}
Comparison fourSuns() {
  Comparison c;
  c.sun = sunOf(0.125, 0.5);
  c.suns = {sunOf(0.125, 0.5), sunOf(0.5, 0.25), sunOf(0.25, 0.5), sunOf(0.0625, 0.25)};
  return c;
}

TEST(ComparisonText, OneSun) {
  Comparison c;
  c.sun = sunOf(0.125, 0.5);
  const std::string text = comparisonText(c);
  EXPECT_TRUE(contains(text, "truth            to the truth: the same ")) << text;
  EXPECT_TRUE(contains(text, "to the volume: rms 0.125, 20.0 dB, SSIM 0.500       spread 0.250\n")) << text;
  EXPECT_TRUE(contains(text, "lobe             to the truth: rms 0.125, 12.5 dB, SSIM 0.250 ")) << text;
  EXPECT_TRUE(contains(text, "rms 0.1250 of the mean lobe\n")) << text;
  EXPECT_TRUE(contains(text, "rms 0.5000 of the Lambert\n")) << text;
  EXPECT_FALSE(contains(text, "suns")) << text;
}

// Of 0.0625, 0.125, 0.25 and 0.5 the median is 0.1875. The ratios are 0.25, 2, 0.5 and 0.25: median 0.375, worst 2.
TEST(ComparisonText, MedianAndWorstOfTheSuns) {
  const std::string text = comparisonText(fourSuns());
  EXPECT_TRUE(contains(text, "4: median and worst rms\n")) << text;
  EXPECT_TRUE(contains(text, "to the truth 0.1875, 0.5000   to the volume 0.3750, 1.0000\n")) << text;
  EXPECT_TRUE(contains(text, "0.1875, 0.5000 of the mean lobe\n")) << text;
  EXPECT_TRUE(contains(text, "0.3750, 0.5000 of the Lambert\n")) << text;
  EXPECT_TRUE(contains(text, "ratio of the mean lobe's rms to it: median 0.375, worst 2.000\n")) << text;
  Comparison odd = fourSuns();
  odd.suns.pop_back();
  EXPECT_TRUE(contains(comparisonText(odd), "0.2500, 0.5000 of the mean lobe\n")) << comparisonText(odd);
}

TEST(ComparisonJson, EverySun) {
  const Json json = comparisonJson(fourSuns());
  EXPECT_EQ(json["azimuth"], 45);
  EXPECT_EQ(json["elevation"], 30);
  ASSERT_EQ(json["pictures"].size(), 2U);
  EXPECT_EQ(json["pictures"][0]["name"], "truth");
  EXPECT_TRUE(json["pictures"][0]["to_truth"]["psnr"].is_null()) << "JSON has no infinity";
  EXPECT_EQ(json["pictures"][1]["to_truth"], (Json{{"rms", 0.125}, {"psnr", 12.5}, {"ssim", 0.25}}));
  EXPECT_EQ(json["pictures"][1]["to_volume"], (Json{{"rms", 0.25}, {"psnr", 6.0}, {"ssim", 0.125}}));
  EXPECT_EQ(json["pictures"][1]["luminance_spread"], 0.5);
  EXPECT_EQ(json["surface_transmittance_rms"], (Json{{"mean lobe", 0.125}, {"Lambert", 0.5}}));
  ASSERT_EQ(json["suns"].size(), 4U);
  EXPECT_EQ(json["suns"][1]["surface_transmittance_rms"]["mean lobe"], 0.5);
  EXPECT_FALSE(comparisonJson(Comparison{}).contains("suns"));
}

}  // namespace
}  // namespace cloudbake
