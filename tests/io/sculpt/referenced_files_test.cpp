#include "io/sculpt/referenced_files.h"

#include <gtest/gtest.h>

namespace cloudbake {
namespace {

namespace fs = std::filesystem;

TEST(ReferencedFilesTest, WhatSculptsName) {
  const std::string gltf =
      R"({"buffers": [{"uri": "a%20b.bin"}, {"uri": "data:application/octet-stream;base64,AAAA"}, {}], "images": [{"uri": "t/x.png"}, {"uri": "https://a/b.png"}, 3]})";
  EXPECT_EQ(referencedFiles("f/m.gltf", gltf, false), (std::vector<fs::path>{"f/a b.bin", "f/t/x.png"}));
  EXPECT_EQ(referencedFiles("f/m.OBJ", "mtllib one two.mtl\r\nv 0 0 0\n# mtllib no.mtl\nmtllib b.mtl"),
            (std::vector<fs::path>{"f/one two.mtl", "f/b.mtl"}));
  for (const char* damaged : {"", "{", "[1]", R"({"buffers": {"uri": "a"}})", "glTF\1\1", R"({"images": [{"uri": 3}]})"})
    EXPECT_TRUE(referencedFiles("m.glb", damaged).empty()) << damaged;
  EXPECT_TRUE(referencedFiles("m.stl", "mtllib a.mtl\n").empty());
}

}  // namespace
}  // namespace cloudbake
