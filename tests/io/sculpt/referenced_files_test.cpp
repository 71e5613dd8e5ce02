#include "io/sculpt/referenced_files.h"

#include "tests/io/io_helpers.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;

TEST(ReferencedFilesTest, WhatSculptsName) {
  const std::string gltf =
      R"({"buffers": [{"uri": "a%20b.bin"}, {"uri": "data:application/octet-stream;base64,AAAA"}, {}],
          "images": [{"uri": "t/x.png"}, {"uri": "https://a/b.png"}, 3]})";
  EXPECT_EQ(referencedFiles("f/m.gltf", gltf, {}), (std::vector<fs::path>{"f/a b.bin", "f/t/x.png"}));
  EXPECT_EQ(referencedFiles("f/m.OBJ", "mtllib one two.mtl\r\nv 0 0 0\n# mtllib no.mtl\nmtllib b.mtl", {}),
            (std::vector<fs::path>{"f/one", "f/two.mtl", "f/b.mtl"}))
      << "a name with blanks, or two names: there is no file of the whole name";
  for (const char* damaged : {"", "{", "[1]", R"({"buffers": {"uri": "a"}})", "glTF\1\1", R"({"images": [{"uri": 3}]})"})
    EXPECT_TRUE(referencedFiles("m.glb", damaged, {}).empty()) << damaged;
  EXPECT_TRUE(referencedFiles("m.stl", "mtllib a.mtl\n", {}).empty());
}

// Nothing outside the sculpt's folder is listed, and so nothing there is opened, unless it is allowed. Textures of libraries are listed
// too.
TEST(ReferencedFilesTest, NothingThatTheReaderWouldRefuse) {
  const TestFolder folder;
  fs::create_directories(folder.path / "in");
  const fs::path obj = folder.path / "in/m.obj", fbx = folder.path / "in/m.fbx";
  folder.write("x.mtl", "newmtl a\nmap_Kd x.png\n"), folder.write("in/y.mtl", "newmtl a\nmap_Kd -s 1 1 1 y.png\nmap_Ke ../z.png\n");
  folder.write("in/skin.png", "p"), folder.write("z.png", "p");
  const std::string text = "mtllib ../x.mtl\nmtllib y.mtl\n";
  EXPECT_EQ(referencedFiles(obj, text, {}), (std::vector<fs::path>{folder.path / "in/y.mtl", folder.path / "in/y.png"}));
  EXPECT_EQ(referencedFiles(obj, text, {.allow_outside = true}).size(), 5U);
  EXPECT_EQ(referencedFiles("f/m.gltf", R"({"buffers": [{"uri": "../a.bin"}, {"uri": "b.bin"}]})", {}), std::vector<fs::path>{"f/b.bin"});
  EXPECT_EQ(referencedFiles(fbx, std::string("\0\7C:\\art\\skin.png\1 \"../z.png\" gone.png", 35), {}),
            std::vector<fs::path>{folder.path / "in/skin.png"});
}

// Names as they are written in XML and in the header of a PLY, whose data is not searched.
TEST(ReferencedFilesTest, NamesOfForeignSculpts) {
  const TestFolder folder;
  const fs::path skin = folder.write("my skin & bone.png", "p");
  folder.write("data.png", "p");
  const auto named = [&](const char* sculpt, const std::string& bytes) { return referencedFiles(folder.path / sculpt, bytes, {}); };
  EXPECT_EQ(named("a.dae", "<init_from>my%20skin%20&amp;%20bone.png</init_from>"), std::vector<fs::path>{skin});
  EXPECT_EQ(named("a.fbx", "\"tex\\my skin & bone.png\""), std::vector<fs::path>{skin});
  EXPECT_EQ(named("a.x", "TextureFilename { \"data.png\"; }"), std::vector<fs::path>{folder.path / "data.png"});
  EXPECT_EQ(named("a.ply", "ply\ncomment TextureFile my skin & bone.png\nend_header\ndata.png"), std::vector<fs::path>{skin});
}

}  // namespace
}  // namespace cloudbake
