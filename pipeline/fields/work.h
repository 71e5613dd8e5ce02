// Estimates roughly what time and memory a stage will take, for the user who waits.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "core/types.h"

namespace cloudbake {

struct FieldSettings;

struct StageWork {
  std::string what;              ///< "the level set of 3000 voxels along the longest side"
  double processor_seconds = 0;  ///< on one thread of a usual processor
  double bytes = 0;              ///< of memory
};

/// The level set of spheres and its surface.
StageWork levelSetWork(std::span<const Sphere> spheres, const FieldSettings& settings);
/// A mesh of about so many triangles with edges of one length.
StageWork remeshWork(double triangles);
/// A sweep of so many directions over a box.
StageWork sweepWork(const Box& box, double voxel_size, int directions, size_t vertices);

}  // namespace cloudbake
