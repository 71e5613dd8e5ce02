// Lobes whose right values are known in closed form, damaged in one way each: the diagnosis names that way.
#include "pipeline/check/diagnose.h"

#include <gtest/gtest.h>

#include <functional>

#include "core/lobe_lighting.h"
#include "core/random.h"

using namespace cloudbake;

namespace {

constexpr int kPoints = 240;
constexpr Vec3 kHalfAxes{1, 0.6F, 1.7F};

std::vector<Vec3> sphereDirections(int count) {
  std::vector<Vec3> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * i + 1) / count, azimuth = 2 * kPi * i * 0.6180339887498949, r = std::sqrt(1 - z * z);
    directions.push_back({float(r * std::cos(azimuth)), float(r * std::sin(azimuth)), float(z)});
  }
  return directions;
}

// On an ellipsoid: the inward normal −Qp/‖Qp‖, Q = diag(1/a²), and the chord along it, −2 (p·Qo)/(o·Qo).
Lobe ellipsoidLobe(Vec3 on_unit_sphere) {
  const Vec3 p{on_unit_sphere.x * kHalfAxes.x, on_unit_sphere.y * kHalfAxes.y, on_unit_sphere.z * kHalfAxes.z};
  const auto q = [](Vec3 v) {
    return Vec3{v.x / (kHalfAxes.x * kHalfAxes.x), v.y / (kHalfAxes.y * kHalfAxes.y), v.z / (kHalfAxes.z * kHalfAxes.z)};
  };
  const Vec3 o = *normalized(-q(p));
  return {o, -2 * dot(p, q(o)) / dot(o, q(o))};
}

Affine turnAboutZ(double degrees) {
  Affine turn;
  const double c = std::cos(degrees * kPi / 180), s = std::sin(degrees * kPi / 180);
  turn.linear = {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}};
  return turn;
}

// An ellipsoid under a node that turns and stretches, its stored directions off by some three degrees, as bakes are.
DiagnosisSample ellipsoid(float noise = 0.05F) {
  DiagnosisSample sample;
  Affine node = turnAboutZ(30);
  for (auto& row : node.linear) row[0] *= 1.4;
  const std::vector<Vec3> points = sphereDirections(kPoints);
  for (size_t v = 0; v < points.size(); ++v) {
    const Lobe right = ellipsoidLobe(points[v]);
    const auto draw = [&](uint32_t i) { return noise * (uniformFloat(hashDraw(7, uint32_t(v), i)) - 0.5F); };
    const Lobe baked{*normalized(right.direction + Vec3{draw(0), draw(1), draw(2)}), right.thickness * (1 + draw(3))};
    sample.truth.push_back(right);
    sample.to_scene.push_back(node);
    sample.stored.push_back(packLobe(baked, *inverted(node)));
    sample.pieces.push_back(v % 2);
  }
  return sample;
}

// The same as a fitted asset: judged by its transmittance alone.
DiagnosisSample fittedEllipsoid() {
  DiagnosisSample sample = ellipsoid();
  sample.lights = sphereDirections(32);
  sample.shape = {4, 0};
  sample.extinction = 2;
  for (const Lobe& lobe : sample.truth)
    for (const Vec3& light : sample.lights) sample.true_fit.push_back(lobeTransmittance(lobe, light, sample.shape, sample.extinction));
  return sample;
}

using Damage = std::function<LobeUvs(LobeUvs)>;

// Without a node between: damage to what is stored is damage in scene space.
DiagnosisSample damaged(DiagnosisSample sample, const Damage& damage) {
  for (LobeUvs& uvs : sample.stored) uvs = damage(uvs);
  return sample;
}

Hypothesis bestHypothesis(const DiagnosisSample& sample) {
  const Diagnosis diagnosis = diagnose(sample);
  return diagnosis.explained() ? diagnosis.tried[diagnosis.best] : Hypothesis{"none", "", "", 0, 0};
}

void expectCause(const Damage& damage, const std::string& cause, const std::string& text) {
  for (const DiagnosisSample& sound : {ellipsoid(), fittedEllipsoid()}) {
    const Hypothesis found = bestHypothesis(damaged(sound, damage));
    EXPECT_EQ(found.cause, cause) << text;
    EXPECT_NE(found.what.find(text), std::string::npos) << found.what;
    EXPECT_LT(found.error, 0.08);
  }
}

}  // namespace

// Squares of such numbers overflow a float or are zero.
TEST(Diagnose, HugeTinyAndMissingNumbersAreWrongAndEndNothing) {
  for (const float factor : {1e-45F, 1e-30F, 1e25F, 3e37F, float(INFINITY), float(NAN)})
    for (const DiagnosisSample& whole : {ellipsoid(), fittedEllipsoid()}) {
      const DiagnosisSample sample = damaged(whole, [&](LobeUvs uvs) {
        uvs.second = {uvs.second.x * factor, uvs.second.y * factor};
        return uvs;
      });
      const Diagnosis diagnosis = diagnose(sample);
      for (const Hypothesis& one : diagnosis.tried) EXPECT_TRUE(one.error >= 0 && one.error <= 2) << factor << ' ' << one.what;
      EXPECT_GT(diagnosis.tried.front().error, 0.3) << factor;
    }
}

TEST(Diagnose, SoundLobesNeedNoExplanation) {
  EXPECT_EQ(bestHypothesis(ellipsoid()).cause, "none");
  EXPECT_EQ(bestHypothesis(fittedEllipsoid()).cause, "none");
  EXPECT_EQ(bestHypothesis(ellipsoid(0)).cause, "none");
  EXPECT_EQ(bestHypothesis(ellipsoid(0.4F)).cause, "none") << "noise is no change of the whole";
}

TEST(Diagnose, ErrorsOfVertices) {
  DiagnosisSample sample;
  sample.truth = {{{1, 0, 0}, 2}, {{1, 0, 0}, 2}, {{1, 0, 0}, 2}, {{1, 0, 0}, 0}};
  const std::vector<double> errors = vertexErrors({{{1, 0, 0}, 2}, {{-1, 0, 0}, 2}, {{1, 0, 0}, 1}, {{0, 1, 0}, 0}}, sample);
  EXPECT_DOUBLE_EQ(errors[0], 0);
  EXPECT_DOUBLE_EQ(errors[1], 2);
  EXPECT_NEAR(errors[2], 2.0 / 3, 1e-6);
  EXPECT_DOUBLE_EQ(errors[3], 0) << "without thickness a direction means nothing";
}

TEST(Diagnose, FlippedV) {
  expectCause(
      [](LobeUvs l) {
        return LobeUvs{{l.first.x, 1 - l.first.y}, {l.second.x, 1 - l.second.y}};
      },
      "v-flipped", "in both sets (1 - v)");
  expectCause([](LobeUvs l) { return LobeUvs{{l.first.x, 1 - l.first.y}, l.second}; }, "v-flipped", "in the first set");
  expectCause([](LobeUvs l) { return LobeUvs{l.first, {l.second.x, 1 - l.second.y}}; }, "v-flipped", "in the second set");
}

TEST(Diagnose, SwappedSetsAndChannels) {
  expectCause([](LobeUvs l) { return LobeUvs{l.second, l.first}; }, "sets-swapped", "the two UV sets are swapped");
  expectCause([](LobeUvs l) { return LobeUvs{{l.first.y, l.first.x}, {l.second.y, l.second.x}}; }, "channels-swapped", "in both sets");
  expectCause([](LobeUvs l) { return LobeUvs{{l.first.y, l.first.x}, l.second}; }, "channels-swapped", "(o.x, o.y)");
  expectCause([](LobeUvs l) { return LobeUvs{l.first, {l.second.y, l.second.x}}; }, "channels-swapped", "(o.z, d)");
}

TEST(Diagnose, HandednessAndAxes) {
  expectCause([](LobeUvs l) { return LobeUvs{{-l.first.x, l.first.y}, l.second}; }, "handedness", "o.x is negated");
  expectCause([](LobeUvs l) { return LobeUvs{{l.first.x, -l.first.y}, l.second}; }, "handedness", "o.y is negated");
  expectCause([](LobeUvs l) { return LobeUvs{l.first, {-l.second.x, l.second.y}}; }, "handedness", "o.z is negated");
  expectCause([](LobeUvs l) { return LobeUvs{{-l.first.x, -l.first.y}, {-l.second.x, l.second.y}}; }, "inverted", "out of the cloud");
  // Stored as the right (x, z, -y): +Z up seen as +Y up.
  expectCause([](LobeUvs l) { return LobeUvs{{l.first.x, l.second.x}, {-l.first.y, l.second.y}}; }, "axes", "it should be (x, -z, y)");
}

TEST(Diagnose, UnitsAloneAndWithAxes) {
  expectCause([](LobeUvs l) { return LobeUvs{l.first, {l.second.x, l.second.y / 100}}; }, "units", "d is 0.01");
  expectCause(
      [](LobeUvs l) {
        return LobeUvs{{l.first.x, l.second.x}, {-l.first.y, 3 * l.second.y}};
      },
      "units", "it should be (x, -z, y), and d is 3");
}

TEST(Diagnose, UnitsOfASingleVertex) {
  DiagnosisSample sample;
  sample.truth = {{*normalized(Vec3{0.6F, 0.2F, 0.7F}), 2}};
  sample.to_scene = {Affine{}};
  sample.stored = {packLobe({sample.truth[0].direction, 200}, Affine{})};
  sample.pieces = {0};
  EXPECT_EQ(bestHypothesis(sample).cause, "units");
}

TEST(Diagnose, FlippedVOnOtherAxes) {
  expectCause(
      [](LobeUvs l) {
        return LobeUvs{{l.first.x, 1 - l.second.x}, {-l.first.y, 1 - l.second.y}};
      },
      "v-flipped", "and then o has other axes than the positions: it should be (x, -z, y)");
  expectCause([](LobeUvs l) { return LobeUvs{{-l.first.x, 1 - l.first.y}, {l.second.x, 1 - 50 * l.second.y}}; }, "v-flipped", "and d is 5");
}

TEST(Diagnose, NodeAppliedToVerticesAlone) {
  for (DiagnosisSample sample : {ellipsoid(), fittedEllipsoid()}) {
    for (size_t v = 0; v < sample.stored.size(); ++v) {  // what was under a node that turned by 40° is in scene space now
      const Lobe lobe = unpackLobe(sample.stored[v], sample.to_scene[v]);
      sample.to_scene[v] = {};
      sample.stored[v] = packLobe(lobe, turnAboutZ(-40));
    }
    const Hypothesis found = bestHypothesis(sample);
    EXPECT_EQ(found.cause, "node-transform");
    EXPECT_NE(found.what.find("turned by 40"), std::string::npos) << found.what;
    EXPECT_EQ(found.what.find("unevenly"), std::string::npos) << found.what;
  }
}

TEST(Diagnose, NodeThatStretches) {
  DiagnosisSample sample = ellipsoid();
  for (Affine& node : sample.to_scene) node = {};  // the stretch and the turn of the node are lost to the lobes
  const Hypothesis found = bestHypothesis(sample);
  EXPECT_EQ(found.cause, "node-transform");
  EXPECT_NE(found.what.find("unevenly"), std::string::npos) << found.what;
}

TEST(Diagnose, NodeThatMirrorsAndScales) {
  DiagnosisSample sample = ellipsoid();
  Affine node = turnAboutZ(40);
  for (auto& row : node.linear) row[0] *= -2, row[1] *= 2, row[2] *= 2;
  for (size_t v = 0; v < sample.stored.size(); ++v) {
    const Lobe lobe = unpackLobe(sample.stored[v], sample.to_scene[v]);
    sample.to_scene[v] = {};
    sample.stored[v] = packLobe(lobe, *inverted(node));
  }
  const Hypothesis found = bestHypothesis(sample);
  EXPECT_EQ(found.cause, "node-transform");
  EXPECT_NE(found.what.find("turned by 180 degrees, scaled by 2, mirrored)"), std::string::npos) << found.what;
}

TEST(Diagnose, JoinedNodesEachWithItsOwn) {
  DiagnosisSample sample = ellipsoid();
  for (size_t v = 0; v < sample.stored.size(); ++v) {
    const Lobe lobe = unpackLobe(sample.stored[v], sample.to_scene[v]);
    sample.to_scene[v] = {};
    sample.stored[v] = packLobe(lobe, turnAboutZ(sample.pieces[v] ? 70 : -60));
  }
  const Hypothesis found = bestHypothesis(sample);
  EXPECT_EQ(found.cause, "node-transform");
  EXPECT_NE(found.what.find("a different one for each piece"), std::string::npos) << found.what;
}

TEST(Diagnose, RescaledUvs) {
  const auto scaled = [](LobeUvs l) {
    return LobeUvs{{l.first.x / 2 + 0.5F, l.first.y / 2 + 0.5F}, {l.second.x / 8 + 0.1F, l.second.y / 8 + 0.2F}};
  };
  expectCause(scaled, "rescaled", "o.x = 2 stored -1");
}

TEST(Diagnose, LobesOfAnotherMeshHaveNoExplanation) {
  DiagnosisSample sample = ellipsoid();
  std::vector<LobeUvs> shuffled = sample.stored;
  for (size_t v = 0; v < shuffled.size(); ++v) shuffled[v] = sample.stored[mix64(v) % shuffled.size()];
  sample.stored = shuffled;
  const Diagnosis diagnosis = diagnose(sample);
  EXPECT_FALSE(diagnosis.explained());
  EXPECT_GT(diagnosis.tried.front().error, 0.8);
  EXPECT_LT(diagnosis.tried.front().right, 0.1);
}

TEST(Diagnose, ALocalChangeHasNoExplanation) {
  DiagnosisSample sample = ellipsoid();
  for (size_t v = 0; v < 80; ++v) sample.stored[v] = sample.stored[200];
  const Diagnosis diagnosis = diagnose(sample);
  EXPECT_FALSE(diagnosis.explained());
  EXPECT_NEAR(diagnosis.tried.front().right, 160.0 / kPoints, 0.1);
}

TEST(Diagnose, LinearMapDespiteOutliers) {
  Affine map = turnAboutZ(25);
  for (auto& row : map.linear) row[1] *= -3;
  std::vector<Vec3> from = sphereDirections(100), to;
  for (const Vec3& v : from) to.push_back(transformVector(map, v));
  for (size_t v = 0; v < to.size(); v += 5) to[v] = -to[v];
  const auto found = linearMapBetween(from, to);
  ASSERT_TRUE(found);
  for (size_t r = 0; r < 3; ++r)
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(found->linear[r][c], map.linear[r][c], 0.05);
  EXPECT_FALSE(linearMapBetween({{1, 0, 0}, {0, 1, 0}}, {{1, 0, 0}, {0, 1, 0}})) << "they do not span space";
}

TEST(Diagnose, NearestRotation) {
  Affine map = turnAboutZ(25);
  for (auto& row : map.linear)
    for (double& x : row) x *= 7;
  const Affine turn = nearestRotation(map), right = turnAboutZ(25);
  for (size_t r = 0; r < 3; ++r)
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(turn.linear[r][c], right.linear[r][c], 1e-12);
  Affine skewed = turnAboutZ(25);
  skewed.linear[0][2] = 0.1;
  const Affine r = nearestRotation(skewed);
  EXPECT_NEAR(determinant(r), 1, 1e-12);
  const Affine back = compose(*inverted(r), r);
  EXPECT_NEAR(back.linear[0][0] + back.linear[1][1] + back.linear[2][2], 3, 1e-12);
  EXPECT_NEAR(length(transformVector(r, {1, 0, 0})), 1, 1e-6);
}
