// Textures that keep UV sets alive. Only for io/gltf_*.cpp.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "io/gltf/document.h"

namespace cloudbake {

/// Binds a white texture to UV set `set`, `set`+1 and any lower set that no texture uses, in the material of each primitive of
/// `places`, in slots that are free and where white changes nothing. A material that primitives without the sets use too is copied
/// first. `add_image` stores a PNG and returns its buffer view. A material with too few such slots stays as it is: kKeepAlive.
void bindKeepAliveTextures(Json& json, const std::vector<GltfPlace>& places, int set, KeepAliveTexture mode,
                           const std::function<int(std::string_view)>& add_image, const std::string& file, Warnings& warnings);

}  // namespace cloudbake
