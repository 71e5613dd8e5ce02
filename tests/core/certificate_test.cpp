#include "core/certificate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/lobe_lighting.h"

using namespace cloudbake;

namespace {

struct Case {
  const char* name;
  LobeShape shape;
  double depth_low, depth_high;  // of sigma d at the highest sigma, spread evenly over its logarithm
  Affine to_scene{};
};

const Affine kTurned{{{{0, -2, 0}, {2, 0, 0}, {0, 0, 2}}}, {1, 2, 3}}, kStretched{{{{3, 0, 0}, {0, 1, 0.5}, {0, 0, -0.4}}}, {0, 0, 0}};

// The largest change of T over a million lobes, suns and sigmas, and its bound.
struct Change {
  double found = 0, bound = 0;
};

Change changeOf(const Case& one) {
  constexpr size_t kVertices = 2000, kLights = 500;
  constexpr float kHigh = 3.5F;
  std::mt19937 random(7);
  const auto draw = [&](double low, double high) { return low + (high - low) * double(random()) / 4294967296.0; };
  const auto direction = [&] {
    const double z = draw(-1, 1), turn = draw(0, 360), r = std::sqrt(1 - z * z);
    const SinCos at = sinCosDegrees(turn);
    return Vec3{float(r * at.cos), float(r * at.sin), float(z)};
  };
  AssetInfo info;
  info.shape = one.shape;
  info.extinction = kHigh / 2;
  std::vector<LobeUvs> plain;
  for (size_t v = 0; v < kVertices; ++v) {
    const double depth = one.depth_low * std::exp(std::log(one.depth_high / one.depth_low) * draw(0, 1));
    plain.push_back(packLobe({direction(), float(depth / double(kHigh))}, *inverted(one.to_scene)));
    info.density_max = std::max(info.density_max, plain.back().second.y);
  }
  SculptPart part;
  part.positions.resize(kVertices);
  part.to_scene = one.to_scene;
  std::vector<LobeUvs> stored;
  for (const LobeUvs& lobe : plain) {
    const PackedLobe q = quantisedLobe(lobe, info.density_max);
    stored.push_back({{float(q.u / kDirectionSteps), float(q.v / kDirectionSteps)}, {0.25F, float(q.root / kDensitySteps)}});
  }
  const PackedPart parts[] = {{part, stored}};
  Change change;
  change.bound = certify(parts, info, certificateRange(info)).transmittance;
  for (size_t v = 0; v < kVertices; ++v)
    for (size_t i = 0; i < kLights; ++i) {
      const Vec3 light = direction();
      const auto sigma = float(draw(kHigh / 4, kHigh));
      const float before = lobeTransmittance(unpackLobe(plain[v], one.to_scene), light, info.shape, sigma);
      const float after =
          lobeTransmittance(unpackLobe(dequantisedLobe(stored[v], info.density_max), one.to_scene), light, info.shape, sigma);
      change.found = std::max(change.found, std::fabs(double(before) - double(after)));
    }
  return change;
}

}  // namespace

// The bound holds, and is not absurdly above what is found.
TEST(Certificate, BoundsAMillionLobesSunsAndSigmas) {
  const Case cases[] = {{"mean", {3, -0.02F}, 0.5, 14},
                        {"volume", {2.1F, 0.1F}, 0.5, 30},
                        {"transmittance", {4, 0}, 1, 3e4},
                        {"less than linear", {0.88F, 0.02F}, 0.01, 4},
                        {"turned", {3, -0.02F}, 0.5, 14, kTurned},
                        {"stretched", {3, -0.02F}, 0.5, 14, kStretched}};
  for (const Case& one : cases) {
    const Change change = changeOf(one);
    EXPECT_LE(change.found, change.bound) << one.name;
    EXPECT_GT(change.found, 0.2 * change.bound) << one.name;
    EXPECT_LE(change.bound, kMostPackedError) << one.name;
    std::printf("%s: found %.3g, bound %.3g, ratio %.2f\n", one.name, change.found, change.bound, change.found / change.bound);
  }
}

// Every direction of a cell is within the chord that the derivation states.
TEST(Certificate, CellsOfDirectionsAreAsSmallAsStated) {
  std::mt19937 random(3);
  double most = 0;
  for (int i = 0; i < 200000; ++i) {
    Vec3 o{float(int32_t(random())), float(int32_t(random())), float(int32_t(random()))};
    if (i % 3 == 0) o.z = i % 2 ? 0 : o.z, o.x = 0;  // on the folds
    const auto unit = normalized(o * 1e-9F);
    if (!unit) continue;
    const PackedLobe q = quantisedLobe({{unit->x, unit->y}, {unit->z, 1}}, 1);
    const LobeUvs back = dequantisedLobe({{float(q.u / kDirectionSteps), float(q.v / kDirectionSteps)}, {0, 1}}, 1);
    most = std::max(most, double(length(Vec3{back.first.x, back.first.y, back.second.x} - *unit)));
  }
  EXPECT_LE(most, std::sqrt(18.0) * 0.5 / kDirectionSteps + 2e-7);
  EXPECT_GT(most, 0.5 * std::sqrt(18.0) * 0.5 / kDirectionSteps);
}
