// Where the bytes of buffers come from: names of RFC 3986, data URIs, and the texts around them.
#include "core/text/base64.h"
#include "io/gltf/named_files.h"
#include "tests/io/gltf/gltf_helpers.h"

namespace cloudbake {

namespace {

std::string withBuffer(const std::string& uri, size_t bytes = 0) {
  GltfBuilder gltf = oneTetrahedron();
  gltf.json["buffers"] = Json::array({{{"uri", uri}, {"byteLength", bytes > 0 ? bytes : gltf.binary.size()}}});
  return gltf.json.dump();
}

size_t trianglesOf(const TestFolder& folder, const std::string& text) {
  Warnings warnings;
  return readMesh(folder.write("a.gltf", text), {}, warnings).parts.at(0).triangles.size();
}

}  // namespace

TEST(Buffers, NamesArePercentDecodedAlone) {
  const TestFolder folder;
  const std::string bytes = oneTetrahedron().binary;
  const std::pair<std::string, std::string> names[] = {{"a+b.bin", "a+b.bin"},        {"c%2Bd.bin", "c+d.bin"},
                                                       {"50%.bin", "50%.bin"},        {"5%zz.bin", "5%zz.bin"},
                                                       {"e%25.bin", "e%.bin"},        {"f g.bin", "f g.bin"},
                                                       {"h%20i.bin", "h i.bin"},      {"wölkchen.bin", "wölkchen.bin"},
                                                       {"w%C3%B6lf.bin", "wölf.bin"}, {"j%2", "j%2"}};
  for (const auto& [uri, name] : names) {
    SCOPED_TRACE(uri);
    folder.write(name, bytes);
    EXPECT_EQ(trianglesOf(folder, withBuffer(uri)), 4U);
    EXPECT_EQ(filesNamedByGltf("a.gltf", withBuffer(uri)), std::vector<std::filesystem::path>{name});
  }
}

TEST(Buffers, DataUrisHaveTheirMediaTypes) {
  const TestFolder folder;
  const std::string bytes = oneTetrahedron().binary, base64 = encodeBase64(bytes);
  for (const char* head : {"data:application/octet-stream;base64,", "data:application/gltf-buffer;base64,",
                           "data:Application/Octet-Stream;charset=utf-8;BASE64,"})
    EXPECT_EQ(trianglesOf(folder, withBuffer(head + base64)), 4U) << head;
  const auto refuse = [&](const std::string& uri, const std::string& text) {
    try {
      trianglesOf(folder, withBuffer(uri));
      ADD_FAILURE() << uri << " is read";
    } catch (const InputError& error) {
      EXPECT_NE(error.message.find("buffer 0 " + text), std::string::npos) << error.message;
      EXPECT_LT(error.message.size(), 180U) << error.message;
    }
  };
  refuse("data:text/plain;base64," + base64, "is a data URI of the media type \"text/plain\", not application/octet-stream");
  refuse("data:;base64," + base64, "is a data URI of the media type \"\"");
  refuse("data:" + std::string(1000, 'x') + ";base64," + base64, "is a data URI of the media type \"xxx");
  refuse("data:application/octet-stream," + bytes.substr(0, 0) + "abc", "is a data URI that is not in base64");
  refuse("data:application/octet-stream;base64", "is a data URI without a comma");
  refuse("data:application/octet-stream;base64," + base64.substr(0, 40) + "!" + base64.substr(41), "is a data URI with damaged base64");
  refuse("data:application/octet-stream;base64," + base64.substr(0, 41), "is a data URI with damaged base64");
  refuse("data:application/octet-stream;base64," + base64.substr(0, 40),
         "(a data URI) has 30 bytes, not its byteLength of " + std::to_string(bytes.size()));
}

TEST(Buffers, ADamagedOneIsRefusedWithItsNumber) {
  const TestFolder folder;
  folder.write("short.bin", std::string(10, 'a'));
  folder.write("long.bin", oneTetrahedron().binary + "more");
  EXPECT_EQ(trianglesOf(folder, withBuffer("long.bin")), 4U);  // glTF 2.0, section 3.6.1.1: at least byteLength
  const auto refuse = [&](const std::string& gltf, const std::string& text) {
    expectError<InputError>([&] { trianglesOf(folder, gltf); }, text);
  };
  refuse(withBuffer("short.bin"), "buffer 0 (\"short.bin\") has 10 bytes, not its byteLength of 72");
  refuse(withBuffer("http://clouds.example/a.bin"), "buffer 0 is at \"http://clouds.example/a.bin\", which is not a file");
  GltfBuilder gltf = oneTetrahedron();
  gltf.json["buffers"] = Json::array({{{"byteLength", 72}}});
  refuse(gltf.json.dump(), "buffer 0 has no uri");
  gltf.json["buffers"] = Json::array({{{"byteLength", 7200}}});
  refuse(joinGlb("a", gltf.json.dump(), gltf.binary), "buffer 0 (the binary chunk) has 72 bytes, not its byteLength of 7200");
  gltf.json["buffers"] = Json::array({{{"byteLength", 0}}});
  refuse(joinGlb("a", gltf.json.dump(), gltf.binary), "buffer 0 has a byteLength of 0");
}

TEST(Buffers, TextsMayHaveAMarkAndAnyLineEnds) {
  const TestFolder folder;
  folder.write("a.bin", oneTetrahedron().binary);
  std::string text = Json::parse(withBuffer("a.bin")).dump(2);
  EXPECT_EQ(trianglesOf(folder, "\xEF\xBB\xBF" + text), 4U);
  std::replace(text.begin(), text.end(), '\n', '\r');
  EXPECT_EQ(trianglesOf(folder, text), 4U);
  EXPECT_EQ(trianglesOf(folder, "\xEF\xBB\xBF" + text), 4U);
}

}  // namespace cloudbake
