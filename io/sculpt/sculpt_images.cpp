#include "io/sculpt/sculpt_images.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_NO_STDIO
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#pragma GCC diagnostic pop

#include <climits>

#include "core/error.h"
#include "io/file/neighbour.h"
#include "io/gltf/named_files.h"

namespace cloudbake {

namespace fs = std::filesystem;

int ImageCollector::fromBytes(const std::string& name, std::string_view bytes, const std::string& owner) {
  const auto [entry, added] = known.try_emplace(name, -1);
  if (!added) return entry->second;
  const std::string_view type = imageMimeType(bytes);
  if (type != "image/png" && type != "image/jpeg") {
    warnings.add(WarningKind::kImageNotEmbedded,
                 file.string() + ": image '" + name + "' of " + owner + " is neither PNG nor JPEG, so it was left out: convert it");
    return -1;
  }
  images.push_back({fs::path(name).filename().string(), std::string(bytes), std::string(type)});
  return entry->second = int(images.size()) - 1;
}

int ImageCollector::fromFile(const std::string& written, const std::string& owner, const fs::path& named_by) {
  const fs::path named = neighbourNamed(file, written, settings.allow_outside, named_by);
  if (const auto entry = known.find(named.string()); entry != known.end()) return entry->second;
  std::string why = "cannot be read";
  try {
    return fromBytes(named.string(), readNeighbour(file, named, settings), owner);
  } catch (const InputError&) {
    why = "is not used: " + refusalOfNeighbour(file, named, settings.allow_outside).value_or("it was refused");
  } catch (const IoError&) {
  }
  warnings.add(WarningKind::kImageNotEmbedded, file.string() + ": image '" + written + "' of " + owner + " " + why + "; it was left out");
  return known[named.string()] = -1;
}

bool looksLikeNormalMap(std::string_view bytes) {
  constexpr int64_t kMaxPixels = int64_t(1) << 26;
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  int width = 0, height = 0, channels = 0;
  if (bytes.size() > size_t(INT_MAX) || !stbi_info_from_memory(data, int(bytes.size()), &width, &height, &channels)) return false;
  if (channels < 3 || int64_t(width) * height > kMaxPixels) return false;
  stbi_uc* rgb = stbi_load_from_memory(data, int(bytes.size()), &width, &height, &channels, 3);
  if (!rgb) return false;
  int64_t sums[3] = {0, 0, 0};
  const int64_t count = int64_t(width) * height;
  for (int64_t i = 0; i < 3 * count; ++i) sums[i % 3] += rgb[i];
  stbi_image_free(rgb);
  const auto mean = [&](int channel) { return double(sums[channel]) / double(count); };
  return std::abs(mean(0) - 127.5) < 32 && std::abs(mean(1) - 127.5) < 32 && mean(2) > 176;
}

}  // namespace cloudbake
