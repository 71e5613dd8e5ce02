// --target-error: the cheapest sweep that keeps an error. --scene: what a camera and a sun need.
#pragma once

#include <optional>

#include "io/report/report.h"
#include "pipeline/fields.h"

namespace cloudbake {

/// Chooses settings.bake.rays and settings.bake_voxels so that the bake keeps settings.target_error at least cost, as measured on a sample
/// of vertices against exact chords; says what it chose in `report.target`. Throws Error with ExitCode::kBound where nothing within reach
/// keeps it. Needs the resolved ray length, lobe shape and extinction (`report.info`).
void chooseForTarget(const Scene& scene, Settings& settings, BakeReport& report);

/// The scene of settings.scene or settings.scene_view, if given; sets what it decides and the command line did not: target error (a step of 8 bits) and the fit's
/// sun arc.
std::optional<SceneView> takeSceneView(Settings& settings);

/// Vertices at which an edge spans eight pixels: surface area / (√3/2 · edge²).
size_t vertexBudget(const SceneView& view, const SurfaceMesh& mesh);

}  // namespace cloudbake
