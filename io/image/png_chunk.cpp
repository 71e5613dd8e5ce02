#include "io/image/png_chunk.h"

#include "io/file/deflate.h"

namespace cloudbake {

std::string pngChunk(std::string_view kind, std::string_view data) {
  std::string chunk;
  chunk.reserve(12 + data.size());
  appendBigEndian(chunk, uint32_t(data.size()));
  chunk.append(kind).append(data);
  appendBigEndian(chunk, checksum(std::string_view(chunk).substr(4)));
  return chunk;
}

}  // namespace cloudbake
