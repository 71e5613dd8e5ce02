// A glTF as read: its document, tinygltf's model of its geometry, and its parts. Only for io/gltf.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/file/read_settings.h"
#include "io/gltf/document.h"
#include "io/gltf/sculpt/bundles.h"
#include "io/gltf/tinygltf.h"

namespace cloudbake {

struct LoadedGltf {
  std::shared_ptr<GltfDocument> document;
  tinygltf::Model model;
  GltfBundles bundles;             ///< of the model
  Sculpt sculpt;                   ///< parts in order of document->places
  std::vector<std::string> notes;  ///< what a reader of the report needs to know beside the frame
};

/// Reads like readGltf, with the same errors and warnings, but without images.
LoadedGltf loadGltf(const std::filesystem::path& file, std::string_view bytes, const ReadSettings& settings, Warnings& warnings);

/// The geometry of a plain document, with its buffers.
tinygltf::Model parseGeometry(const std::filesystem::path& file, const Json& json, GltfBuffers buffers);

}  // namespace cloudbake
