// --target-error on shapes of few cells: the bake that was chosen keeps the error at every vertex, not only at those of the sample.
#include "pipeline/lobes/target.h"

#include "bake/lobe/directions.h"
#include "bake/truth/error_metrics.h"
#include "core/lobe_lighting.h"
#include "core/ray_scene.h"
#include "pipeline/lobes/lobes.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

// A lying drop: long enough that many voxels along it are few cells.
SurfaceMesh drop(int subdivisions = 3) {
  SurfaceMesh mesh = ballMesh(1, subdivisions);
  for (Vec3& p : mesh.positions) p = {4 * p.x, p.y, p.z * (1 + 0.3F * p.x)};
  mesh.normals.clear();
  return mesh;
}

struct Kept {
  BakeParameters parameters;
  LobeError error;
  double transmittance_rms = 0;
};

// Chosen, then baked as a whole and measured.
Kept keep(const Cloud& cloud, const std::string& target) {
  const Settings settings = settingsFor({"target-error=" + target});
  Kept kept;
  kept.parameters = parametersFor(cloud, settings);
  Warnings warnings;
  const IntegrationField field = buildField(cloud, fieldSettings(settings.field, kept.parameters), Method::kSweep, warnings);
  EXPECT_NEAR(field.voxelSize(), boundingBox(cloud.surface).longestSide() / float(*kept.parameters.bake_voxels), 1e-6);
  const std::vector<Lobe> lobes = meanLobes({cloud.surface.positions, cloud.surface.normals}, field, kept.parameters.bake, warnings);
  const auto reference = referenceFor(cloud, settings.field);
  const Truth truth = trueLobes(*reference, cloud.surface.positions, fibonacciDirections(2048), *kept.parameters.bake.ray_length);
  kept.error = compareLobes(lobes, truth);
  kept.transmittance_rms =
      compareLobeTransmittance(lobes, truth.lobes, kept.parameters.shape, fibonacciDirections(128), kept.parameters.extinction).rms;
  return kept;
}

TEST(Target, AnAngleIsKept) {
  const Cloud cloud = cloudOf(drop());
  const Kept coarse = keep(cloud, "6"), fine = keep(cloud, "2");
  EXPECT_LE(coarse.error.angle_rms_degrees, 6);
  EXPECT_LE(fine.error.angle_rms_degrees, 2);
  // Cheap, not as good as can be: a loose target is not kept with the effort of a tight one.
  EXPECT_LT(coarse.parameters.bake.rays * *coarse.parameters.bake_voxels, fine.parameters.bake.rays * *fine.parameters.bake_voxels);
  EXPECT_GT(coarse.error.angle_rms_degrees, 1);
  ASSERT_TRUE(fine.parameters.target);
  const TargetReport& report = *fine.parameters.target;
  EXPECT_EQ(report.quantity, "direction rms, degrees");
  EXPECT_EQ(report.target, 2);
  EXPECT_EQ(report.voxels, *fine.parameters.bake_voxels);
  EXPECT_EQ(report.vertices, 256U);
  EXPECT_TRUE(contains(report.truth, RayScene::kName));
  // The sample's error is that of all, within what 256 of them may be off.
  EXPECT_NEAR(report.measured, fine.error.angle_rms_degrees, 0.4);
}

TEST(Target, ATransmittanceIsKept) {
  const Kept kept = keep(cloudOf(drop()), "1%");
  EXPECT_LE(kept.transmittance_rms, 0.01);
  EXPECT_EQ(kept.parameters.target->quantity, "transmittance rms");
  EXPECT_NEAR(kept.parameters.target->measured, kept.transmittance_rms, 0.003);
}

TEST(Target, EverythingElseStaysAsItIs) {
  const Cloud cloud = cloudOf(drop());
  const BakeParameters kept = parametersFor(cloud, settingsFor({"target-error=6", "extinction=3", "ray-length=9", "seed=5"}));
  EXPECT_EQ(kept.extinction, 3);
  EXPECT_EQ(*kept.bake.ray_length, 9);
  EXPECT_EQ(kept.bake.seed, 5U);
  EXPECT_EQ(kept.bake.rays % 2, 0);
}

// A needle of few cells, so that the whole search is quick.
TEST(Target, WhatCannotBeKeptIsABoundThatFails) {
  const Cloud needle = cloudOf(boxMesh({0, 0, 0}, {1, 0.011F, 0.011F}));
  try {
    parametersFor(needle, settingsFor({"target-error=0.05"}));
    ADD_FAILURE() << "kept";
  } catch (const Error& error) {
    EXPECT_EQ(error.code, ExitCode::kBound);
    EXPECT_TRUE(contains(error.message, "the target error of 0.05 (from --target-error or --scene) cannot be met")) << error.message;
    EXPECT_TRUE(contains(error.message, "400 voxels and 4608 directions")) << error.message;
  }
}

}  // namespace
}  // namespace cloudbake
