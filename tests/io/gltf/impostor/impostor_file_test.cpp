// Impostors out and in.
#include "io/gltf/impostor/impostor_file.h"

#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/text/json.h"
#include "io/gltf/asset/decode.h"
#include "io/gltf/document.h"

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

Impostor someImpostor() {
  ImpostorInfo info;
  info.views = 2, info.frame = 8;
  info.of = ImpostorOf::kMesh;
  info.center = {1, 2, 3};
  info.radius = 0.7F;
  info.box = {{0, 1, 2}, {2, 3, 4}};
  info.exponent = 2.25F;
  info.extinction = 3.5F, info.thickest = 1.25F;
  info.gains = true;
  info.input_hash = "abc";
  Impostor impostor = blankImpostor(info);
  for (size_t i = 0; i < impostor.lobe[0].pixels.size(); ++i) {
    const auto step = [&](size_t factor) { return float(i * factor % 256) / 255; };
    impostor.lobe[0].pixels[i] = {step(1), step(3), step(5)};
    impostor.rest[0].pixels[i] = {step(7), step(11), step(13)};
  }
  return impostor;
}

ImpostorFiles files() { return encodeImpostor(someImpostor(), {2, std::vector<uint8_t>(16, 100)}); }

TEST(ImpostorFile, ComesBackAsItWas) {
  const Impostor wrote = someImpostor(), read = decodeImpostor("a.glb", files().glb);
  EXPECT_EQ(read.info.views, 2);
  EXPECT_EQ(read.info.frame, 8);
  EXPECT_EQ(read.info.of, ImpostorOf::kMesh);
  EXPECT_EQ(read.info.center, wrote.info.center);
  EXPECT_EQ(read.info.radius, wrote.info.radius);
  EXPECT_EQ(read.info.box.high, wrote.info.box.high);
  EXPECT_EQ(read.info.exponent, 2.25F);
  EXPECT_EQ(read.info.extinction, 3.5F);
  EXPECT_EQ(read.info.thickest, 1.25F);
  EXPECT_TRUE(read.info.gains);
  EXPECT_EQ(read.info.input_hash, "abc");
  EXPECT_EQ(read.lobe[0].pixels, wrote.lobe[0].pixels);
  EXPECT_EQ(read.rest[0].pixels, wrote.rest[0].pixels);
  EXPECT_EQ(read.lobe.size(), 2U) << "mip levels";
  EXPECT_EQ(files().glb, files().glb);
}

TEST(ImpostorFile, MayBeALevelOfDetail) {
  Impostor impostor = someImpostor();
  EXPECT_EQ(boxWithImpostor(impostor).info.input_hash, "abc");
  EXPECT_EQ(decodeImpostor("a.glb", files().glb).info.level, 0);
  impostor.info.level = 3, impostor.info.switch_pixels = 45, impostor.info.level_of = "def";
  const std::string glb = encodeImpostor(impostor, {2, std::vector<uint8_t>(16, 100)}).glb;
  const BakedMesh mesh = boxWithImpostor(decodeImpostor("a.glb", glb));
  EXPECT_EQ(mesh.info.level, 3);
  EXPECT_EQ(mesh.info.switch_pixels, 45);
  EXPECT_EQ(mesh.info.input_hash, "def");
  impostor.info.level = 9;
  const std::string wrong = encodeImpostor(impostor, {2, std::vector<uint8_t>(16, 100)}).glb;
  EXPECT_NE(errorOf([&] { decodeImpostor("a.glb", wrong); }).find("level is out of range"), std::string::npos);
}

TEST(ImpostorFile, IsKnownFromOtherFiles) {
  EXPECT_TRUE(isImpostor(files().glb));
  EXPECT_FALSE(isImpostor("nonsense"));
  EXPECT_FALSE(isImpostor(joinGlb("a", R"({"asset":{"version":"2.0"}})", "")));
  Warnings warnings;
  const std::string error = errorOf([&] { decodeGlb("a.glb", files().glb, warnings); });
  EXPECT_NE(error.find("give the baked asset that it was made of"), std::string::npos) << error;
}

// Changes the JSON of a file.
std::string changed(const std::function<void(Json&)>& change) {
  const std::string glb = files().glb;
  const GlbChunks chunks = splitGlb("a", glb);
  Json json = *parseJson(chunks.json);
  change(json);
  return joinGlb("a", json.dump(), chunks.binary);
}

TEST(ImpostorFile, RefusesWhatIsDamagedAndSaysWhy) {
  const auto own = [](Json& json) -> Json& { return json["asset"]["extras"]["cloudbake"]; };
  const std::pair<std::function<void(Json&)>, const char*> cases[] = {
      {[&](Json& json) { own(json)["version"] = 2; }, "another version"},
      {[&](Json& json) { own(json)["views"] = 1; }, "out of range"},
      {[&](Json& json) { own(json)["views"] = 3; }, "another size than views times frame"},
      {[&](Json& json) { own(json)["frame"] = 1e6; }, "metadata"},
      {[&](Json& json) { own(json)["frame"] = 1000000; }, "out of range"},
      {[&](Json& json) { own(json)["radius"] = 0; }, "above 0"},
      {[&](Json& json) { own(json)["extinction"] = 1e39; }, "not finite"},
      {[&](Json& json) { own(json).erase("thickest"); }, "metadata"},
      {[&](Json& json) { own(json)["center"] = "here"; }, "metadata"},
      {[](Json& json) { json["images"].erase(1); }, "a tool has removed it"},
      {[](Json& json) { json["images"][1]["bufferView"] = 99; }, "metadata"},
      {[](Json& json) { json["bufferViews"][4]["byteLength"] = 1 << 30; }, "reaches beyond the file"},
      {[](Json& json) { json["bufferViews"][4]["byteOffset"] = 4; }, "PNG"},
  };
  for (const auto& [change, why] : cases) {
    const std::string error = errorOf([&, damage = change] { decodeImpostor("a.glb", changed(damage)); });
    EXPECT_NE(error.find(why), std::string::npos) << why << ": " << error;
    EXPECT_NE(error.find("a.glb"), std::string::npos) << error;
  }
}

}  // namespace
}  // namespace cloudbake
