// The functions of tinyobjloader, of which io/sculpt/read_mtl.cpp uses one. Debian has them compiled, but not for WebAssembly, and not as a
// static library.
#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>
