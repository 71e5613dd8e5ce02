// The structs of settings in GLSL, without a browser.
#include "preview/backdrop/glsl_structs.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace cloudbake {
namespace {

TEST(GlslStructs, HaveTheKeysOfShadersAsMembers) {
  const std::string disc = "struct SmoothDisc {\n  float smooth_radius;\n  float smooth_softness;\n  float smooth_gain;\n};\n";
  EXPECT_EQ(glslWithStructs("// A disc.\n\nstruct SmoothDisc;\nfloat size;\nstruct Own {\n  int x;\n};\n"),
            "// A disc.\n\n" + disc + "float size;\nstruct Own {\n  int x;\n};\n");
  EXPECT_EQ(glslWithStructs("float last"), "float last");
  EXPECT_THROW(glslWithStructs("struct Nothing;\n"), std::out_of_range);
  const std::string& stars = glslStructs().at("Stars");
  for (const char* member : {"  int count;\n", "  uint seed;\n", "  vec3 pole;\n", "  float turn;\n", "  float day_turn;\n"})
    EXPECT_NE(stars.find(member), std::string::npos) << member << " in " << stars;
  EXPECT_EQ(glslStructs().at("Moon").find("light"), std::string::npos) << "the script uses it";
}

TEST(GlslStructs, OfATerrainHaveItsParts) {
  const std::string& terrain = glslStructs().at("Terrain");
  EXPECT_LT(terrain.find("struct TerrainGround {\n  vec3 rock_dark;\n"), terrain.find("struct Terrain {\n  float scale;\n"));
  EXPECT_NE(terrain.find("  bool own_fog;\n"), std::string::npos);
  EXPECT_NE(terrain.find("  TerrainGround ground;\n"), std::string::npos);
  EXPECT_EQ(terrain.find("path"), std::string::npos) << "no shader uses a key of the path";
  EXPECT_EQ(glslStructName("terrain.ground"), "TerrainGround");
}

}  // namespace
}  // namespace cloudbake
