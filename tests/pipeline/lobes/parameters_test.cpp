// What settings come to for one shape, against docs/lobe_math.md: L is the diagonal, σ = 7 / longest side, b a share of it.
#include "pipeline/lobes/parameters.h"

#include <nlohmann/json.hpp>

#include "io/gltf/asset_info.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/pipeline/settings_text.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

// Longest side 3.5, diagonal 4.5.
const Cloud& boxCloud() {
  static const Cloud cloud = cloudOf(boxMesh({1, 1, 1}, {4.5F, 3, 3}));
  return cloud;
}
const float kDiagonal = std::sqrt(3.5F * 3.5F + 8);

BakeParameters parametersOf(const std::vector<std::string>& texts) { return parametersFor(boxCloud(), settingsFor(texts)); }

std::string refusalOfBox(Vec3 low, Vec3 high) {
  try {
    requireUsableSize(Box{low, high});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// σ = 7 / longest side would be infinite, or 0.
TEST(Parameters, SizesThatCannotBeBakedAreRefused) {
  EXPECT_EQ(refusalOfBox({0, 0, 0}, {1e-37F, 0, 0}), "");
  EXPECT_EQ(refusalOfBox({-9e36F, 0, 0}, {1e36F, 1, 1}), "");
  EXPECT_EQ(refusalOfBox({0, 0, 0}, {0, 9e-38F, 0}),
            "the shape is 9e-38 units long, but sizes from 1e-37 to 1e+37 can be baked: scale it, or give "
            "another --units");
  EXPECT_NE(refusalOfBox({0, 0, 0}, {0, 1e-40F, 0}).find("sizes from 1e-37 to 1e+37 can be baked"), std::string::npos) << "denormal";
  EXPECT_EQ(refusalOfBox({0, 0, 0}, {2e37F, 1, 1}),
            "the shape is 2e+37 units long, but sizes from 1e-37 to 1e+37 can be baked: scale it, or give "
            "another --units");
  EXPECT_NE(refusalOfBox({-3e38F, 0, 0}, {3e38F, 1, 1}).find("the shape is inf units long"), std::string::npos);
  EXPECT_EQ(refusalOfBox({2e37F, 0, 0}, {2.1e37F, 1, 1}),
            "a coordinate is 2.1e+37, but they may be up to 1e+37: move the shape to the origin");
  EXPECT_EQ(refusalOfBox({5, 5, 5}, {5, 5, 5}), "") << "a point has an error of its own";
}

TEST(Parameters, DefaultsOfAMeanLobe) {
  const BakeParameters p = parametersOf({"lobe=mean"});
  EXPECT_FLOAT_EQ(*p.bake.ray_length, kDiagonal);
  EXPECT_FLOAT_EQ(p.extinction, 2);
  EXPECT_EQ(p.extinction_low, 0);
  EXPECT_EQ(p.extinction_high, 0);
  EXPECT_EQ(p.shape.exponent, 3);
  EXPECT_FLOAT_EQ(p.shape.bias, -0.003F * 3.5F);
  EXPECT_FALSE(p.bake_voxels || p.target);
  EXPECT_EQ(p.bake.rays, 100);
}

TEST(Parameters, DefaultsOfAFit) {
  const BakeParameters p = parametersOf({"lobe=fit"});
  EXPECT_FLOAT_EQ(p.extinction, 2);
  EXPECT_FLOAT_EQ(p.extinction_low, 1);
  EXPECT_FLOAT_EQ(p.extinction_high, 4);
  EXPECT_EQ(p.shape.exponent, 4);
  EXPECT_EQ(p.shape.bias, 0);
}

TEST(Parameters, WhatIsGivenIsTaken) {
  const BakeParameters p =
      parametersOf({"ray-length=10", "extinction=5", "exponent=2", "bias=-0.01", "bake-voxels=40", "rays=36", "seed=3"});
  EXPECT_EQ(*p.bake.ray_length, 10);
  EXPECT_EQ(p.extinction, 5);
  EXPECT_EQ(p.shape.exponent, 2);
  EXPECT_EQ(p.shape.bias, -0.01F);
  EXPECT_EQ(p.bake_voxels, 40);
  EXPECT_EQ(p.bake.rays, 36);
  EXPECT_EQ(p.bake.seed, 3U);
  EXPECT_FLOAT_EQ(parametersOf({"bias=-2%"}).shape.bias, -0.07F) << "a share of the longest side";
}

TEST(Parameters, ARangeOfExtinctionsHasItsGeometricMean) {
  const BakeParameters range = parametersOf({"lobe=fit", "extinction=1:9"}), one = parametersOf({"lobe=fit", "extinction=0.1"});
  EXPECT_FLOAT_EQ(range.extinction, 3);
  EXPECT_EQ(range.extinction_low, 1);
  EXPECT_EQ(range.extinction_high, 9);
  EXPECT_EQ(one.extinction, 0.1F) << "to the bit";
  EXPECT_EQ(one.extinction_low, one.extinction_high);
}

// A fit's figures are held against the mean lobe at its own defaults, whatever was chosen for the fit.
TEST(Parameters, TheDefaultMeanShape) {
  const LobeShape shape = defaultMeanShape(boxCloud().surface);
  EXPECT_EQ(shape.exponent, 3);
  EXPECT_FLOAT_EQ(shape.bias, -0.0105F);
}

// A shape s times as large: lengths grow with it, σ shrinks.
TEST(Parameters, FollowTheScale) {
  const BakeParameters p = parametersOf({}), large = parametersFor(cloudOf(boxMesh({4, 4, 4}, {18, 12, 12})), settingsFor({}));
  EXPECT_EQ(*large.bake.ray_length, 4 * *p.bake.ray_length);
  EXPECT_EQ(large.shape.bias, 4 * p.shape.bias);
  EXPECT_EQ(large.extinction, p.extinction / 4);
}

// The defaults that --help tells in words: giving what they say changes nothing.
TEST(Parameters, TheDefaultsInWordsAreTrue) {
  const auto sideOf = [](const std::string& name, bool fit) {
    const std::string text = findOption(name, kBake)->fallback;
    const size_t at = text.find("; fit: ");
    return name + "=" + (fit ? text.substr(at + 7) : text.substr(0, at));
  };
  for (const bool fit : {false, true}) {
    const std::string lobe = fit ? "lobe=fit" : "lobe=mean";
    const BakeParameters unset = parametersOf({lobe}),
                         set = parametersOf({lobe, sideOf("exponent", fit), sideOf("bias", fit), fit ? "extinction=1:4" : "extinction=2"});
    EXPECT_EQ(unset.shape.exponent, set.shape.exponent);
    EXPECT_FLOAT_EQ(unset.shape.bias, set.shape.bias);
    EXPECT_FLOAT_EQ(unset.extinction, set.extinction);
    EXPECT_FLOAT_EQ(unset.extinction_low, set.extinction_low);
    EXPECT_FLOAT_EQ(unset.extinction_high, set.extinction_high);
  }
  EXPECT_STREQ(findOption("extinction", kBake)->fallback, "7/longest side; fit: half to double");
  EXPECT_STREQ(findOption("ray-length", kBake)->fallback, "diagonal");
}

TEST(Parameters, TheFieldGetsTheVoxelsThatWereChosen) {
  FieldSettings settings = settingsFor({"voxels=30", "field=levelset"}).field;
  BakeParameters p;
  EXPECT_EQ(textOf(fieldSettings(settings, p)), textOf(settings));
  p.bake_voxels = 50;
  const FieldSettings field = fieldSettings(settings, p);
  settings.bake_voxels = 50;
  EXPECT_EQ(textOf(field), textOf(settings));
}

// A cloud of one ball of radius 1 and one of this radius beside it, 3 units across.
Cloud grownCloud(float small_radius) {
  Cloud cloud = cloudOf(boxMesh({0, -1, -1}, {3, 1, 1}));
  cloud.spheres = {{{1, 0, 0}, 1}, {{3 - small_radius, 0, 0}, small_radius}};
  return cloud;
}

TEST(Parameters, AFineSurfaceGetsTheFieldThatItsDirectionsAndSpheresNeed) {
  const auto voxelsOf = [](float small_radius, const std::vector<std::string>& texts) {
    return parametersFor(grownCloud(small_radius), settingsFor(texts)).bake_voxels;
  };
  EXPECT_EQ(voxelsOf(0.5F, {"voxels=600"}), 200) << "20 per root of 100 directions";
  EXPECT_EQ(voxelsOf(0.5F, {"voxel-size=0.005"}), 200);
  EXPECT_EQ(voxelsOf(0.5F, {"voxels=600", "rays=400"}), 400);
  EXPECT_EQ(voxelsOf(0.03125F, {"voxels=600"}), 288) << "3 in the radius of the smallest sphere";
  EXPECT_EQ(voxelsOf(0.5F, {"voxels=200"}), std::nullopt) << "the surface's own lattice";
  EXPECT_EQ(voxelsOf(0.5F, {"voxels=600", "rays=1000"}), std::nullopt) << "never finer than the surface";
  EXPECT_EQ(voxelsOf(0.5F, {"voxels=600", "bake-voxels=90"}), 90) << "what is given is obeyed";
  EXPECT_EQ(voxelsOf(0.5F, {"voxels=600", "bake-voxels=900"}), 900);
  EXPECT_EQ(parametersOf({"voxels=600"}).bake_voxels, std::nullopt) << "a sculpt has the field that --voxels asks for";
}

AssetInfo infoOf(const std::vector<std::string>& texts) {
  const Settings settings = settingsFor(texts);
  return describe(settings, parametersFor(boxCloud(), settings));
}

TEST(Parameters, DescribesASweep) {
  const AssetInfo info = infoOf({"lobe=mean", "rays=36", "seed=8", "smooth=2", "basis=sh1", "extinction=5", "exponent=2", "bias=0"});
  EXPECT_EQ(info.lobe, "mean");
  EXPECT_EQ(info.method, "sweep");
  EXPECT_EQ(info.sampler, "fibonacci");
  EXPECT_EQ(info.quadrature, "") << "a sweep has none";
  EXPECT_EQ(info.steps, 0);
  EXPECT_EQ(info.rays, 36);
  EXPECT_EQ(info.seed, 8U);
  EXPECT_EQ(info.smooth, 2);
  EXPECT_EQ(info.harmonic_order, 1);
  EXPECT_EQ(info.extinction, 5);
  EXPECT_EQ(info.shape.exponent, 2);
  EXPECT_EQ(info.shape.bias, 0);
  EXPECT_FLOAT_EQ(info.ray_length, kDiagonal);
  EXPECT_FALSE(info.separate || info.sun_arc);
  EXPECT_TRUE(infoOf({"separate"}).separate);
}

TEST(Parameters, DescribesRaysAndFits) {
  const AssetInfo rays = infoOf({"as-published"});
  EXPECT_EQ(rays.method + " " + rays.sampler + " " + rays.quadrature, "rays uniform end");
  EXPECT_EQ(rays.steps, 100);
  EXPECT_EQ(rays.ray_length, 10);
  const AssetInfo fit = infoOf({"lobe=fit", "sun-arc=5:60,80:100", "extinction=1:9"});
  EXPECT_EQ(fit.lobe, "fit");
  EXPECT_FLOAT_EQ(fit.extinction, 3);
  EXPECT_EQ(fit.extinction_low, 1);
  EXPECT_EQ(fit.extinction_high, 9);
  ASSERT_TRUE(fit.sun_arc);
  EXPECT_EQ(textOf(*fit.sun_arc), textOf(SunArc{5, 60, 80, 100}));
  EXPECT_FALSE(infoOf({"lobe=fit"}).sun_arc);
}

// All of it goes through the asset's metadata.
TEST(Parameters, TheRecordIsWhatAnAssetKeeps) {
  AssetInfo info = infoOf({"lobe=fit", "sun-arc=5:60,80:100", "method=rays", "sampler=uniform", "smooth=1", "basis=sh2", "seed=4"});
  info.field = "level set";
  info.voxel_size = 0.5F;
  info.input_hash = "0123";
  const Json json = writeInfo(info);
  const auto read = readInfo({{"asset", {{"extras", {{"cloudbake", json}}}}}});
  ASSERT_TRUE(read);
  EXPECT_EQ(writeInfo(*read), json);
  EXPECT_EQ(json["sampler"], "uniform");
}

}  // namespace
}  // namespace cloudbake
