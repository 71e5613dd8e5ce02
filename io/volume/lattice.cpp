// KTX File Format 2.0 (Khronos, 2021), sections 3 (layout) and 5. The data format descriptor for R32G32B32A32_SFLOAT (VkFormat 109) follows
// Khronos Data Format 1.3, section 5.
#include "io/volume/lattice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/harmonics.h"
#include "core/text/json.h"
#include "core/text/maker.h"
#include "io/gltf/asset_info.h"

namespace cloudbake {

namespace {

constexpr uint32_t kRgbaFloat = 109, kFloatSize = 4, kTexelBytes = 16;
constexpr std::string_view kIdentifier("\xABKTX 20\xBB\r\n\x1A\n", 12);
constexpr uint32_t kLevelIndexAt = 12 + 9 * 4 + 4 * 4 + 2 * 8;  // after identifier, header and index
constexpr uint32_t kHeaderBytes = kLevelIndexAt + 3 * 8;        // with one level

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
  const std::string pair = std::string("KTXwriter") + '\0' + std::string(kMaker) + '\0';
  std::string bytes;
  append(bytes, {uint32_t(pair.size())});
  bytes += pair;
  bytes.append((4 - bytes.size() % 4) % 4, '\0');
  return bytes;
}

}  // namespace

std::string encodeKtxVolume(std::array<int, 3> size, std::span<const float> rgba) {
  const std::string descriptor = formatDescriptor(), pairs = keyValues();
  const auto pairs_at = uint32_t(kHeaderBytes + descriptor.size());
  const uint64_t data_at = (pairs_at + pairs.size() + 15) / 16 * 16;
  std::string bytes(kIdentifier);
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

namespace {

constexpr int kMostCells = 1024;     // along a side
constexpr double kMostTexels = 1e8;  // of a texture

// The texels of a volume that encodeKtxVolume has written, of the given size.
std::span<const float> texelsOf(const std::string& file, const std::string& bytes, std::array<int, 3> size, std::vector<float>& texels) {
  const auto word = [&](size_t at) {
    uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
  };
  if (bytes.size() < kHeaderBytes || !bytes.starts_with(kIdentifier))
    throw InputError(file, "this is not a KTX 2.0 texture: write the lattice again with --lattice");
  const bool is_ours = word(12) == kRgbaFloat && word(20) == uint32_t(size[0]) && word(24) == uint32_t(size[1]) &&
                       word(28) == uint32_t(size[2]) && word(40) == 1 && word(44) == 0;
  if (!is_ours)
    throw InputError(file, "the texture is not a volume of 32-bit RGBA of the lattice's size: write the lattice again with --lattice");
  uint64_t at = 0, length = 0;
  std::memcpy(&at, bytes.data() + kLevelIndexAt, sizeof at);
  std::memcpy(&length, bytes.data() + kLevelIndexAt + sizeof at, sizeof length);
  const size_t count = 4 * size_t(size[0]) * size_t(size[1]) * size_t(size[2]);
  if (length != kFloatSize * count || at > bytes.size() || length > bytes.size() - at)
    throw InputError(file, "the texture ends early: write the lattice again with --lattice");
  texels.resize(count);
  std::memcpy(texels.data(), bytes.data() + at, length);
  return texels;
}

template <typename Value>
Value valueOf(const Json& json, const std::string& file, const char* key) {
  try {
    return json.at(key).get<Value>();
  } catch (const Json::exception&) {
    throw InputError(file, fmt::format("'{}' is missing, or is not what a lattice has: write the lattice again with --lattice", key));
  }
}

}  // namespace

HarmonicLattice decodeLattice(const std::filesystem::path& file, std::string_view bytes,
                              const std::function<std::string(const std::string& name)>& read) {
  const std::string name = file.string();
  const Json json = parseJson(bytes).value_or(Json());
  if (!json.is_object() || json.value("schema", Json()) != "cloudbake-lattice-1")
    throw InputError(name, "this is not the description of a lattice: give the .json that --lattice has written");
  HarmonicLattice lattice;
  lattice.order = valueOf<int>(json, name, "order");
  lattice.extinction = valueOf<float>(json, name, "extinction");
  lattice.cell_size = valueOf<float>(json, name, "cell_size");
  lattice.cells = valueOf<std::array<int, 3>>(json, name, "cells");
  const auto origin = valueOf<std::array<float, 3>>(json, name, "origin");
  lattice.origin = {origin[0], origin[1], origin[2]};
  double cells = 1;
  bool is_sized = true;
  for (const int count : lattice.cells) cells *= count, is_sized = is_sized && count >= 2 && count <= kMostCells;
  if (lattice.order < 1 || lattice.order > kMaxHarmonicOrder || !is_sized || cells > kMostTexels || !(lattice.cell_size > 0) ||
      !std::isfinite(lattice.cell_size) || !(lattice.extinction > 0) || !std::isfinite(lattice.extinction) || !isFinite(lattice.origin))
    throw InputError(name, "a number of the lattice is out of range: write the lattice again with --lattice");

  const auto textures = valueOf<std::vector<std::string>>(json, name, "textures");
  const size_t count = harmonicCount(lattice.order);
  if (textures.size() != (count + 3) / 4) throw InputError(name, "the lattice does not have a texture for every four coefficients");
  std::vector<float> texels;
  for (size_t t = 0; t < textures.size(); ++t) {
    if (std::filesystem::path(textures[t]).has_parent_path())
      throw InputError(name, "a texture of the lattice is not beside its description: write the lattice again with --lattice");
    texelsOf((file.parent_path() / textures[t]).string(), read(textures[t]), lattice.cells, texels);
    lattice.coefficients.resize(size_t(cells) * count);  // once a texture has shown that the lattice is so large
    for (size_t c = 0; c < size_t(cells); ++c)
      std::copy_n(&texels[4 * c], std::min<size_t>(4, count - 4 * t), &lattice.coefficients[c * count + 4 * t]);
  }
  for (const float coefficient : lattice.coefficients)
    if (!std::isfinite(coefficient))
      throw InputError(name, "a coefficient of the lattice is not finite: write the lattice again with --lattice");
  return lattice;
}

}  // namespace cloudbake
