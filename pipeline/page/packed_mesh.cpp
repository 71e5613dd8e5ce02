#include "pipeline/page/packed_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/text/base64.h"
#include "core/vec3.h"
#include "io/file/deflate.h"

namespace cloudbake {

namespace {

constexpr uint32_t kPositionSteps = (1 << 20) - 1;
constexpr int kDirectionSteps = (1 << 15) - 2;  // even, so that axes are exact

uint32_t nearestStep(float value, float step) { return uint32_t(std::lround(value / step)); }

// The first bytes of all values, then the second ones, and so on: neighbours are alike, which deflates well.
template <typename Value>
std::string byPlanes(const std::vector<Value>& values) {
  std::string bytes(values.size() * sizeof(Value), '\0'), planes;
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  for (size_t plane = 0; plane < sizeof(Value); ++plane)
    for (size_t at = plane; at < bytes.size(); at += sizeof(Value)) planes.push_back(bytes[at]);
  return planes;
}

// A unit vector on the faces of an octahedron, and these unfolded to a square: Z. Cigolle et al., "A Survey of Efficient Representations
// for Independent Unit Vectors", JCGT 3(2), 2014.
std::array<float, 2> onSquare(Vec3 direction) {
  const float sum = std::abs(direction.x) + std::abs(direction.y) + std::abs(direction.z);
  if (!(sum > 0)) return {0, 0};
  const float x = direction.x / sum, y = direction.y / sum;
  if (direction.z >= 0) return {x, y};
  return {std::copysign(1 - std::abs(y), x), std::copysign(1 - std::abs(x), y)};
}

}  // namespace

// Negative differences become odd.
void MeshPacker::addWhole(const std::vector<uint32_t>& values, size_t width) {
  std::vector<uint32_t> coded;
  for (size_t i = 0; i < values.size(); ++i) {
    const uint32_t difference = values[i] - (i >= width ? values[i - width] : 0);
    coded.push_back(difference << 1 ^ (difference >> 31 ? UINT32_MAX : 0));
  }
  bytes_ += byPlanes(coded);
}

Json MeshPacker::addPositions(std::span<const Vec3> positions) {
  Box box;
  for (const Vec3 p : positions) box.add(p);
  const Vec3 low = positions.empty() ? Vec3{} : box.low, size = positions.empty() ? Vec3{} : box.high - box.low;
  const float longest = std::max({size.x, size.y, size.z}), step = longest > 0 ? longest / float(kPositionSteps) : 1;
  std::vector<uint32_t> values;
  for (const Vec3 p : positions)
    for (const float distance : {p.x - low.x, p.y - low.y, p.z - low.z}) values.push_back(nearestStep(distance, step));
  addWhole(values, 3);
  return {{"low", {low.x, low.y, low.z}}, {"step", step}};
}

int MeshPacker::addDirections(std::span<const Vec3> directions) {
  std::vector<uint32_t> values;
  for (const Vec3 direction : directions)
    for (const float at : onSquare(direction)) values.push_back(nearestStep(at + 1, 2.0F / kDirectionSteps));
  addWhole(values, 2);
  return kDirectionSteps;
}

void MeshPacker::addRounded(std::span<const float> values) {
  constexpr uint32_t kDropped = 0x1ff;  // of the 23 bits after the point
  std::vector<uint32_t> rounded;
  for (const float value : values) rounded.push_back((std::bit_cast<uint32_t>(value) + kDropped / 2 + 1) & ~kDropped);
  bytes_ += byPlanes(rounded);
}

void MeshPacker::addFloats(const std::vector<float>& values) { bytes_ += byPlanes(values); }

void MeshPacker::addTriangles(const std::vector<uint32_t>& vertices) { addWhole(vertices, 1); }

void MeshPacker::addBytes(std::span<const uint8_t> bytes) { bytes_.append(bytes.begin(), bytes.end()); }

std::string MeshPacker::packed() const { return encodeBase64(deflated(bytes_)); }

}  // namespace cloudbake
