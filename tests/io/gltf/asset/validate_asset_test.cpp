// What the file alone tells of an asset that other programs have changed.
#include "io/gltf/asset/validate_asset.h"

#include "core/random.h"
#include "io/gltf/asset/write.h"
#include "io/sculpt/read_mesh.h"
#include "tests/io/io_helpers.h"

using namespace cloudbake;

namespace {

constexpr size_t kVertices = 50;

LobeUvs lobeAt(size_t v) {
  const auto draw = [&](uint32_t i) { return uniformFloat(hashDraw(3, uint32_t(v), i)) - 0.5F; };
  const Vec3 o = *normalized({draw(0), draw(1), draw(2)});
  return {{o.x, o.y}, {o.z, 2 + draw(3)}};
}

// A part with lobes in sets `first` and `first`+1 and textures' UVs below.
StoredAsset soundAsset(int first = 0) {
  StoredAsset asset;
  asset.info.emplace();
  asset.info->first_uv_set = first;
  asset.info->extinction = 1;
  asset.info->shape = {3, 0};
  asset.sets.resize(1);
  asset.sculpt.parts.resize(1);
  for (int set = 0; set < first; ++set) asset.sets[0][set] = {"float", std::vector<Vec2>(kVertices, {0.3F, 0.4F}), {}};
  StoredUvSet &a = asset.sets[0][first], &b = asset.sets[0][first + 1];
  a.type = b.type = "float";
  for (size_t v = 0; v < kVertices; ++v) a.values.push_back(lobeAt(v).first), b.values.push_back(lobeAt(v).second);
  return asset;
}

std::string causes(const std::vector<AssetFault>& faults) {
  std::string text;
  for (const AssetFault& fault : faults) {
    text += (text.empty() ? "" : " ") + fault.cause;
    EXPECT_FALSE(fault.what.empty() || fault.cure.empty());
  }
  return text;
}

void expectFaults(const StoredAsset& asset, const std::string& faults, const std::string& harmless = "") {
  const AssetExamination found = examineAsset("a.glb", asset);
  EXPECT_EQ(causes(found.faults), faults);
  EXPECT_EQ(causes(found.harmless), harmless);
}

}  // namespace

TEST(ValidateAsset, SoundOnes) {
  expectFaults(soundAsset(), "");
  expectFaults(soundAsset(2), "");
  const AssetExamination found = examineAsset("a.glb", soundAsset(2));
  EXPECT_EQ(found.first_set, 2);
  ASSERT_EQ(found.uvs.size(), kVertices);
  EXPECT_EQ(found.uvs[7].second, lobeAt(7).second);
  EXPECT_FALSE(found.undone);
}

TEST(ValidateAsset, Stripped) {
  StoredAsset asset = soundAsset(2);
  asset.sets[0].erase(2), asset.sets[0].erase(3);
  expectFaults(asset, "stripped");
  EXPECT_NE(examineAsset("a.glb", asset).faults[0].what.find("TEXCOORD_2 and TEXCOORD_3, the file has TEXCOORD_0 to TEXCOORD_1"),
            std::string::npos);
  for (int set : {0, 1}) asset.sets[0][set].values.assign(kVertices, {});
  expectFaults(asset, "stripped");  // fillers are no lobes, though with V upside down they are unit vectors
  asset.sets[0].clear();
  expectFaults(asset, "stripped");
  EXPECT_EQ(examineAsset("a.glb", asset).first_set, -1);
  StoredAsset one_part = soundAsset();
  one_part.sets.emplace_back();
  expectFaults(one_part, "stripped");
  one_part.sets[1][0] = one_part.sets[0][0];
  EXPECT_NE(examineAsset("a.glb", one_part).faults[0].what.find("the file has only TEXCOORD_0"), std::string::npos)
      << "set 1 is not in both parts";
}

TEST(ValidateAsset, NeverBaked) {
  StoredAsset asset = soundAsset(2);
  asset.info.reset();
  asset.sets[0].erase(2), asset.sets[0].erase(3);
  expectError<InputError>([&] { examineAsset("a.glb", asset); }, "not a baked asset");
  for (const int set : {1, 2, 3}) asset.sets[0][set] = asset.sets[0][0];
  for (const int set : {0, 1, 2, 3}) asset.sets[0][set].values.assign(kVertices, {0.3F, 0.4F});
  expectError<InputError>([&] { examineAsset("a.glb", asset); }, "not a baked asset");
}

TEST(ValidateAsset, Moved) {
  StoredAsset asset = soundAsset(2);
  auto& sets = asset.sets[0];
  sets[0] = sets[2], sets[1] = sets[3];
  sets.erase(2), sets.erase(3);
  expectFaults(asset, "moved");
  EXPECT_EQ(examineAsset("a.glb", asset).first_set, 0);
  StoredAsset all_there = soundAsset(0);
  all_there.info->first_uv_set = 2;
  all_there.sets[0][2] = all_there.sets[0][3] = {"float", std::vector<Vec2>(kVertices, {0.3F, 0.4F}), {}};
  expectFaults(all_there, "moved");
}

TEST(ValidateAsset, WithoutMetadataTheUnitVectorsTell) {
  StoredAsset asset = soundAsset(2);
  asset.info.reset();
  expectFaults(asset, "", "no-metadata");
  EXPECT_EQ(examineAsset("a.glb", asset).first_set, 2);
  for (int set : {2, 3})
    for (Vec2& uv : asset.sets[0][set].values) uv.y = 1 - uv.y;
  EXPECT_EQ(examineAsset("a.glb", asset).first_set, 2) << "with V upside down too";
}

TEST(ValidateAsset, QuantisedUnderATextureTransform) {
  StoredAsset asset = soundAsset();
  const Vec2 offset{-1, -2}, scale{4, 5};
  for (auto& [set, uvs] : asset.sets[0]) {
    uvs.type = "normalised 16-bit integer";
    uvs.transform = {offset, scale};
    for (Vec2& uv : uvs.values)
      uv = {std::round((uv.x - offset.x) / scale.x * 65535) / 65535, std::round((uv.y - offset.y) / scale.y * 65535) / 65535};
  }
  expectFaults(asset, "quantised");
  const AssetExamination found = examineAsset("a.glb", asset);
  EXPECT_TRUE(found.undone);
  EXPECT_NEAR(found.uvs[7].first.x, lobeAt(7).first.x, 1e-4);
  EXPECT_NEAR(found.uvs[7].second.y, lobeAt(7).second.y, 1e-4);
}

TEST(ValidateAsset, TextureTransforms) {
  StoredAsset asset = soundAsset();
  for (auto& [set, uvs] : asset.sets[0]) uvs.transform = {Vec2{0.5F, 0.5F}, Vec2{3, 3}};
  expectFaults(asset, "");  // of a texture that is only meant for textures: raw numbers are lobes
  for (auto& [set, uvs] : asset.sets[0])
    for (Vec2& uv : uvs.values) uv = {(uv.x - 0.5F) / 3, (uv.y - 0.5F) / 3};
  expectFaults(asset, "texture-transform");
  EXPECT_NEAR(examineAsset("a.glb", asset).uvs[7].first.x, lobeAt(7).first.x, 1e-5);
}

TEST(ValidateAsset, Numbers) {
  StoredAsset asset = soundAsset();
  asset.sets[0][0].values[3].x = NAN;
  expectFaults(asset, "not-finite not-unit");
  asset = soundAsset();
  for (size_t v = 0; v < 40; ++v) asset.sets[0][0].values[v] = asset.sets[0][1].values[v] = {};
  expectFaults(asset, "zeros not-unit");
  asset = soundAsset();
  asset.sets[0][1].values[3].y = -1;
  expectFaults(asset, "negative-density");
  asset = soundAsset();
  for (Vec2& uv : asset.sets[0][0].values) uv.x *= 1.02F;
  expectFaults(asset, "not-unit");
}

TEST(ValidateAsset, HalfFloatsAreHarmless) {
  StoredAsset asset = soundAsset();
  for (auto& [set, uvs] : asset.sets[0])
    for (Vec2& uv : uvs.values)
      for (float* x : {&uv.x, &uv.y}) {
        int exponent = 0;
        const float mantissa = std::frexp(*x, &exponent);
        *x = std::ldexp(std::round(mantissa * 2048) / 2048, exponent);
      }
  expectFaults(asset, "", "half-float");
  for (const float one : {1.0F, -1.0F}) {  // these are the same in any format
    asset.sets[0][0].values.assign(kVertices, {one, 0});
    asset.sets[0][1].values.assign(kVertices, {0, 1});
    expectFaults(asset, "");
  }
}

TEST(ValidateAsset, OddMetadata) {
  StoredAsset asset = soundAsset();
  EXPECT_FALSE(examineAsset("a.glb", asset).fatal);
  asset.info->lobe = "ghost";
  auto fatal = examineAsset("a.glb", asset).fatal;
  ASSERT_TRUE(fatal);
  EXPECT_EQ(fatal->cause, "odd-metadata");
  EXPECT_NE(fatal->what.find("lobe 'ghost' is neither mean nor fit"), std::string::npos) << fatal->what;
  asset.info.reset();
  asset.has_info = true;
  asset.info_fault = "version 7 of the layout is unknown";
  fatal = examineAsset("a.glb", asset).fatal;
  ASSERT_TRUE(fatal);
  EXPECT_NE(fatal->what.find("version 7"), std::string::npos) << fatal->what;
}

TEST(ValidateAsset, TheAttributeHasTheLobesOfTheSets) {
  StoredAsset asset = soundAsset();
  for (size_t v = 0; v < kVertices; ++v) asset.occlusion.push_back(lobeAt(v));
  expectFaults(asset, "");
  asset.occlusion[3].second.y *= 1.001F;  // as by half floats
  expectFaults(asset, "");
  asset.occlusion[3].second.y += 0.01F;
  expectFaults(asset, "attribute");
  asset.occlusion[3].second.y = NAN;
  expectFaults(asset, "attribute");
}

// glTF importers read eight sets at most; all of them are named.
TEST(ValidateAsset, NamesTheSetsThatEveryPartHas) {
  const auto asset = [](std::initializer_list<std::initializer_list<int>> parts) {
    StoredAsset made;
    for (const auto& sets : parts) {
      made.sets.emplace_back();
      for (const int set : sets) made.sets.back()[set] = {};
    }
    return made;
  };
  EXPECT_EQ(uvSetsText(asset({{0, 1, 2, 3, 4, 5, 6, 7}})), "TEXCOORD_0 to TEXCOORD_7");
  EXPECT_EQ(uvSetsText(asset({{6, 7}, {0, 7}})), "only TEXCOORD_7");
  EXPECT_EQ(uvSetsText(asset({{0}, {1}})), "none");
}

TEST(ValidateAsset, ReadsWhatWasEncoded) {
  const TestFolder folder;
  Warnings warnings;
  const Sculpt sculpt = readMesh(folder.write("a.obj", kTetrahedronObj), {}, warnings);
  std::vector<Lobe> lobes;
  for (size_t v = 0; v < 4; ++v) lobes.push_back({{lobeAt(v).first.x, lobeAt(v).first.y, lobeAt(v).second.x}, lobeAt(v).second.y});
  AssetInfo info;
  info.extinction = 1;
  const std::string glb = encodeGlb(sculpt, std::vector<std::vector<Lobe>>{lobes}, info, {}, warnings);
  const StoredAsset asset = readStoredAsset(folder.path / "a.glb", glb, warnings);
  ASSERT_TRUE(asset.info);
  EXPECT_EQ(uvSetsText(asset), "TEXCOORD_0 to TEXCOORD_1");
  EXPECT_EQ(asset.materials, std::vector<std::string>{"cloud"});
  EXPECT_TRUE(asset.sets.at(0).at(1).isFloat());
  expectFaults(asset, "");
  EXPECT_EQ(examineAsset("a.glb", asset).uvs[3].second, lobeAt(3).second);
}
