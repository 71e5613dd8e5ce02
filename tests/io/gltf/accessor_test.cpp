// glTF 2.0, section 3.11: a normalised integer c of a signed type of n bits is max(c / (2ⁿ⁻¹ − 1), −1), of an unsigned type c / (2ⁿ − 1).
#include "io/gltf/accessor.h"

#include <limits>

#include "tests/io/gltf/gltf_helpers.h"

using namespace cloudbake;

namespace {

// The x coordinates of four vertices whose positions are stored as integers, normalised or not.
template <typename T>
std::vector<float> readAs(const TestFolder& folder, int component, bool normalized, const std::array<T, 4>& values) {
  GltfBuilder gltf = oneTetrahedron();
  std::vector<T> padded;  // four components apart, because vertices are aligned to four bytes
  for (const T value : values) padded.insert(padded.end(), {value, 0, 0, 0});
  const int positions = gltf.accessor(padded, component, "VEC3", 4);
  gltf.json["bufferViews"].back()["byteStride"] = 4 * sizeof(T);
  gltf.json["accessors"].back()["normalized"] = normalized;
  gltf.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = positions;
  gltf.json["extensionsUsed"] = gltf.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  Warnings warnings;
  const Sculpt sculpt = readMesh(folder.write("a.glb", gltf.glb()), {}, warnings);
  std::vector<float> result;
  for (const Vec3& p : sculpt.parts.at(0).positions) result.push_back(p.x);
  return result;
}

}  // namespace

// Both ends of a signed type are −1 and 1, and the least integer, which has no opposite, is −1 too.
TEST(Accessor, NormalisedSignedIntegersAreSymmetric) {
  const TestFolder folder;
  EXPECT_EQ(readAs<int8_t>(folder, 5120, true, {127, -127, -128, 64}), (std::vector<float>{1, -1, -1, float(64 / 127.0)}));
  EXPECT_EQ(readAs<int16_t>(folder, 5122, true, {32767, -32767, -32768, -16384}), (std::vector<float>{1, -1, -1, float(-16384 / 32767.0)}));
}

TEST(Accessor, NormalisedUnsignedIntegersFillZeroToOne) {
  const TestFolder folder;
  EXPECT_EQ(readAs<uint8_t>(folder, 5121, true, {0, 255, 51, 128}), (std::vector<float>{0, 1, 0.2F, float(128 / 255.0)}));
  EXPECT_EQ(readAs<uint16_t>(folder, 5123, true, {0, 65535, 13107, 1}), (std::vector<float>{0, 1, 0.2F, float(1 / 65535.0)}));
}

TEST(Accessor, OtherIntegersKeepTheirValue) {
  const TestFolder folder;
  EXPECT_EQ(readAs<int8_t>(folder, 5120, false, {127, -127, -128, 64}), (std::vector<float>{127, -127, -128, 64}));
  EXPECT_EQ(readAs<uint8_t>(folder, 5121, false, {0, 255, 51, 128}), (std::vector<float>{0, 255, 51, 128}));
  EXPECT_EQ(readAs<int16_t>(folder, 5122, false, {32767, -32768, 0, 1}), (std::vector<float>{32767, -32768, 0, 1}));
  EXPECT_EQ(readAs<uint16_t>(folder, 5123, false, {65535, 0, 13107, 1}), (std::vector<float>{65535, 0, 13107, 1}));
}
