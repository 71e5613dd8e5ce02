// Removes the data of an earlier bake from a document. Only for io/gltf.
#pragma once

#include "io/gltf/document.h"

namespace cloudbake {

/// Removes the lobes of a baked asset with their bytes: the two UV sets, _OCCLUSION, spherical harmonics, and the white textures that keep
/// the sets in place. If a texture of the artist's own uses one of the two sets, they are the artist's and stay. Numbers of what remains do
/// not change; places that become free inside an array are listed in the document, which stays valid. Leaves a document without our
/// metadata as it is. Throws Json::exception for a value of a wrong type, InputError for a damaged one.
void removeEarlierBake(GltfDocument& document);

}  // namespace cloudbake
