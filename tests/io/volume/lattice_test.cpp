#include "io/volume/lattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/error.h"
#include "core/harmonics.h"

namespace cloudbake {
namespace {

uint32_t word(const std::string& bytes, size_t at) {
  uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}
uint64_t longWord(const std::string& bytes, size_t at) { return word(bytes, at) | uint64_t(word(bytes, at + 4)) << 32; }

// Offsets as the specification's table in section 3 has them.
TEST(Lattice, KtxVolumeAsTheSpecificationSays) {
  std::vector<float> rgba;
  for (int i = 0; i < 2 * 3 * 4 * 4; ++i) rgba.push_back(float(i) * 0.25F);
  const std::string bytes = encodeKtxVolume({2, 3, 4}, rgba);
  EXPECT_EQ(bytes.substr(0, 12), std::string("\xABKTX 20\xBB\r\n\x1A\n", 12));
  EXPECT_EQ(word(bytes, 12), 109U) << "VK_FORMAT_R32G32B32A32_SFLOAT";
  EXPECT_EQ(word(bytes, 16), 4U) << "typeSize";
  EXPECT_EQ((std::array{word(bytes, 20), word(bytes, 24), word(bytes, 28)}), (std::array{2U, 3U, 4U}));
  EXPECT_EQ((std::array{word(bytes, 32), word(bytes, 36), word(bytes, 40), word(bytes, 44)}), (std::array{0U, 1U, 1U, 0U}))
      << "layers, faces, levels, no supercompression";
  const uint32_t descriptor_at = word(bytes, 48), descriptor_size = word(bytes, 52), pairs_at = word(bytes, 56),
                 pairs_size = word(bytes, 60);
  EXPECT_EQ(descriptor_at, 104U);
  EXPECT_EQ(word(bytes, descriptor_at), descriptor_size);
  EXPECT_EQ(word(bytes, descriptor_at + 8), 2U | (descriptor_size - 4) << 16) << "version 1.3, size of the block";
  EXPECT_EQ(pairs_at, descriptor_at + descriptor_size);
  EXPECT_NE(bytes.substr(pairs_at, pairs_size).find("KTXwriter"), std::string::npos);
  const uint64_t data_at = longWord(bytes, 80), data_size = longWord(bytes, 88);
  EXPECT_EQ(data_at % 16, 0U);
  EXPECT_EQ(data_size, rgba.size() * 4);
  EXPECT_EQ(longWord(bytes, 96), data_size);
  ASSERT_EQ(bytes.size(), data_at + data_size);
  EXPECT_EQ(std::memcmp(bytes.data() + data_at, rgba.data(), data_size), 0);
}

TEST(Lattice, TexturesHoldFourCoefficientsEach) {
  HarmonicLattice lattice{{1, 2, 3}, 0.5F, {2, 1, 3}, 2, 0.7F, {}};
  for (int i = 0; i < 6 * 9; ++i) lattice.coefficients.push_back(float(i));
  const auto files = encodeLattice(lattice, "cloud");
  ASSERT_EQ(files.size(), 4U);
  const auto json = nlohmann::json::parse(files[3].bytes);
  EXPECT_EQ(files[3].name, "cloud.json");
  EXPECT_EQ(json.at("textures"), (nlohmann::json{"cloud.0.ktx2", "cloud.1.ktx2", "cloud.2.ktx2"}));
  EXPECT_EQ(json.at("cells"), (nlohmann::json{2, 1, 3}));
  EXPECT_EQ(json.at("origin"), (nlohmann::json{1, 2, 3}));
  EXPECT_EQ(json.at("extinction").dump(), "0.7");
  for (size_t texture = 0; texture < 3; ++texture)
    for (size_t cell = 0; cell < 6; ++cell)
      for (size_t channel = 0; channel < 4; ++channel) {
        const std::string& bytes = files[texture].bytes;
        float value = -1;
        std::memcpy(&value, bytes.data() + longWord(bytes, 80) + 4 * (4 * cell + channel), 4);
        const size_t coefficient = 4 * texture + channel;
        EXPECT_EQ(value, coefficient < 9 ? float(9 * cell + coefficient) : 0) << texture << " " << cell << " " << channel;
      }
}

// What was written, and readers of the files.
struct Written {
  HarmonicLattice lattice{{1, 2, 3}, 0.5F, {2, 4, 3}, 2, 0.7F, {}};
  std::vector<LatticeFile> files;
  Written() {
    for (int i = 0; i < 24 * 9; ++i) lattice.coefficients.push_back(float(i) / 7 - 3);
    files = encodeLattice(lattice, "cloud");
  }
  HarmonicLattice read() const {
    return decodeLattice("in/cloud.json", files.back().bytes, [&](const std::string& name) {
      for (const LatticeFile& file : files)
        if (file.name == name) return file.bytes;
      throw std::runtime_error("no " + name);
    });
  }
  std::string refusal() const {
    try {
      read();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return "";
  }
};

TEST(Lattice, IsReadAsItWasWritten) {
  for (const int order : {1, 2, 3}) {
    Written written;
    written.lattice.order = order;
    written.lattice.coefficients.resize(24 * harmonicCount(order), 0.125F);
    written.files = encodeLattice(written.lattice, "cloud");
    const HarmonicLattice lattice = written.read();
    EXPECT_EQ(lattice.origin, written.lattice.origin);
    EXPECT_EQ(lattice.cell_size, 0.5F);
    EXPECT_EQ(lattice.cells, written.lattice.cells);
    EXPECT_EQ(lattice.order, order);
    EXPECT_EQ(lattice.extinction, 0.7F);
    EXPECT_EQ(lattice.coefficients, written.lattice.coefficients);
  }
}

TEST(Lattice, WhatIsNoLatticeIsRefused) {
  const auto changed = [](const char* key, const nlohmann::json& value) {
    Written written;
    nlohmann::json json = nlohmann::json::parse(written.files.back().bytes);
    json[key] = value;
    written.files.back().bytes = json.dump();
    return written.refusal();
  };
  const auto damaged = [](size_t at, const std::string& bytes) {
    Written written;
    written.files[1].bytes.replace(at, bytes.size(), bytes);
    return written.refusal();
  };
  EXPECT_EQ(changed("comment", 3), "");
  Written no_json;
  no_json.files.back().bytes = "{";
  EXPECT_NE(no_json.refusal().find("in/cloud.json: this is not the description of a lattice"), std::string::npos) << no_json.refusal();
  EXPECT_NE(changed("schema", "other").find("not the description"), std::string::npos);
  for (const auto& [key, value] : {std::pair<const char*, nlohmann::json>{"order", 4},
                                   {"order", 0},
                                   {"cells", {1, 4, 3}},
                                   {"cells", {2, 4, 3000}},
                                   {"cell_size", 0},
                                   {"cell_size", -1},
                                   {"extinction", 0}})
    EXPECT_NE(changed(key, value).find("out of range"), std::string::npos) << key << " " << value;
  for (const auto& [key, value] :
       {std::pair<const char*, nlohmann::json>{"order", "two"}, {"cells", {2, 4}}, {"origin", nullptr}, {"textures", 3}, {"cells", "all"}})
    EXPECT_NE(changed(key, value).find(std::string("'") + key + "' is missing"), std::string::npos) << key << " " << value;
  EXPECT_NE(changed("textures", {"cloud.0.ktx2"}).find("a texture for every four"), std::string::npos);
  EXPECT_NE(changed("textures", {"cloud.0.ktx2", "../cloud.1.ktx2", "cloud.2.ktx2"}).find("not beside"), std::string::npos);
  EXPECT_NE(changed("cells", {4, 2, 3}).find("in/cloud.0.ktx2: the texture is not a volume"), std::string::npos);
  EXPECT_NE(damaged(0, "no").find("in/cloud.1.ktx2: this is not a KTX"), std::string::npos);
  EXPECT_NE(damaged(12, "\x01").find("not a volume"), std::string::npos);
  EXPECT_NE(damaged(80, std::string(8, '\xff')).find("ends early"), std::string::npos);
  EXPECT_NE(damaged(88, "\x01").find("ends early"), std::string::npos);
  Written cut;
  cut.files[0].bytes.resize(60);
  EXPECT_NE(cut.refusal().find("not a KTX"), std::string::npos);
  cut.files[0].bytes = Written().files[0].bytes.substr(0, Written().files[0].bytes.size() - 1);
  EXPECT_NE(cut.refusal().find("ends early"), std::string::npos);
  Written infinite;
  infinite.lattice.coefficients[5] = INFINITY;
  infinite.files = encodeLattice(infinite.lattice, "cloud");
  EXPECT_NE(infinite.refusal().find("not finite"), std::string::npos);
}

}  // namespace
}  // namespace cloudbake
