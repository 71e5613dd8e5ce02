// A glTF as read: its document, what tinygltf made of its geometry, its parts. Only for io/gltf_*.cpp.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "io/gltf/document.h"
#include "io/gltf/tinygltf.h"

namespace cloudbake {

struct LoadedGltf {
  std::shared_ptr<GltfDocument> document;
  tinygltf::Model model;
  Sculpt sculpt;  ///< parts in order of document->places
};

/// What readGltf tells of, images left alone.
LoadedGltf loadGltf(const std::filesystem::path& file, std::string_view bytes, const ReadSettings& settings, Warnings& warnings);

}  // namespace cloudbake
