// The one function of tinyobjloader that io/sculpt/read_mtl.cpp uses. Debian has it compiled, but not for WebAssembly.
#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>
