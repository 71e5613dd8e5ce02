// Loads the buffers of a glTF. Only for io/gltf/sculpt.
#pragma once

#include <filesystem>
#include <string_view>

#include "io/file/read_settings.h"
#include "io/gltf/document.h"

namespace cloudbake {

/// The bytes of all buffers: from `binary`, the binary chunk, from files beside or below `file`, and from data URIs. A buffer that only
/// says how large its decoded data is (of meshopt) stays empty. Throws IoError for a file that cannot be read, and InputError for a
/// damaged buffer, a file outside the folder (unless settings.allow_outside), and more bytes than settings.memory_limit.
GltfBuffers loadBuffers(const std::filesystem::path& file, const Json& json, std::string_view binary, const ReadSettings& settings);

}  // namespace cloudbake
