// Compiles the implementation in tiny_gltf.h (README.Debian of libtinygltf-dev, the second of its two ways).
#include <fstream>

#define TINYGLTF_IMPLEMENTATION
#include "io/gltf/tinygltf.h"
