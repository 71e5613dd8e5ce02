// Every step of the image chain against a plain reference in double, and against what must hold for any picture.
#include "preview/mesh_clouds/post.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "core/random.h"
#include "preview/backdrop/noise.h"
#include "preview/mesh_clouds/lit_mesh.h"

namespace cloudbake {
namespace {

constexpr int kWidth = 13, kHeight = 9;
constexpr ChannelMean kMeans[] = {ChannelMean::kCovered, ChannelMean::kAll};

// Clouds of any opacity and depth, with holes between them.
Image4 randomImage(int width = kWidth, int height = kHeight, uint64_t seed = 1) {
  Image4 image = filledImage4(width, height, kNoCloud);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    const auto draw = [&](uint32_t what) { return uniformFloat(hashDraw(seed, uint32_t(i), what)); };
    if (draw(0) < 0.3F) continue;
    image.pixels[i] = {draw(1), draw(2), draw(0) < 0.6F ? draw(3) : 1, draw(4)};
  }
  return image;
}

// The definition of a mean of pixels, term by term.
struct ReferenceMean {
  ChannelMean mean;
  double red = 0, green = 0, opacity = 0, depth = 0, counted = 0, total = 0;
  void add(const Rgba& p, double weight) {
    const double w = mean == ChannelMean::kCovered ? weight * p[2] : weight;
    red += w * p[0], green += w * p[1], depth += w * p[3], counted += w;
    opacity += weight * p[2], total += weight;
  }
  std::array<double, 4> value() const {
    if (counted == 0) return {0, 0, 0, 1};
    return {red / counted, green / counted, opacity / total, depth / counted};
  }
};

const Rgba& clamped(const Image4& image, int x, int y) {
  return image.at(std::min(std::max(x, 0), image.width - 1), std::min(std::max(y, 0), image.height - 1));
}

// All pixels of the picture and of its border, each by the tent of its distance.
void addTent(const Image4& image, double x, double y, double weight, ReferenceMean& sum) {
  for (int j = -40; j < image.height + 40; ++j)
    for (int i = -40; i < image.width + 40; ++i) {
      const double tent = std::max(0.0, 1 - std::abs(i + 0.5 - x)) * std::max(0.0, 1 - std::abs(j + 0.5 - y));
      if (tent > 0) sum.add(clamped(image, i, j), weight * tent);
    }
}

void expectNear(const Rgba& pixel, const std::array<double, 4>& expected, double tolerance = 1e-5) {
  for (size_t c = 0; c < 4; ++c) ASSERT_NEAR(pixel[c], expected[c], tolerance) << "channel " << c;
}

// What shows: a pixel without opacity has no colour and no depth of its own.
Image4 premultiplied(Image4 image) {
  for (Rgba& p : image.pixels) p = {p[0] * p[2], p[1] * p[2], p[2], p[3] * p[2]};
  return image;
}

double largestDifference(const Image4& a, const Image4& b) {
  double largest = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i)
    for (size_t c = 0; c < 4; ++c) largest = std::max(largest, std::abs(double(a.pixels[i][c]) - b.pixels[i][c]));
  return largest;
}

TEST(Resample, IsTheTentOfFourPixels) {
  const Image4 image = randomImage();
  for (const ChannelMean mean : kMeans)
    for (const auto& [width, height] : {std::pair{7, 5}, {13, 9}, {26, 18}, {5, 20}}) {
      const Image4 result = resampleBilinear(image, width, height, mean);
      ASSERT_EQ(result.pixels.size(), size_t(width * height));
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          ReferenceMean sum{mean};
          addTent(image, (x + 0.5) * kWidth / width, (y + 0.5) * kHeight / height, 1, sum);
          ASSERT_NO_FATAL_FAILURE(expectNear(result.at(x, y), sum.value()));
        }
    }
  EXPECT_LT(largestDifference(resampleBilinear(image, kWidth, kHeight), image), 1e-6);
}

TEST(Resample, HalfAsLargeIsTheMeanOfTwoByTwo) {
  const Image4 image = randomImage(12, 8), half = resampleBilinear(image, 6, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 6; ++x) {
      ReferenceMean sum{ChannelMean::kCovered};
      for (const int k : {0, 1, 2, 3}) sum.add(image.at(2 * x + k % 2, 2 * y + k / 2), 0.25);
      ASSERT_NO_FATAL_FAILURE(expectNear(half.at(x, y), sum.value()));
    }
}

// Seven taps, in both directions, as the formula states them.
Image4 referenceBlur(const Image4& image, bool horizontal, const BlurSettings& s) {
  Image4 result = image;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const double depth = image.at(x, y)[3], sigma = s.near_sigma + (s.far_sigma - s.near_sigma) * depth;
      ReferenceMean sum{s.mean};
      for (int i = -3; i <= 3; ++i) {
        const double weight = std::exp(s.as_quoted ? -2.0 * i * i / (sigma * sigma) : -double(i * i) / (2 * sigma * sigma));
        sum.add(horizontal ? clamped(image, x + i, y) : clamped(image, x, y + i), weight);
      }
      const auto value = sum.value();
      result.at(x, y) = {float(value[0]), float(value[1]), float(value[2]), image.at(x, y)[3]};
    }
  return result;
}

TEST(Blur, IsTheGaussianOfSevenTapsInBothDirections) {
  const Image4 image = randomImage();
  for (const ChannelMean mean : kMeans)
    for (const bool quoted : {false, true})
      for (const float near_sigma : {10.0F, 2.0F}) {
        const BlurSettings settings{.near_sigma = near_sigma, .as_quoted = quoted, .mean = mean};
        const Image4 expected = referenceBlur(referenceBlur(image, true, settings), false, settings);
        const Image4 blurred = blurByDepth(image, settings);
        // Where the reference keeps a trace of cloud that no float sum would notice, colours have nothing to be the colour of.
        for (size_t i = 0; i < image.pixels.size(); ++i) {
          ASSERT_NEAR(blurred.pixels[i][2], expected.pixels[i][2], 1e-5);
          for (const size_t c : {0U, 1U})
            ASSERT_NEAR(blurred.pixels[i][c] * blurred.pixels[i][2], expected.pixels[i][c] * expected.pixels[i][2], 1e-5);
          ASSERT_EQ(blurred.pixels[i][3], image.pixels[i][3]);
        }
      }
}

// The quoted form is a Gaussian of half the width.
TEST(Blur, QuotedFormIsTheOtherWithHalfOfS) {
  Image4 image = randomImage();
  for (Rgba& p : image.pixels) p[3] = 0.6F;
  const Image4 quoted = blurByDepth(image, {.near_sigma = 3, .far_sigma = 3, .as_quoted = true});
  EXPECT_LT(largestDifference(quoted, blurByDepth(image, {.near_sigma = 1.5F, .far_sigma = 1.5F})), 1e-6);
  EXPECT_GT(largestDifference(quoted, blurByDepth(image, {.near_sigma = 3, .far_sigma = 3})), 0.05);
}

TEST(Blur, ConstantStaysConstantAndOpacityIsKept) {
  const Image4 constant = filledImage4(kWidth, kHeight, {0.3F, 0.7F, 0.45F, 0.2F});
  for (const ChannelMean mean : kMeans) EXPECT_LT(largestDifference(blurByDepth(constant, {.mean = mean}), constant), 1e-6);
  // At one depth the kernel moves opacity about and loses none, away from the border.
  Image4 spot = filledImage4(21, 21, {0, 0, 0, 0.3F});
  spot.at(10, 10) = {0.5F, 0.25F, 1, 0.3F};
  const Image4 blurred = blurByDepth(spot);
  double opacity = 0;
  for (const Rgba& p : blurred.pixels) {
    opacity += p[2];
    if (p[2] > 0) {
      EXPECT_NEAR(p[0], 0.5, 1e-6);  // the spot's own colour, however thin
    }
  }
  EXPECT_NEAR(opacity, 1, 1e-5);
  EXPECT_GT(blurred.at(13, 13)[2], 0.01F);
  EXPECT_EQ(blurred.at(14, 10)[2], 0);
}

TEST(Blur, FarPixelsAndTheBackgroundStayAndNearOnesSpread) {
  Image4 image = randomImage();
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < 7; ++x) image.at(x, y)[3] = image.at(x, y)[2] > 0 ? 0 : 1;
  const Image4 blurred = blurByDepth(image);
  double changed = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      if (image.at(x, y)[3] == 1) {
        EXPECT_EQ(blurred.at(x, y), image.at(x, y));
      }
      if (x < 7 && image.at(x, y)[3] == 0) changed += std::abs(blurred.at(x, y)[2] - image.at(x, y)[2]);
    }
  EXPECT_GT(changed, 5);
}

TEST(DepthBlur, IsTheMeanOverTheBox) {
  const Image4 image = randomImage();
  for (const ChannelMean mean : kMeans)
    for (const int radius : {0, 1, 2, 5}) {
      const Image4 blurred = blurDepth(image, {.radius = radius, .mean = mean});
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          double sum = 0, weights = 0;
          for (int j = y - radius; j <= y + radius; ++j)
            for (int i = x - radius; i <= x + radius; ++i) {
              const double w = mean == ChannelMean::kCovered ? clamped(image, i, j)[2] : 1;
              sum += w * clamped(image, i, j)[3];
              weights += w;
            }
          const Rgba& pixel = image.at(x, y);
          ASSERT_NO_FATAL_FAILURE(
              expectNear(blurred.at(x, y), {pixel[0], pixel[1], pixel[2], weights > 0 && radius > 0 ? sum / weights : pixel[3]}));
        }
    }
}

TEST(DepthBlur, WithoutRadiusIsTheImageItself) {
  Image4 image = randomImage();
  for (Rgba& pixel : image.pixels) pixel[2] *= 0.7F;
  EXPECT_EQ(blurDepth(image, {.radius = 0}).pixels, image.pixels);
}

// A near cloud before nothing: its depth goes on around it, and no rim turns far.
TEST(DepthBlur, RimsKeepTheirDepth) {
  Image4 image = filledImage4(20, 20, kNoCloud);
  for (int y = 6; y < 14; ++y)
    for (int x = 6; x < 14; ++x) image.at(x, y) = {1, 1, 1, 0.25F};
  const Image4 blurred = blurDepth(image, {.radius = 3});
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) {
      const bool close = x >= 3 && x < 17 && y >= 3 && y < 17;
      EXPECT_EQ(blurred.at(x, y)[3], close ? 0.25F : 1);
    }
}

// The least opacity of nine places, and nothing else.
TEST(DepthBlur, Shrinks) {
  const Image4 image = randomImage();
  for (const int radius : {0, 2}) {
    const Image4 plain = blurDepth(image, {.radius = radius}), shrunk = blurDepth(image, {.radius = radius, .shrink = 2});
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        float least = 1;
        for (const int j : {-2, 0, 2})
          for (const int i : {-2, 0, 2})
            least = std::min(least, image.at(std::clamp(x + i, 0, image.width - 1), std::clamp(y + j, 0, image.height - 1))[2]);
        Rgba expected = plain.at(x, y);
        expected[2] = least;
        EXPECT_EQ(shrunk.at(x, y), expected);
      }
  }
}

// Sun and sky alike, between `dark` and 1, with the noises; also where nothing swirls.
TEST(Distort, Darkens) {
  Image4 image = filledImage4(40, 30, {0.5F, 0.25F, 1, 0});
  DistortSettings s{.swirl_strength = 0, .swirl_speed = 0.25F, .dark = 0.8F};
  const Image4 darker = distort(image, s);
  float least = 1, most = 0;
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) {
      const float factor = darkness({(float(x) + 0.5F) / (30 * s.tile_size), (float(y) + 0.5F) / (30 * s.tile_size)}, s);
      const Rgba expected{0.5F * factor, 0.25F * factor, 1, 0};
      EXPECT_EQ(darker.at(x, y), expected);
      least = std::min(least, factor), most = std::max(most, factor);
    }
  EXPECT_GE(least, 0.8F);
  EXPECT_LE(most, 1);
  EXPECT_GT(most - least, 0.05F);
  s.time_seconds = 4;  // a cycle later the noises are where they were
  EXPECT_EQ(distort(image, s).pixels, darker.pixels);
  s.time_seconds = 3;
  EXPECT_NE(distort(image, s).pixels, darker.pixels);
}

TEST(Distort, TakesTheTwoPhasesAlongTheFlow) {
  const Image4 image = randomImage();
  for (const ChannelMean mean : kMeans)
    for (const double time : {0.0, 3.7, 12.9}) {
      const DistortSettings s{.tile_size = 0.7F, .swirl_strength = 0.3F, .time_seconds = time, .seed = 5, .mean = mean};
      const double cycles = time * double(s.swirl_speed), first = cycles - std::floor(cycles), second = std::fmod(first + 0.5, 1.0);
      const double later = std::abs(2 * first - 1);
      const Image4 result = distort(image, s);
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          const double depth = image.at(x, y)[3];
          const Vec2 flow = swirlFlow({float((x + 0.5) / kHeight / 0.7), float((y + 0.5) / kHeight / 0.7)}, float(depth), s);
          const double strength = kHeight * 0.3 * (1 + (0.25 - 1) * depth);
          ReferenceMean sum{mean};
          for (const auto& [phase, weight] : {std::pair{first, 1 - later}, {second, later}})
            addTent(image, x + 0.5 - phase * strength * flow.x, y + 0.5 - phase * strength * flow.y, weight, sum);
          ASSERT_NO_FATAL_FAILURE(expectNear(result.at(x, y), sum.value(), 1e-4));
        }
    }
}

TEST(Distort, WithoutStrengthIsTheImageItself) {
  const Image4 image = randomImage();
  EXPECT_EQ(distort(image, {.swirl_strength = 0, .time_seconds = 3}).pixels, image.pixels);
  EXPECT_LT(largestDifference(premultiplied(distort(image, {.swirl_strength = 1e-7F, .time_seconds = 3})), premultiplied(image)), 1e-4);
  EXPECT_GT(largestDifference(distort(image, {.swirl_strength = 0.2F, .time_seconds = 3}), image), 0.1);
  const Image4 constant = filledImage4(kWidth, kHeight, {0.3F, 0.7F, 0.45F, 0.2F});
  EXPECT_LT(largestDifference(distort(constant), constant), 1e-6);
}

// A soft picture, so that what jumps is the method and not the pixels.
Image4 softImage() {
  Image4 image = filledImage4(64, 48, kNoCloud);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      const float u = float(x) * 0.15F, v = float(y) * 0.15F;
      image.at(x, y) = {0.5F + 0.5F * std::sin(u), 0.5F + 0.5F * std::cos(v), 0.5F + 0.5F * std::sin(u + v), 0.5F};
    }
  return image;
}

TEST(Distort, NeverPops) {
  const Image4 image = softImage();
  // A cycle takes 2 s; phases start anew at every full and half cycle, where it would pop if it did.
  const auto jumpAt = [&](double time, Vec2 near_drift, Vec2 far_drift) {
    constexpr double kStep = 1e-3;
    const auto at = [&](double moment) {
      return distort(
          image, {.swirl_strength = 0.1F, .swirl_speed = 0.5F, .near_drift = near_drift, .far_drift = far_drift, .time_seconds = moment});
    };
    return largestDifference(at(time - kStep / 2), at(time + kStep / 2));
  };
  const DistortSettings drifting;
  for (const auto& [near_drift, far_drift] : {std::pair{Vec2{}, Vec2{}}, {drifting.near_drift, drifting.far_drift}}) {
    double between = 0, at_starts = 0;
    for (double time = 0.05; time < 4; time += 0.1) between = std::max(between, jumpAt(time, near_drift, far_drift));
    for (const double time : {1.0, 2.0, 3.0, 100000.0}) at_starts = std::max(at_starts, jumpAt(time, near_drift, far_drift));
    EXPECT_LT(at_starts, 1.5 * between);
    EXPECT_LT(between, near_drift == Vec2{} ? 0.002 : 0.012);
    EXPECT_GT(between, 1e-4);
  }
  // The weights themselves.
  for (const double cycles : {0.0, 0.5, 7.0, 1e6 + 0.5}) {
    const FlowPhases before = flowPhases(cycles - 1e-6, 1), after = flowPhases(cycles + 1e-6, 1);
    EXPECT_NEAR(before.second_weight, after.second_weight, 1e-4);
    const bool first_starts = cycles == std::floor(cycles);
    EXPECT_NEAR(after.second_weight, first_starts ? 1 : 0, 1e-4);
    EXPECT_NEAR(first_starts ? after.first : after.second, 0, 1e-4);
  }
}

// After a cycle the near noise has moved by a whole tile, and the far one by two of its own, which is half a near tile.
TEST(Distort, TheNoisesDrift) {
  DistortSettings s{.swirl_speed = 0.25F};
  const auto at = [&](double time, double x, double y, float depth) {
    s.time_seconds = time;
    return swirlFlow({float(x), float(y)}, depth, s);
  };
  const auto expectNear = [](Vec2 a, Vec2 b, const char* what) {
    EXPECT_NEAR(a.x, b.x, 1e-5) << what;
    EXPECT_NEAR(a.y, b.y, 1e-5) << what;
  };
  for (const auto& [x, y] : {std::pair{0.3, 0.6}, {0.8, 0.1}}) {
    for (const float depth : {0.0F, 0.4F, 1.0F}) EXPECT_EQ(at(0, x, y, depth), at(4, x, y, depth));
    expectNear(at(1, x + 0.25, y, 0), at(0, x, y, 0), "to the right");
    expectNear(at(1, x + 0.125, y, 1), at(0, x, y, 1), "the far noise at half the speed");
    EXPECT_NE(at(1, x, y, 0), at(0, x, y, 0));
  }
  s.near_drift = {0, 0.5F};
  expectNear(at(2, 0.3, 0.5, 0), at(0, 0.3, 0.75, 0), "upwards; y counts from the top");
  s.near_drift = s.far_drift = {};
  EXPECT_EQ(at(1.3, 0.3, 0.5, 0.5F), at(0, 0.3, 0.5, 0.5F));
}

TEST(Distort, CyclesOfALoop) {
  EXPECT_EQ(cyclesOfLoop({}), 1);
  EXPECT_EQ(cyclesOfLoop({.near_drift = {}, .far_drift = {}}), 0.5);
  EXPECT_EQ(cyclesOfLoop({.near_drift = {2, -4}, .far_drift = {0.5F, 1}}), 0.5);
  EXPECT_EQ(cyclesOfLoop({.far_tiles = 3}), 2) << "the far noise moves by one and a half of its tiles in a cycle";
  EXPECT_EQ(cyclesOfLoop({.near_drift = {0.125F, 0}}), 8);
  EXPECT_EQ(cyclesOfLoop({.near_drift = {0.01F, 0}}), std::nullopt);
}

// Depth 0 is carried by the near noise at full strength, depth 1 by the far noise, which has four tiles on one and a quarter of it.
TEST(Distort, FlowTilesIsFreeOfDivergenceAndFollowsDepth) {
  const DistortSettings s;
  double mean_x = 0, mean_y = 0, square = 0;
  int count = 0;
  const auto at = [&](double x, double y, float depth) { return swirlFlow({float(x), float(y)}, depth, s); };
  for (double y = 0.03125; y < 1; y += 0.0625)
    for (double x = 0.03125; x < 1; x += 0.0625) {
      for (const float depth : {0.0F, 0.5F, 1.0F}) {
        EXPECT_EQ(at(x, y, depth), at(x + 1, y + 2, depth));
        EXPECT_LT(std::hypot(at(x, y, depth).x, at(x, y, depth).y), 2);
        constexpr double kStep = 1e-3;
        const double divergence =
            (double(at(x + kStep, y, depth).x) - at(x - kStep, y, depth).x + at(x, y + kStep, depth).y - at(x, y - kStep, depth).y) /
            (2 * kStep);
        EXPECT_NEAR(divergence, 0, depth == 0 ? 0.3 : 1.5);  // single derivatives reach 20 near and 80 far
        square += std::abs(at(x + kStep, y, depth).x - at(x - kStep, y, depth).x) / (2 * kStep);
        ++count;
      }
      EXPECT_NEAR(at(x, y, 1).x, at(x + 0.25, y, 1).x, 1e-5);
      EXPECT_NEAR(at(x, y, 1).y, at(x + 0.25, y, 1).y, 1e-5);
      EXPECT_NE(at(x, y, 0), at(x + 0.25, y, 0));
      const Vec2 near = at(x, y, 0), far = at(x, y, 1), middle = at(x, y, 0.5F);
      EXPECT_NEAR(middle.x, (near.x + far.x) / 2, 1e-5);
      mean_x += near.x, mean_y += near.y;
    }
  EXPECT_GT(square / count, 2);
  EXPECT_LT(std::abs(mean_x) / 256, 0.15);
  EXPECT_LT(std::abs(mean_y) / 256, 0.15);
}

SkyColors someColors() {
  return {{0.1F, 0.2F, 0.6F}, {0.5F, 0.6F, 0.7F}, {0.2F, 0.1F, 0}, {1, 0.9F, 0.7F}, {0.2F, 0.3F, 0.5F}, {0.1F, 0.08F, 0.05F}, {}};
}

const Camera kCompositeCamera{{0, 0, 5}, {0, 0, 0}, 35, 20, 12};

SkySettings skyOf(const SkyColors& colors) {
  SkySettings sky;
  sky.colors = colors;
  return sky;
}

Image someBackground(int width, int height) {
  Image image = blankImage(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.at(x, y) = {float(x) / 7, float(y) / 5, float(x + y) * 0.01F};
  return image;
}

TEST(Composite, IsTheFormulaOverTheBackground) {
  const Image4 channels = randomImage();
  const Image background = someBackground(4 * kWidth, 4 * kHeight);
  const SkyColors c = someColors();
  for (const ChannelMean mean : kMeans) {
    const Image result = composite(channels, background, kCompositeCamera, skyOf(c), {.fog_density = 0.8F, .mean = mean});
    for (int y = 0; y < background.height; ++y)
      for (int x = 0; x < background.width; ++x) {
        ReferenceMean sum{mean};
        addTent(channels, (x + 0.5) / 4, (y + 0.5) / 4, 1, sum);
        const auto p = sum.value();
        const auto blend = [&](float sun, float sky, float ground, float horizon, float behind) {
          const double cloud = ground + (double(sun) - ground) * p[0] + ground + (double(sky) - ground) * p[1],
                       fog = 1 - std::exp(-0.8 * p[3]);
          return behind + (cloud + (horizon - cloud) * fog - behind) * p[2];
        };
        const Vec3 b = background.at(x, y), r = result.at(x, y);
        ASSERT_NEAR(r.x, blend(c.sun_color.x, c.ambient_sky.x, c.ambient_ground.x, c.horizon.x, b.x), 1e-4);
        ASSERT_NEAR(r.y, blend(c.sun_color.y, c.ambient_sky.y, c.ambient_ground.y, c.horizon.y, b.y), 1e-4);
        ASSERT_NEAR(r.z, blend(c.sun_color.z, c.ambient_sky.z, c.ambient_ground.z, c.horizon.z, b.z), 1e-4);
      }
  }
}

TEST(Composite, NoCloudIsExactlyTheBackgroundAndAThinRimHasNoDarkness) {
  const Image background = someBackground(20, 12);
  EXPECT_EQ(composite(filledImage4(5, 3, kNoCloud), background, kCompositeCamera, skyOf(someColors())).pixels, background.pixels);
  EXPECT_EQ(
      composite(filledImage4(5, 3, {0.4F, 0.7F, 0, 0.3F}), background, kCompositeCamera, skyOf(someColors()), {.mean = ChannelMean::kAll})
          .pixels,
      background.pixels);
  // White cloud on a white sky: rims too are white, unless the clear value's black is let in.
  Image4 channels = filledImage4(5, 3, kNoCloud);
  for (int y = 0; y < 3; ++y) channels.at(0, y) = channels.at(1, y) = {1, 1, 1, 0.5F};
  Image white = blankImage(20, 12);
  for (Vec3& p : white.pixels) p = {1, 1, 1};
  const SkyColors colors{{}, {1, 1, 1}, {}, {1, 1, 1}, {}, {}, {}};
  float darkest = 1, darkest_published = 1;
  for (const Vec3& p : composite(channels, white, kCompositeCamera, skyOf(colors)).pixels) darkest = std::min(darkest, p.x);
  for (const Vec3& p : composite(channels, white, kCompositeCamera, skyOf(colors), {.fog_density = 0, .mean = ChannelMean::kAll}).pixels)
    darkest_published = std::min(darkest_published, p.x);
  EXPECT_NEAR(darkest, 1, 1e-6);
  EXPECT_LT(darkest_published, 0.8F);
}

// Over all directions the factor is 1 on average, so that the cloud as a whole is as bright as before; it is largest towards the sun.
TEST(Composite, PhaseMovesLightTowardsTheSun) {
  const Vec3 sun = *normalized(Vec3{0.3F, 0.5F, -0.8F});
  const PhaseSettings unlimited{.share = 0.6F, .asymmetry = 0.7F, .limit = 1e9F};
  double sum = 0;
  constexpr int kSteps = 4000;
  for (int i = 0; i < kSteps; ++i) {
    const double cosine = -1 + (i + 0.5) * 2 / kSteps;
    const Vec3 view = sun * float(cosine) + frameAround(sun).tangent * float(std::sqrt(1 - cosine * cosine));
    const double g = 0.7, p = (1 - g * g) / std::pow(1 + g * g - 2 * g * cosine, 1.5);
    EXPECT_NEAR(phaseFactor(view, sun, unlimited), 1 + 0.6 * (p - 1), 1e-4 * p);
    sum += phaseFactor(view, sun, unlimited) / kSteps;
  }
  EXPECT_NEAR(sum, 1, 1e-4);
  EXPECT_NEAR(phaseFactor(sun, sun, {.share = 0.5F, .asymmetry = 0.7F, .limit = 6}), 3.5, 1e-4);
  EXPECT_EQ(phaseFactor(sun, sun, {}), 1);

  // Of a pixel, only the sun's term changes.
  SkySettings sky = skyOf(someColors());
  sky.to_sun = sun;
  const Rgba channels{0.5F, 0.25F, 1, 0};
  const CloudLight light = cloudLight(sky);
  const Vec3 plain = lightOfCloud(channels, sun, light, {}), more = lightOfCloud(channels, sun, light, unlimited) - plain;
  EXPECT_EQ(plain, cloudColor({0.5F, 0.25F}, sky.colors));
  const float factor = 0.5F * (phaseFactor(sun, sun, unlimited) - 1);
  EXPECT_LT(length(more - sky.colors.sun_color * factor), 1e-4F);
}

// The factor belongs to each pixel's own direction.
TEST(Composite, PhaseFollowsTheViewOfEachPixel) {
  SkySettings sky = skyOf({{}, {}, {}, {1, 1, 1}, {}, {}, {}});
  sky.to_sun = cameraRay(kCompositeCamera, 15.5F, 3.5F).direction;
  const Image lit = composite(filledImage4(20, 12, {1, 0, 1, 0}), blankImage(20, 12), kCompositeCamera, sky,
                              {.fog_density = 0, .phase = {.share = 0.5F}});
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 20; ++x) {
      EXPECT_EQ(lit.at(x, y).x,
                phaseFactor(cameraRay(kCompositeCamera, float(x) + 0.5F, float(y) + 0.5F).direction, sky.to_sun, {.share = 0.5F}));
      EXPECT_LE(lit.at(x, y).x, lit.at(15, 3).x);
    }
}

TEST(Composite, FogThickensWithDepth) {
  const Image black = blankImage(1, 1);
  const SkyColors colors{{}, {1, 1, 1}, {}, {}, {}, {}, {}};
  float last = -1;
  for (const float depth : {0.0F, 0.3F, 1.0F}) {
    const float fog =
        composite(filledImage4(1, 1, {0, 0, 1, depth}), black, kCompositeCamera, skyOf(colors), {.fog_density = 2}).at(0, 0).x;
    EXPECT_NEAR(fog, 1 - std::exp(-2 * double(depth)), 1e-6);
    EXPECT_GT(fog, last);
    last = fog;
  }
  EXPECT_EQ(composite(filledImage4(1, 1, {0, 0, 1, 1}), black, kCompositeCamera, skyOf(colors), {.fog_density = 0}).at(0, 0), (Vec3{}));
}

TEST(Post, SameBytesForAnyNumberOfThreads) {
  const Image4 image = randomImage(67, 45);
  const auto chain = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Image4 last = distort(blurDepth(blurByDepth(resampleBilinear(image, 34, 23))), {.time_seconds = 4});
    return composite(last, someBackground(134, 90), kCompositeCamera, skyOf(someColors()));
  };
  const Image one = chain(1);
  for (const size_t threads : {2U, 7U})
    EXPECT_EQ(std::memcmp(one.pixels.data(), chain(threads).pixels.data(), one.pixels.size() * sizeof(Vec3)), 0);
}

}  // namespace
}  // namespace cloudbake
