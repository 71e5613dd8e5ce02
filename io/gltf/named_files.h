// The files that a glTF names, and the types of images.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace cloudbake {

/// The paths of buffers and images that a .gltf or .glb refers to, in their order, whether they exist or not. None for a damaged file.
std::vector<std::filesystem::path> filesNamedByGltf(const std::filesystem::path& file, std::string_view bytes);

/// Decodes percent-encoding (%41 → A, RFC 3986).
std::string percentDecoded(std::string_view uri);

/// The MIME type of an image, recognised by its first bytes, for the types of glTF and its extensions; empty for others.
std::string_view imageMimeType(std::string_view bytes);

}  // namespace cloudbake
