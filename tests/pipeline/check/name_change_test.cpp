// Lobes are changed in ways that no single hypothesis undoes, and the way is named.
#include "pipeline/check/name_change.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/random.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace cloudbake {
namespace {

constexpr size_t kVertices = 1000;

float draw(size_t v, uint32_t i) { return uniformFloat(hashDraw(17, uint32_t(v), i)); }

std::vector<Lobe> rightLobes() {
  std::vector<Lobe> lobes;
  for (size_t v = 0; v < kVertices; ++v)
    lobes.push_back({*normalized({draw(v, 0) - 0.5F, draw(v, 1) - 0.5F, draw(v, 2) - 0.5F}), 0.5F + draw(v, 3)});
  return lobes;
}

// `change(lobe, vertex)` of every lobe; every third vertex is looked at.
struct Changed {
  std::vector<Lobe> stored, right;
  std::vector<size_t> vertices;
  std::vector<double> errors;
  ChangedLobes view(bool same_mesh = false) const { return {stored, vertices, right, errors, same_mesh}; }
};
Changed changed(const auto& change) {
  Changed result;
  const std::vector<Lobe> lobes = rightLobes();
  for (size_t v = 0; v < kVertices; ++v) result.stored.push_back(change(lobes[v], v));
  for (size_t v = 0; v < kVertices; v += 3) {
    result.vertices.push_back(v);
    result.right.push_back(lobes[v]);
    result.errors.push_back(length(result.stored[v].direction * result.stored[v].thickness - lobes[v].direction * lobes[v].thickness));
  }
  return result;
}
std::string causeOf(const Changed& lobes, bool same_mesh = false) { return nameChange(lobes.view(same_mesh)).cause; }
std::string whatOf(const Changed& lobes, bool same_mesh = false) { return nameChange(lobes.view(same_mesh)).what; }

TEST(NameChange, ThicknessAlone) {
  const Changed wrong = changed([](Lobe lobe, size_t v) { return Lobe{lobe.direction, v % 2 ? lobe.thickness : 3 * lobe.thickness}; });
  EXPECT_EQ(causeOf(wrong), "thickness");
  EXPECT_TRUE(contains(whatOf(wrong), "o is right, but d is wrong at 50 % of the vertices")) << whatOf(wrong);
  const Changed zero = changed([](Lobe lobe, size_t v) { return Lobe{lobe.direction, v % 10 ? lobe.thickness : 0}; });
  EXPECT_TRUE(contains(whatOf(zero), "d is 0 at 10")) << whatOf(zero);
  const std::vector<Lobe> right = rightLobes();
  const Changed swapped = changed([&](Lobe lobe, size_t v) { return Lobe{lobe.direction, right[(v + 501) % kVertices].thickness}; });
  EXPECT_EQ(causeOf(swapped), "thickness");
  EXPECT_TRUE(contains(whatOf(swapped), "d is that of other vertices")) << whatOf(swapped);
}

TEST(NameChange, OneThicknessForAll) {
  const Changed constant = changed([](Lobe lobe, size_t) { return Lobe{lobe.direction, 1}; });
  const Changed tiny = changed([](Lobe lobe, size_t v) { return Lobe{lobe.direction, v % 3 ? 1e-45F : 0}; });
  EXPECT_TRUE(nameConstant(tiny.view()).has_value()) << "the same but for what rounding leaves of it";
  const auto named = nameConstant(constant.view());
  ASSERT_TRUE(named);
  EXPECT_EQ(named->cause, "thickness");
  EXPECT_FALSE(nameConstant(changed([](Lobe lobe, size_t) { return lobe; }).view()));
  EXPECT_FALSE(nameConstant(changed([](Lobe lobe, size_t) { return Lobe{lobe.direction, -lobe.thickness}; }).view()));
  Changed of_a_ball = constant;
  for (Lobe& lobe : of_a_ball.right) lobe.thickness = 1;
  EXPECT_FALSE(nameConstant(of_a_ball.view())) << "where all are the same, that is right";
}

TEST(NameChange, DirectionAlone) {
  const Changed noisy = changed([](Lobe lobe, size_t v) {
    const Frame frame = frameAround(lobe.direction);
    const float angle = 6 * draw(v, 9), tangent = std::tan(float(20 * kPi / 180));
    return Lobe{*normalized(lobe.direction + tangent * (std::cos(angle) * frame.tangent + std::sin(angle) * frame.bitangent)),
                lobe.thickness};
  });
  EXPECT_EQ(causeOf(noisy), "direction");
  EXPECT_TRUE(contains(whatOf(noisy), "o is off by 20° (median) at 100 % of the vertices")) << whatOf(noisy);
  const Changed inverted = changed([](Lobe lobe, size_t v) { return v % 20 ? lobe : Lobe{-lobe.direction, lobe.thickness}; });
  EXPECT_EQ(causeOf(inverted), "direction");
  EXPECT_TRUE(contains(whatOf(inverted), "o points out of the cloud at 5.09 % of the vertices")) << whatOf(inverted);
}

TEST(NameChange, OtherVertices) {
  const std::vector<Lobe> right = rightLobes();
  const Changed moved_on = changed([&](Lobe, size_t v) { return right[(v + 1) % kVertices]; });
  EXPECT_EQ(causeOf(moved_on), "permuted");
  EXPECT_TRUE(contains(whatOf(moved_on), "100 % of the right ones are there, but elsewhere")) << whatOf(moved_on);
}

// Nine tenths of the right lobes are found elsewhere: that is enough only if the mesh is known to be the same.
TEST(NameChange, OtherVerticesOfAMeshThatIsTheSame) {
  const std::vector<Lobe> right = rightLobes();
  const Changed most = changed([&](Lobe, size_t v) {
    Lobe lobe = right[(v + 1) % kVertices];
    if (v % 10 == 0) lobe.thickness += 5;
    return lobe;
  });
  EXPECT_EQ(causeOf(most), "stale");
  EXPECT_TRUE(contains(whatOf(most), "or the mesh has changed since the bake")) << whatOf(most);
  EXPECT_EQ(causeOf(most, true), "permuted");
}

TEST(NameChange, APart) {
  const std::vector<Lobe> right = rightLobes();
  const Changed part = changed([&](Lobe lobe, size_t v) { return v < 300 ? Lobe{-lobe.direction, 2 * lobe.thickness} : lobe; });
  EXPECT_EQ(causeOf(part), "part");
  EXPECT_TRUE(contains(whatOf(part), "wrong at 29.9 % of the vertices")) << whatOf(part);
  EXPECT_TRUE(contains(whatOf(part), "or the mesh was changed there")) << whatOf(part);
  EXPECT_FALSE(contains(whatOf(part, true), "or the mesh")) << whatOf(part, true);
}

TEST(NameChange, AnotherMesh) {
  const Changed other = changed([](Lobe, size_t v) {
    return Lobe{*normalized({draw(v, 10) - 0.5F, draw(v, 11) - 0.5F, draw(v, 12) - 0.5F}), 0.5F + draw(v, 13)};
  });
  EXPECT_EQ(causeOf(other), "stale");
  EXPECT_TRUE(contains(whatOf(other), "another mesh, or the mesh has changed")) << whatOf(other);
  EXPECT_FALSE(contains(whatOf(other, true), "has changed")) << whatOf(other, true);
}

}  // namespace
}  // namespace cloudbake
