// Adds textures that keep UV sets from being removed by optimisers. Only for io/gltf.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "io/gltf/document.h"
#include "io/gltf/gltf_settings.h"

namespace cloudbake {

/// Binds a white texture to UV sets `set`, `set`+1 and any lower set that no texture uses, in the material of each primitive of
/// `primitives`. It uses free slots in which white changes nothing. If primitives without the sets use the same material, the material is
/// copied first. `texture` is the white texture that the document already has, or −1. `add_image` stores a PNG and returns its buffer view.
/// A material with too few such slots stays unchanged and counts kKeepAlive.
void bindKeepAliveTextures(Json& json, const std::vector<GltfPrimitive>& primitives, int set, KeepAliveTexture mode, int texture,
                           const std::function<int(std::string_view)>& add_image, const std::string& file, Warnings& warnings);

/// The bytes of the white image.
std::string_view whitePng();

}  // namespace cloudbake
