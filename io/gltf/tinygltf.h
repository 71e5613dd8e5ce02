// Includes tinygltf in its own namespace, without images. Only io/gltf includes this file.
//
// Debian's libdraco, which assimp depends on, exports the symbols of an older tinygltf with different layouts. Which copy a program got
// would depend on the order of its libraries. Compiled here under another name, there is only one copy.
#pragma once

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#define TINYGLTF_NO_INCLUDE_JSON
#define tinygltf cloudbake_tinygltf

#include <nlohmann/json.hpp>

#define json ordered_json  // as our Json, so that the code of one kind of JSON is enough
#include <tiny_gltf.h>
#undef json
