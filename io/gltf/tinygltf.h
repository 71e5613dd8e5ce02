// tinygltf in a namespace of our own, without images. Only io/gltf_*.cpp and io/gltf/tinygltf.cpp include it.
//
// Debian's libdraco, which comes with assimp, exports the symbols of an older tinygltf with other layouts; which copy a program got
// depended on the order of its libraries. Under another name, compiled here, there is only one.
#pragma once

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#define TINYGLTF_NO_INCLUDE_JSON
#define tinygltf cloudbake_tinygltf

#include <nlohmann/json.hpp>
// tinygltf needs nlohmann/json before it.
#include <tiny_gltf.h>
