// Memory for the fuzz targets of the readers. A gigabyte is refused as a system would refuse it, where a sanitizer would end the program:
// OpenVDB asks for what a file declares, and its reader must live with that. Any other reader that believes a count lets std::bad_alloc
// pass, and fails.
#include <cstdlib>
#include <new>

static void* allocate(size_t bytes) noexcept { return bytes < size_t(1) << 30 ? std::malloc(bytes) : nullptr; }
static void* allocateOrThrow(size_t bytes) {
  if (void* block = allocate(bytes)) return block;
  throw std::bad_alloc();
}
void* operator new(size_t bytes) { return allocateOrThrow(bytes); }
void* operator new[](size_t bytes) { return allocateOrThrow(bytes); }
void* operator new(size_t bytes, const std::nothrow_t&) noexcept { return allocate(bytes); }
void* operator new[](size_t bytes, const std::nothrow_t&) noexcept { return allocate(bytes); }
void operator delete(void* block) noexcept { std::free(block); }
void operator delete[](void* block) noexcept { std::free(block); }
void operator delete(void* block, size_t) noexcept { std::free(block); }
void operator delete[](void* block, size_t) noexcept { std::free(block); }
