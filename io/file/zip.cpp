// PKWARE's APPNOTE: the archive ends with the record of its directory (4.3.16), whose entries (4.3.12) give the places of the files; before
// a file's bytes is a header of its own (4.3.7). All numbers are little-endian. Sizes of 4 GiB and more (Zip64) are not read.
#include "io/file/zip.h"

#include <algorithm>

#include "core/little_endian.h"
#include "io/file/deflate.h"

namespace cloudbake {

namespace {

constexpr std::string_view kEndMark = "PK\5\6", kEntryMark = "PK\1\2", kFileMark = "PK\3\4";
constexpr size_t kEnd_bytes = 22, kEntry_bytes = 46, kFile_bytes = 30, kLongestComment = 65535;

uint64_t whole(std::string_view bytes, size_t at, size_t size) { return fromLittleEndian(bytes.substr(at, size)); }

// The bytes of a file as they are packed, behind its header.
std::optional<std::string_view> packedBytes(std::string_view zip, uint64_t header, uint64_t size) {
  if (header > zip.size() || zip.size() - header < kFile_bytes || !zip.substr(header).starts_with(kFileMark)) return std::nullopt;
  const uint64_t begin = header + kFile_bytes + whole(zip, header + 26, 2) + whole(zip, header + 28, 2);
  if (begin > zip.size() || zip.size() - begin < size) return std::nullopt;
  return zip.substr(begin, size);
}

}  // namespace

std::optional<std::string> fileInZip(std::string_view zip, std::string_view name, uint64_t limit) {
  if (zip.size() < kEnd_bytes) return std::nullopt;
  const size_t last = zip.size() - kEnd_bytes, end = zip.rfind(kEndMark, last);
  if (end == std::string_view::npos || last - end > kLongestComment) return std::nullopt;
  uint64_t at = whole(zip, end + 16, 4);
  for (uint64_t left = whole(zip, end + 10, 2); left > 0; --left) {
    if (at > end || end - at < kEntry_bytes || !zip.substr(at).starts_with(kEntryMark)) return std::nullopt;
    const uint64_t flags = whole(zip, at + 8, 2), method = whole(zip, at + 10, 2), packed = whole(zip, at + 20, 4);
    const uint64_t size = whole(zip, at + 24, 4), name_size = whole(zip, at + 28, 2), header = whole(zip, at + 42, 4);
    const std::string_view stored_name = zip.substr(at + kEntry_bytes, name_size);
    at += kEntry_bytes + name_size + whole(zip, at + 30, 2) + whole(zip, at + 32, 2);
    if (stored_name != name) continue;
    const auto bytes = packedBytes(zip, header, packed);
    if (!bytes || (flags & 1) != 0 || size > limit) return std::nullopt;
    if (method == 0) return size == packed ? std::optional(std::string(*bytes)) : std::nullopt;
    return method == 8 ? inflated(*bytes, size) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace cloudbake
