// KTX File Format 2.0 (Khronos, 2021), sections 3 (layout) and 5. The data format descriptor for R32G32B32A32_SFLOAT (VkFormat 109) follows
// Khronos Data Format 1.3, section 5.
#include "io/volume/lattice.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/harmonics.h"
#include "io/gltf/asset_info.h"

namespace cloudbake {

namespace {

constexpr uint32_t kRgbaFloat = 109, kFloatSize = 4, kTexelBytes = 16;

// Words are written in memory order, because cloudbake runs only on little-endian machines.
void append(std::string& bytes, std::initializer_list<uint32_t> words) {
  for (const uint32_t word : words) bytes.append(reinterpret_cast<const char*>(&word), sizeof word);
}
void append64(std::string& bytes, std::initializer_list<uint64_t> words) {
  for (const uint64_t word : words) bytes.append(reinterpret_cast<const char*>(&word), sizeof word);
}

// A basic descriptor block with one sample per channel, each a signed 32-bit float.
std::string formatDescriptor() {
  constexpr uint32_t kSamples = 4, kBlockBytes = 24 + 16 * kSamples;
  constexpr uint32_t kRgbsda = 1, kBt709 = 1, kLinear = 1, kSignedFloat = 0xC0;
  std::string block;
  append(block, {4 + kBlockBytes, 0, 2 | kBlockBytes << 16, kRgbsda | kBt709 << 8 | kLinear << 16, 0, kTexelBytes, 0});
  for (const uint32_t channel : {0U, 1U, 2U, 15U}) {  // red, green, blue, alpha
    const uint32_t bit_offset = 32 * (channel == 15 ? 3 : channel);
    append(block, {bit_offset | 31U << 16 | (channel | kSignedFloat) << 24, 0, 0xBF800000, 0x3F800000});  // −1 … 1
  }
  return block;
}

std::string keyValues() {
  const std::string pair = std::string("KTXwriter") + '\0' + "cloudbake " CLOUDBAKE_VERSION + '\0';
  std::string bytes;
  append(bytes, {uint32_t(pair.size())});
  bytes += pair;
  bytes.append((4 - bytes.size() % 4) % 4, '\0');
  return bytes;
}

}  // namespace

std::string encodeKtxVolume(std::array<int, 3> size, std::span<const float> rgba) {
  constexpr uint32_t kHeaderBytes = 12 + 9 * 4 + 4 * 4 + 2 * 8 + 3 * 8;  // identifier, header, index, one level
  const std::string descriptor = formatDescriptor(), pairs = keyValues();
  const auto pairs_at = uint32_t(kHeaderBytes + descriptor.size());
  const uint64_t data_at = (pairs_at + pairs.size() + 15) / 16 * 16;
  std::string bytes("\xABKTX 20\xBB\r\n\x1A\n", 12);
  append(bytes, {kRgbaFloat, kFloatSize, uint32_t(size[0]), uint32_t(size[1]), uint32_t(size[2]), 0, 1, 1, 0});
  append(bytes, {kHeaderBytes, uint32_t(descriptor.size()), pairs_at, uint32_t(pairs.size())});
  append64(bytes, {0, 0, data_at, rgba.size_bytes(), rgba.size_bytes()});
  bytes += descriptor + pairs;
  bytes.resize(data_at, '\0');
  return bytes.append(reinterpret_cast<const char*>(rgba.data()), rgba.size_bytes());
}

std::vector<LatticeFile> encodeLattice(const HarmonicLattice& lattice, const std::string& stem) {
  const size_t count = harmonicCount(lattice.order), cells = lattice.coefficients.size() / count;
  std::vector<LatticeFile> files;
  Json textures = Json::array();
  for (size_t first = 0; first < count; first += 4) {
    std::vector<float> rgba(4 * cells, 0);
    for (size_t c = 0; c < cells; ++c)
      std::copy_n(&lattice.coefficients[c * count + first], std::min<size_t>(4, count - first), &rgba[4 * c]);
    files.push_back({stem + "." + std::to_string(first / 4) + ".ktx2", encodeKtxVolume(lattice.cells, rgba)});
    textures.push_back(files.back().name);
  }
  const Json json = {{"schema", "cloudbake-lattice-1"},
                     {"order", lattice.order},
                     {"extinction", shortest(lattice.extinction)},
                     {"origin", {shortest(lattice.origin.x), shortest(lattice.origin.y), shortest(lattice.origin.z)}},
                     {"cell_size", shortest(lattice.cell_size)},
                     {"cells", lattice.cells},
                     {"textures", textures}};
  files.push_back({stem + ".json", json.dump(2) + "\n"});
  return files;
}

}  // namespace cloudbake
