// ZIP archives.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "io/file/deflate.h"

namespace cloudbake {

/// Every second file is deflated.
inline std::string zipOf(const std::vector<std::pair<std::string, std::string>>& files) {
  const auto number = [](uint64_t value, size_t size) {
    std::string bytes;
    for (size_t i = 0; i < size; ++i) bytes += char(value >> (8 * i));
    return bytes;
  };
  std::string zip, directory;
  bool packs = false;
  for (const auto& [name, bytes] : files) {
    const std::string zlib = deflated(bytes), stored = packs ? zlib.substr(2, zlib.size() - 6) : bytes;  // without zlib's own header
    const std::string common = number(20, 2) + number(0, 2) + number(packs ? 8 : 0, 2) + number(0, 4) + number(checksum(bytes), 4) +
                               number(stored.size(), 4) + number(bytes.size(), 4) + number(name.size(), 2) + number(0, 2);
    directory +=
        "PK\1\2" + number(20, 2) + common + number(0, 2) + number(0, 2) + number(0, 2) + number(0, 4) + number(zip.size(), 4) + name;
    zip += "PK\3\4" + common + name + stored;
    packs = !packs;
  }
  const uint64_t begin = zip.size();
  return zip + directory + "PK\5\6" + number(0, 4) + number(files.size(), 2) + number(files.size(), 2) + number(directory.size(), 4) +
         number(begin, 4) + number(0, 2);
}

}  // namespace cloudbake
