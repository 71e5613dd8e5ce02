// Constants that no bake writes are told from those that are only unusual.
#include "pipeline/check/judge.h"

#include "tests/pipeline/check/check_helpers.h"

namespace cloudbake {
namespace {

// What is said of a ball of radius 1 with these constants; empty if nothing is odd.
std::string oddOf(const auto& change) {
  TestAsset ball = ballAsset();
  change(ball.info);
  const auto fault = oddConstants(ball.info, ball.mesh);
  if (!fault) return "";
  EXPECT_EQ(fault->cause, "odd-metadata");
  EXPECT_FALSE(fault->cure.empty());
  return fault->what;
}

TEST(OddConstants, UsualOnes) {
  EXPECT_EQ(oddOf([](AssetInfo&) {}), "");
  EXPECT_EQ(oddOf([](AssetInfo& info) { info.extinction = 49, info.shape = {0.5F, 1.9F}, info.ray_length = 0.5F; }), "");
  EXPECT_EQ(oddOf([](AssetInfo& info) { info.extinction = 0.06F, info.shape = {64, -1.9F}, info.ray_length = 1000; }), "");
  EXPECT_EQ(oddOf([](AssetInfo& info) { info.ray_length = 0; }), "") << "not recorded";
  EXPECT_EQ(oddOf([](AssetInfo& info) { info.lobe = "fit", info.extinction_low = 2, info.extinction_high = 9; }), "");
  EXPECT_EQ(oddOf([](AssetInfo& info) { info.lobe = "fit"; }), "") << "no range is recorded";
}

TEST(OddConstants, Extinction) {
  for (const float value : {0.0F, -1.0F, NAN, INFINITY})
    EXPECT_TRUE(contains(oddOf([&](AssetInfo& info) { info.extinction = value; }), "is not a number above 0")) << value;
  EXPECT_TRUE(contains(oddOf([](AssetInfo& info) { info.extinction = 51; }), "so large that everything is opaque"));
  EXPECT_TRUE(contains(oddOf([](AssetInfo& info) { info.extinction = 0.04F; }), "so small that the cloud is invisible"));
  const auto range = [](float low, float high) {
    return oddOf([&](AssetInfo& info) { info.lobe = "fit", info.extinction = 3, info.extinction_low = low, info.extinction_high = high; });
  };
  for (const auto& [low, high] :
       {std::pair(4.0F, 9.0F), std::pair(1.0F, 2.0F), std::pair(-1.0F, 4.0F), std::pair(1.0F, INFINITY), std::pair(NAN, 4.0F)})
    EXPECT_TRUE(contains(range(low, high), "is not within extinction_range")) << low << " " << high;
}

TEST(OddConstants, ExponentBiasAndRayLength) {
  for (const float value : {0.0F, -1.0F, 65.0F, NAN, INFINITY})
    EXPECT_TRUE(contains(oddOf([&](AssetInfo& info) { info.shape.exponent = value; }), "exponent")) << value;
  for (const float value : {2.1F, -2.1F, NAN, INFINITY})
    EXPECT_TRUE(contains(oddOf([&](AssetInfo& info) { info.shape.bias = value; }), "is longer than the cloud")) << value;
  for (const float value : {-1.0F, NAN, INFINITY})
    EXPECT_TRUE(contains(oddOf([&](AssetInfo& info) { info.ray_length = value; }), "is not a length")) << value;
  for (const float value : {0.01F, 3000.0F})
    EXPECT_TRUE(contains(oddOf([&](AssetInfo& info) { info.ray_length = value; }), "does not fit a cloud whose longest side is 2"))
        << value;
}

}  // namespace
}  // namespace cloudbake
