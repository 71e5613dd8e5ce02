// tinyexr requires one plane per channel, with channels sorted by name as in the format.
#include "io/image/exr.h"

#include <tinyexr.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <vector>

namespace cloudbake {

std::string encodeExr(const Image4& image) {
  const size_t count = size_t(std::max(0, image.width)) * size_t(std::max(0, image.height));
  if (count == 0 || image.pixels.size() != count)
    throw std::invalid_argument("encodeExr: a picture needs width·height pixels, and at least one");
  constexpr std::array<std::pair<char, size_t>, 4> kChannels{{{'A', 3}, {'B', 2}, {'G', 1}, {'R', 0}}};
  std::array<std::vector<float>, kChannels.size()> planes;
  std::array<unsigned char*, kChannels.size()> pointers{};
  std::array<EXRChannelInfo, kChannels.size()> channels{};
  std::array<int, kChannels.size()> types{};
  types.fill(TINYEXR_PIXELTYPE_FLOAT);
  for (size_t c = 0; c < kChannels.size(); ++c) {
    for (const Rgba& pixel : image.pixels) planes[c].push_back(pixel[kChannels[c].second]);
    pointers[c] = reinterpret_cast<unsigned char*>(planes[c].data());
    channels[c].name[0] = kChannels[c].first;
  }
  EXRHeader header;
  InitEXRHeader(&header);
  header.num_channels = int(kChannels.size());
  header.channels = channels.data();
  header.pixel_types = header.requested_pixel_types = types.data();
  header.compression_type = TINYEXR_COMPRESSIONTYPE_ZIP;
  EXRImage picture;
  InitEXRImage(&picture);
  picture.width = image.width;
  picture.height = image.height;
  picture.num_channels = header.num_channels;
  picture.images = pointers.data();

  unsigned char* bytes = nullptr;
  const char* error = nullptr;
  const size_t size = SaveEXRImageToMemory(&picture, &header, &bytes, &error);
  const std::unique_ptr<unsigned char, void (*)(void*)> owner(bytes, std::free);
  if (size == 0) {
    const std::string what = error ? error : "no reason given";
    FreeEXRErrorMessage(error);
    throw std::runtime_error("tinyexr: " + what);
  }
  return {reinterpret_cast<const char*>(bytes), size};
}

}  // namespace cloudbake
