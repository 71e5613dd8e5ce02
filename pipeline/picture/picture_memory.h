// Estimates the memory of a picture before it is drawn.
#pragma once

#include <span>

#include "pipeline/scene/scene_file.h"
#include "preview/camera.h"

namespace cloudbake {

/// Throws MemoryError if the picture of the scene's view would take more than its memory limit. `instances` are as the camera sees them.
void requirePictureMemory(const SceneFile& scene, std::span<const Instance> instances, const Camera& camera);

/// How many rows of a picture are drawn together, so that the samples of all layers do not fill the memory.
int rowsTogether(const SceneFile& scene, const Camera& camera);

}  // namespace cloudbake
