#include "io/file/deflate.h"

#include <zlib.h>

#include <new>

namespace cloudbake {

std::string deflated(std::string_view bytes, int level) {
  uLongf size = compressBound(bytes.size());
  std::string result(size, '\0');
  const int outcome =
      compress2(reinterpret_cast<Bytef*>(result.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), level);
  if (outcome != Z_OK) throw std::bad_alloc();  // the only thing that can go wrong
  result.resize(size);
  return result;
}

uint32_t checksum(std::string_view bytes) { return uint32_t(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size())); }

}  // namespace cloudbake
