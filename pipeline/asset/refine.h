// Adds vertices to a sculpt where lobes that are blended between its vertices are wrong (--refine).
#pragma once

#include "io/report/report.h"
#include "pipeline/fields/cloud.h"
#include "pipeline/fields/stopwatch.h"
#include "pipeline/options/settings.h"

namespace cloudbake {

/// Splits edges of the sculpt until blending adds as little to the error of T as settings.mesh.refine allows, or settings.mesh.vertices is
/// reached (unset: kMostRefinedVertices). The lobes are those of the bake's own method, field and fit, without --smooth. The surface stays
/// where it is; new vertices and all that they carry lie halfway between others (SculptPart::midpoints). Then edges of parts with normals
/// are split until those that an engine blends turn by at most 2/255 of a radian from where they were. Nothing changes without the
/// setting, or if the target is already met. Counts kPartNotRefined and kRefineTarget.
void refineCloud(Cloud& cloud, const Settings& settings, BakeReport& report, Stopwatch& watch);

inline constexpr size_t kMostRefinedVertices = 1'000'000;

}  // namespace cloudbake
