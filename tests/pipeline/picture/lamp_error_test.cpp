// What comes of a lamp's light through a cloud, by its lobes, against exact chords from every vertex to the lamp: the figures of
// docs/lobe_math.md.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "bake/truth/reference.h"
#include "core/lobe_lighting.h"
#include "pipeline/picture/picture.h"
#include "preview/mesh_clouds/lit_mesh.h"
#include "tests/folders.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

/// rms over the vertices of T of the lobe, with and without the limit by the distance, and what the rms of T itself is.
struct LampErrors {
  double limited = 0, unlimited = 0, mean = 0;
};

template <typename Length>
LampErrors errorsOf(const BakedMesh& mesh, Vec3 lamp, const Length& length_to) {
  Instance instance;
  instance.mesh = &mesh;
  const float extinction = worldExtinction(instance, {});
  LampErrors errors;
  for (size_t v = 0; v < mesh.lobes.size(); ++v) {
    const Vec3 way = lamp - mesh.surface.positions[v], to_lamp = way / length(way);
    const double truth = std::exp(-double(extinction) * length_to(mesh.surface.positions[v], to_lamp, double(length(way))));
    const auto off = [&](float found) { return (double(found) - truth) * (double(found) - truth); };
    errors.limited += off(lampTransmittance(mesh.lobes[v], to_lamp, length(way), mesh.info.shape, extinction));
    errors.unlimited += off(lobeTransmittance(mesh.lobes[v], to_lamp, mesh.info.shape, extinction));
    errors.mean += truth;
  }
  const auto count = double(mesh.lobes.size());
  return {std::sqrt(errors.limited / count), std::sqrt(errors.unlimited / count), errors.mean / count};
}

BakedMesh bakedAs(const std::filesystem::path& input, std::vector<std::string> texts) {
  BakeReport report;
  const SourceKind kind = sourceKindOf(input);
  texts.emplace_back("fit-to=transmittance");
  return bakedMesh(sourceOf(kind, input), options(texts, isGrown(kind) ? kGrow : kBake), report);
}

// Distances from the centre in halves of the longest side. At the last one the light is nearly parallel.
constexpr float kDistances[] = {0, 0.5F, 0.9F, 1.3F, 2, 4, 100};

void printRow(const char* name, float distance, const LampErrors& e) {
  std::printf("%s, lamp at %g: rms of T %.3f, without the distance %.3f, mean T %.3f\n", name, double(distance), e.limited, e.unlimited,
              e.mean);
}

// The chord of a ball is known: from a point of it towards l it is −2 n·l, and a lamp inside ends it.
TEST(LampError, OfABallIsThatOfItsLobes) {
  const TestFolder folder;
  const BakedMesh ball = bakedAs(folder.write("ball.obj", objText(ballMesh(1, 4))), {"units=1", "up=y"});
  const Vec3 axis = *normalized(Vec3{0.3F, 0.8F, 0.5F});
  const auto chord = [](Vec3 p, Vec3 l, double away) { return std::min(away, std::max(0.0, -2 * double(dot(p, l)))); };
  double parallel = 0;
  for (const float distance : kDistances) {
    const LampErrors errors = errorsOf(ball, axis * distance, chord);
    printRow("ball", distance, errors);
    EXPECT_LE(errors.limited, errors.unlimited + 1e-9) << "the distance never makes it worse";
    EXPECT_LE(errors.limited, 0.12);
    parallel = errors.limited;
  }
  // In the middle every chord is the distance, which the lobe's thickness is above: there is no error.
  EXPECT_LE(errorsOf(ball, {}, chord).limited, 0.02);
  EXPECT_GE(errorsOf(ball, {}, chord).unlimited, 0.02);
  // Far away a lamp is a sun.
  double sun = 0;
  Instance instance;
  instance.mesh = &ball;
  const float extinction = worldExtinction(instance, {});
  for (size_t v = 0; v < ball.lobes.size(); ++v) {
    const double truth = std::exp(-double(extinction) * chord(ball.surface.positions[v], axis, INFINITY));
    const double off = double(lobeTransmittance(ball.lobes[v], axis, ball.info.shape, extinction)) - truth;
    sun += off * off;
  }
  EXPECT_NEAR(parallel, std::sqrt(sun / double(ball.lobes.size())), 2e-3);
}

TEST(LampError, OfCloudsIsSmallerWithTheDistance) {
  const std::pair<const char*, BakedMesh> clouds[] = {
      {"hero", bakedAs("hero", {"vertices=6000"})},
      {"wuson.obj", bakedAs(sourceFolder() / "data/sculpts/wuson.obj", {"repair=orient,fill"})}};
  for (const auto& [name, mesh] : clouds) {
    const auto reference = meshReference(mesh.surface);
    const Box box = drawnBox(mesh.surface);
    const Vec3 axis = *normalized(Vec3{0.3F, 0.8F, 0.5F});
    for (const float distance : kDistances) {
      const Vec3 lamp = box.center() + axis * (distance * box.longestSide() / 2);
      const LampErrors errors = errorsOf(mesh, lamp, [&](Vec3 p, Vec3 l, double away) { return reference->insideLength({p, l}, away); });
      printRow(name, distance, errors);
      EXPECT_LE(errors.limited, errors.unlimited + 1e-9) << name << " " << distance;
      EXPECT_LE(errors.limited, 0.35) << name << " " << distance;
    }
  }
}

}  // namespace
}  // namespace cloudbake
