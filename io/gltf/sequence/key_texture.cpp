#include "io/gltf/sequence/key_texture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/lobe_packing.h"
#include "io/gltf/sequence/sequence_file.h"

namespace cloudbake {

namespace {

constexpr double kSteps = 65535;
// Of a sequence that is made for pictures of a size: positions are off by at most 1/64 of a pixel along each axis, and T by 0.001 where σ
// times the largest d is at most 20.
constexpr int kStepsPerPixel = 32, kRootBits = 11;

using Texel = std::array<int, 3>;  // bytes

size_t texelAt(const KeyTexturePlace& place, int block, int key, size_t vertex) {
  const size_t row = size_t(place.first_row) +
                     (size_t(block) * size_t(place.rowsPerBlock()) + vertex / kSequenceColumns) * size_t(place.keys) + size_t(key);
  return row * kSequenceColumns + vertex % kSequenceColumns;
}

// The nearest number whose bits after the first so many are 0; the largest one is all ones.
uint16_t steps(double share, int bits) {
  const int step = 1 << (16 - bits);
  return uint16_t(std::min(step * int(std::lround(kSteps / step * std::clamp(share, 0.0, 1.0))), 65535));
}

// A direction as two bytes: the nearest of the four points around its place in the octahedron's map.
std::array<uint8_t, 2> directionBytes(Vec3 direction) {
  const auto [u, v] = octahedronPlace(direction.x, direction.y, direction.z);
  std::array<uint8_t, 2> best{};
  double most = -INFINITY;
  const double x = 255 * (u / 2 + 0.5), y = 255 * (v / 2 + 0.5);
  for (const int i : {int(std::floor(x)), int(std::floor(x)) + 1})
    for (const int j : {int(std::floor(y)), int(std::floor(y)) + 1}) {
      if (i < 0 || j < 0 || i > 255 || j > 255) continue;
      const auto [px, py, pz] = octahedronPoint(i / 127.5 - 1, j / 127.5 - 1);
      const double cosine = (px * direction.x + py * direction.y + pz * direction.z) / std::sqrt(px * px + py * py + pz * pz);
      if (cosine > most) most = cosine, best = {uint8_t(i), uint8_t(j)};
    }
  return best;
}

Vec3 directionOf(int first, int second) {
  const auto [x, y, z] = octahedronPoint(first / 127.5 - 1, second / 127.5 - 1);
  return normalized(Vec3{float(x), float(y), float(z)}).value_or(Vec3{0, 1, 0});
}

}  // namespace

int KeyTexturePlace::rowsPerBlock() const { return int((vertices + kSequenceColumns - 1) / kSequenceColumns); }

std::vector<KeyTexturePlace> placesInTexture(const CloudSequence& sequence) {
  std::vector<KeyTexturePlace> places;
  int row = 0;
  for (const SequenceSegment& segment : sequence.segments) {
    places.push_back({row, int(segment.keys.size()), segment.keys.front().positions.size()});
    row += places.back().rows();
  }
  return places;
}

int rowsOfTexture(const std::vector<KeyTexturePlace>& places) { return places.back().first_row + places.back().rows(); }

KeyTextureScale scaleOfTexture(const CloudSequence& sequence) {
  KeyTextureScale scale{boxOf(sequence.segments)};
  if (sequence.pixels > 0)
    scale.position_bits = std::min(int(std::bit_width(unsigned(kStepsPerPixel * sequence.pixels - 1))), 16), scale.root_bits = kRootBits;
  for (const SequenceSegment& segment : sequence.segments)
    for (const SequenceKey& key : segment.keys)
      for (const Lobe& lobe : key.lobes) scale.densest = std::max(scale.densest, lobe.thickness);
  return scale;
}

std::vector<KeyNumbers> numbersOfKey(const SequenceKey& key, const KeyTextureScale& scale) {
  const Vec3 low = scale.box.low, size = scale.box.size();
  const auto place = [&](float value, float from, float extent) {
    return steps(extent > 0 ? (double(value) - from) / extent : 0, scale.position_bits);
  };
  std::vector<KeyNumbers> numbers;
  numbers.reserve(key.positions.size());
  for (size_t v = 0; v < key.positions.size(); ++v) {
    const Vec3 p = key.positions[v];
    const Lobe& lobe = key.lobes[v];
    numbers.push_back({{place(p.x, low.x, size.x), place(p.y, low.y, size.y), place(p.z, low.z, size.z)},
                       scale.densest > 0 ? steps(std::sqrt(double(lobe.thickness) / scale.densest), scale.root_bits) : uint16_t(0),
                       directionBytes(lobe.direction),
                       directionBytes(key.normals[v])});
  }
  return numbers;
}

Image keyTexture(const CloudSequence& sequence, const std::vector<KeyTexturePlace>& places, const KeyTextureScale& scale) {
  Image image{kSequenceColumns, rowsOfTexture(places), {}};
  image.pixels.resize(size_t(image.width) * size_t(image.height));
  const auto store = [&](size_t at, const Texel& bytes) {
    image.pixels[at] = {float(bytes[0]) / 255, float(bytes[1]) / 255, float(bytes[2]) / 255};
  };
  for (size_t s = 0; s < places.size(); ++s)
    for (int k = 0; k < places[s].keys; ++k) {
      const std::vector<KeyNumbers> key = numbersOfKey(sequence.segments[s].keys[size_t(k)], scale);
      for (size_t v = 0; v < key.size(); ++v) {
        const auto& [place, root, lobe, normal] = key[v];
        store(texelAt(places[s], 0, k, v), {place[0] / 256, place[1] / 256, place[2] / 256});
        store(texelAt(places[s], 1, k, v), {place[0] % 256, place[1] % 256, place[2] % 256});
        store(texelAt(places[s], 2, k, v), {lobe[0], lobe[1], root / 256});
        store(texelAt(places[s], 3, k, v), {normal[0], normal[1], root % 256});
      }
    }
  return image;
}

SequenceKey keyOfTexture(const Image& texture, const KeyTexturePlace& place, int key, const KeyTextureScale& scale) {
  SequenceKey result;
  const auto bytes = [&](int block, size_t vertex) {
    const Vec3 texel = texture.pixels[texelAt(place, block, key, vertex)];
    return Texel{int(std::lround(255 * texel.x)), int(std::lround(255 * texel.y)), int(std::lround(255 * texel.z))};
  };
  const Vec3 low = scale.box.low, size = scale.box.size();
  for (size_t v = 0; v < place.vertices; ++v) {
    const Texel high = bytes(0, v), rest = bytes(1, v), lobe = bytes(2, v), normal = bytes(3, v);
    const auto share = [&](size_t axis) { return float((256 * high[axis] + rest[axis]) / kSteps); };
    const auto root = float((256 * lobe[2] + normal[2]) / kSteps);
    result.positions.push_back(low + Vec3{size.x * share(0), size.y * share(1), size.z * share(2)});
    result.normals.push_back(directionOf(normal[0], normal[1]));
    result.lobes.push_back({directionOf(lobe[0], lobe[1]), root * root * scale.densest});
  }
  return result;
}

}  // namespace cloudbake
