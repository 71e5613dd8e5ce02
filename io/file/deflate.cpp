#include "io/file/deflate.h"

#include <zlib.h>

#include <algorithm>
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

std::optional<std::string> inflated(std::string_view stream, uint64_t size) {
  constexpr uint64_t kMostPerByte = 1032, kAtOnce = 1 << 30;  // zlib counts in 32 bits
  if (size > kMostPerByte * (stream.size() + 1)) return std::nullopt;
  std::string result(size, '\0');
  z_stream work{};
  if (inflateInit2(&work, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
  int outcome = Z_OK;
  size_t read = 0, written = 0;
  while (outcome == Z_OK) {
    work.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(stream.data() + read));  // zlib does not write to it
    work.avail_in = uInt(std::min<uint64_t>(stream.size() - read, kAtOnce));
    work.next_out = reinterpret_cast<Bytef*>(result.data() + written);
    work.avail_out = uInt(std::min<uint64_t>(size - written, kAtOnce));
    const uInt in = work.avail_in, out = work.avail_out;
    outcome = inflate(&work, Z_NO_FLUSH);
    read += in - work.avail_in, written += out - work.avail_out;
    if (outcome == Z_OK && in == work.avail_in && out == work.avail_out) break;  // it wants more than there is
  }
  inflateEnd(&work);
  if (outcome == Z_MEM_ERROR) throw std::bad_alloc();
  return outcome == Z_STREAM_END && written == size ? std::optional(std::move(result)) : std::nullopt;
}

uint32_t checksum(std::string_view bytes) { return uint32_t(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size())); }

}  // namespace cloudbake
