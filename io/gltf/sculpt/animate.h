// Poses a glTF as one of its animations has it at a moment. Only for io/gltf/sculpt.
#pragma once

#include <filesystem>
#include <span>

#include "core/warnings.h"
#include "io/file/read_settings.h"
#include "io/gltf/nodes.h"

namespace cloudbake {

/// Gives the nodes their transforms and morph weights at a moment, in the document and in its model. `placed` is the scene. Returns how
/// long the animation is, in seconds. Counts kPoseIgnored for channels that move no node. Throws InputError if the file has no animation,
/// or none of that name, if it is damaged, or if it moves nothing that the scene draws.
double poseByAnimation(const std::filesystem::path& file, const AnimationMoment& moment, std::span<const PlacedNode> placed, Json& json,
                       tinygltf::Model& model, Warnings& warnings);

}  // namespace cloudbake
