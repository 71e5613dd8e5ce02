// Sequences out and in.
#include "io/gltf/sequence/sequence_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/error.h"
#include "core/text/json.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/decode.h"
#include "io/gltf/document.h"
#include "io/gltf/sequence/key_texture.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

std::string errorOf(const std::function<void()>& run) {
  try {
    run();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

SequenceKey keyOf(double frame, float radius) {
  const BakedMesh ball = bakedBall(radius, {0.5F, 2, -1}, 4);
  SequenceKey key{frame, ball.surface.positions, ball.surface.normals, ball.lobes};
  for (size_t v = 0; v < key.lobes.size(); ++v) key.lobes[v].thickness *= 0.2F + 0.8F * float(v % 7) / 7;
  return key;
}

CloudSequence someSequence() {
  CloudSequence sequence;
  sequence.info = bakedBall().info;
  sequence.info.shape = {2.5F, 0.125F};
  sequence.info.extinction = 3;
  sequence.info.input_hash = "abc";
  sequence.frames_per_second = 12.5;
  sequence.loops = true;
  sequence.period = 9;
  const std::vector<Triangle> triangles = bakedBall(1, {}, 4).surface.triangles;
  sequence.segments.push_back({triangles, {keyOf(0, 1), keyOf(2, 1.25F), keyOf(5, 2)}});
  sequence.segments.push_back({triangles, {keyOf(4, 1), keyOf(10, 0.5F)}});
  sequence.segments.push_back({triangles, {keyOf(9, 1)}});
  return sequence;
}

class SequenceFile : public testing::TestWithParam<SequenceForm> {};

TEST_P(SequenceFile, ComesBackAsItWas) {
  const CloudSequence wrote = someSequence();
  const std::string glb = encodeSequence(wrote, GetParam());
  EXPECT_EQ(glb, encodeSequence(wrote, GetParam()));
  const CloudSequence read = decodeSequence("a.glb", glb);
  EXPECT_EQ(read.info.shape.exponent, 2.5F);
  EXPECT_EQ(read.info.shape.bias, 0.125F);
  EXPECT_EQ(read.info.extinction, 3);
  EXPECT_EQ(read.info.input_hash, "abc");
  EXPECT_EQ(read.frames_per_second, 12.5);
  EXPECT_TRUE(read.loops);
  EXPECT_EQ(read.period, 9);
  ASSERT_EQ(read.segments.size(), 3U);
  const bool is_picture = GetParam() == SequenceForm::kTexture;
  // Of a picture: half a step of 65535 of the box, which is 4 wide; half a step of an octahedron's map of 8 bits, whose cells are stretched
  // by up to 3; a root of 16 bits.
  const float place = is_picture ? 4 / 65535.0F : 1e-6F, turn = is_picture ? 0.0125F : 1e-6F, depth = is_picture ? 4 * 4 / 65535.0F : 1e-5F;
  for (size_t s = 0; s < 3; ++s) {
    EXPECT_EQ(read.segments[s].triangles, wrote.segments[s].triangles);
    ASSERT_EQ(read.segments[s].keys.size(), wrote.segments[s].keys.size());
    for (size_t k = 0; k < read.segments[s].keys.size(); ++k) {
      const SequenceKey &a = wrote.segments[s].keys[k], &b = read.segments[s].keys[k];
      EXPECT_EQ(a.frame, b.frame);
      ASSERT_EQ(a.positions.size(), b.positions.size());
      for (size_t v = 0; v < a.positions.size(); ++v) {
        EXPECT_LE(length(a.positions[v] - b.positions[v]), place);
        EXPECT_LE(length(a.normals[v] - b.normals[v]), turn);
        EXPECT_LE(length(a.lobes[v].direction - b.lobes[v].direction), turn);
        EXPECT_LE(std::abs(a.lobes[v].thickness - b.lobes[v].thickness), depth);
      }
    }
  }
}

// What the picture keeps of a sequence for pictures of a size, and that its bytes shrink.
TEST(KeyTexture, RoundsToSharesOfPixels) {
  CloudSequence sequence = someSequence();
  const size_t whole = encodeSequence(sequence, SequenceForm::kTexture).size();
  size_t before = 0;
  for (const auto& [pixels, step] : {std::pair(128, 16), {512, 4}, {2048, 1}}) {
    sequence.pixels = pixels;
    const std::string glb = encodeSequence(sequence, SequenceForm::kTexture);
    EXPECT_GT(glb.size(), before);
    EXPECT_LE(glb.size(), whole);
    before = glb.size();
    const CloudSequence read = decodeSequence("a.glb", glb);
    const KeyTextureScale scale = scaleOfTexture(sequence);
    const Vec3 size = scale.box.size();
    float farthest = 0, deepest = 0;
    for (size_t s = 0; s < read.segments.size(); ++s)
      for (size_t k = 0; k < read.segments[s].keys.size(); ++k) {
        const SequenceKey &a = sequence.segments[s].keys[k], &b = read.segments[s].keys[k];
        for (size_t v = 0; v < a.positions.size(); ++v) {
          const Vec3 off = a.positions[v] - b.positions[v];
          farthest = std::max({farthest, std::abs(off.x) / size.x, std::abs(off.y) / size.y, std::abs(off.z) / size.z});
          const auto root = [&](const Lobe& lobe) { return std::sqrt(lobe.thickness / scale.densest); };
          deepest = std::max(deepest, std::abs(root(a.lobes[v]) - root(b.lobes[v])));
        }
        for (const KeyNumbers& one : numbersOfKey(a, scale))
          for (const int place : one.position) EXPECT_TRUE(place % step == 0 || place == 65535);
      }
    EXPECT_LE(farthest, 0.51F / 32 / float(pixels));
    EXPECT_LE(deepest, 0.51F / 2048);
  }
}

// What plays the morph targets in any viewer: the weight of each key's own target, and which segment is shown.
TEST(SequenceFileMorph, AnimatesWeightsAndSegments) {
  const std::string glb = encodeSequence(someSequence(), SequenceForm::kMorph);
  const GlbChunks chunks = splitGlb("a", glb);
  const Json json = *parseJson(chunks.json);
  const auto numbers = [&](const Json& accessor) {
    const Json &own = json["accessors"][accessor.get<size_t>()], &view = json["bufferViews"][own["bufferView"].get<size_t>()];
    std::vector<float> values(view["byteLength"].get<size_t>() / sizeof(float));
    std::memcpy(values.data(), chunks.binary.data() + view["byteOffset"].get<size_t>(), values.size() * sizeof(float));
    return values;
  };
  struct Channel {
    const char *path, *interpolation;
    int node;
    std::vector<float> seconds, values;
  };
  const std::vector<Channel> expected{{"weights", "LINEAR", 0, {0, 0.16F, 0.4F}, {0, 0, 1, 0, 0, 1}},
                                      {"scale", "STEP", 0, {0, 0.36F}, {1, 1, 1, 0, 0, 0}},
                                      {"weights", "LINEAR", 1, {0.32F, 0.8F}, {0, 1}},
                                      {"scale", "STEP", 1, {0, 0.36F, 0.76F}, {0, 0, 0, 1, 1, 1, 0, 0, 0}},
                                      {"scale", "STEP", 2, {0, 0.76F}, {0, 0, 0, 1, 1, 1}}};
  const Json& animation = json["animations"][0];
  ASSERT_EQ(animation["channels"].size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i) {
    const Json &channel = animation["channels"][i], &sampler = animation["samplers"][channel["sampler"].get<size_t>()];
    EXPECT_EQ(channel["target"]["path"], expected[i].path);
    EXPECT_EQ(channel["target"]["node"], expected[i].node);
    EXPECT_EQ(sampler["interpolation"], expected[i].interpolation);
    EXPECT_EQ(numbers(sampler["input"]), expected[i].seconds) << i;
    EXPECT_EQ(numbers(sampler["output"]), expected[i].values) << i;
  }
}

// More vertices than 16 bits can number.
TEST_P(SequenceFile, HasWideIndices) {
  CloudSequence sequence = someSequence();
  SequenceKey key;
  for (uint32_t v = 0; v < 66000; ++v) {
    const uint32_t row = v / 300;
    key.positions.push_back({float(v % 300), float(row), float(v % 7)});
    key.normals.push_back({0, 1, 0});
    key.lobes.push_back({{0, 1, 0}, 1});
  }
  sequence.segments = {{{{0, 1, 65999}, {1, 65537, 300}}, {key}}};
  EXPECT_EQ(decodeSequence("a.glb", encodeSequence(sequence, GetParam())).segments[0].triangles, sequence.segments[0].triangles);
}

// For gltf_validator (tests/CMakeLists.txt).
TEST_P(SequenceFile, IsWrittenForTheValidator) {
  std::filesystem::create_directories("glb");
  const bool is_picture = GetParam() == SequenceForm::kTexture;
  writeFileAtomically(is_picture ? "glb/sequence_picture.glb" : "glb/sequence_morph.glb", encodeSequence(someSequence(), GetParam()));
}

TEST_P(SequenceFile, IsKnownFromOtherFiles) {
  const std::string glb = encodeSequence(someSequence(), GetParam());
  EXPECT_TRUE(isSequence(glb));
  EXPECT_FALSE(isSequence("nonsense"));
  EXPECT_FALSE(isSequence(joinGlb("a", R"({"asset":{"version":"2.0"}})", "")));
  Warnings warnings;
  EXPECT_NE(errorOf([&] { decodeGlb("a.glb", glb, warnings); }).find("a.glb: is a sequence"), std::string::npos);
}

// Changes the JSON of a file.
std::string changed(SequenceForm form, const std::function<void(Json&)>& change) {
  const std::string glb = encodeSequence(someSequence(), form);
  const GlbChunks chunks = splitGlb("a", glb);
  Json json = *parseJson(chunks.json);
  change(json);
  return joinGlb("a", json.dump(), chunks.binary);
}

Json& own(Json& json) { return json["asset"]["extras"]["cloudbake"]["sequence"]; }

TEST_P(SequenceFile, RefusesWhatIsDamagedAndSaysWhy) {
  struct Damage {
    std::function<void(Json&)> change;
    const char* message;
  };
  const std::vector<Damage> damages{
      {[](Json& json) { json["asset"]["extras"]["cloudbake"]["layout"] = "lobe-uv"; }, "is not a sequence"},
      {[](Json& json) { json["asset"]["extras"]["cloudbake"]["version"] = 2; }, "another version"},
      {[](Json& json) { own(json).erase("segments"); }, "incomplete or damaged"},
      {[](Json& json) { own(json)["segments"] = Json::array(); }, "no segments"},
      {[](Json& json) {
         own(json)["segments"][0]["frames"] = {0, 5, 2};
       },
       "not in order"},
      {[](Json& json) { own(json)["segments"][0]["frames"] = Json::array(); }, "has no keys"},
      {[](Json& json) { own(json)["segments"][0]["mesh"] = 9; }, "no mesh"},
      {[](Json& json) {
         own(json)["segments"][1]["frames"] = {-1, 3};
       },
       "not in order"},
      {[](Json& json) { std::swap(own(json)["segments"][0], own(json)["segments"][1]); }, "segments are not in order"},
      {[](Json& json) { own(json)["frames_per_second"] = 0; }, "out of range"},
      {[](Json& json) { json["meshes"][0]["primitives"][0]["attributes"].erase("TEXCOORD_1"); }, "has no TEXCOORD_1"}};
  for (const Damage& damage : damages) {
    const std::string error = errorOf([&] { decodeSequence("a.glb", changed(GetParam(), damage.change)); });
    EXPECT_TRUE(error.starts_with("a.glb: ")) << damage.message << ": " << error;
    EXPECT_NE(error.find(damage.message), std::string::npos) << damage.message << ": " << error;
  }
}

INSTANTIATE_TEST_SUITE_P(Forms, SequenceFile, testing::Values(SequenceForm::kMorph, SequenceForm::kTexture),
                         [](const auto& form) { return form.param == SequenceForm::kMorph ? "Morph" : "Picture"; });

TEST(SequenceFile, NeedsItsPictureAndItsTargets) {
  const auto errorWith = [](SequenceForm form, const std::function<void(Json&)>& change) {
    return errorOf([&] { decodeSequence("a.glb", changed(form, change)); });
  };
  using enum SequenceForm;
  EXPECT_NE(errorWith(kMorph, [](Json& json) { json["meshes"][0]["primitives"][0]["targets"].erase(1); }).find("no morph target"),
            std::string::npos);
  EXPECT_NE(errorWith(kTexture, [](Json& json) { json["images"][0]["name"] = "other"; }).find("no picture of its keys"), std::string::npos);
  EXPECT_NE(errorWith(kTexture, [](Json& json) { own(json)["segments"][2]["first_row"] = 1000; }).find("too small"), std::string::npos);
  EXPECT_NE(errorWith(kTexture, [](Json& json) { own(json)["columns"] = 512; }).find("another width"), std::string::npos);
}

}  // namespace
}  // namespace cloudbake
