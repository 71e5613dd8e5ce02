// Whose a file is.
#include "io/file/own_file.h"

#include "io/image/image.h"
#include "tests/io/io_helpers.h"

namespace cloudbake {
namespace {

TEST(OwnFile, IsForeignWithoutThem) {
  const TestFolder folder;
  EXPECT_TRUE(isForeignFile(folder.write("a.png", "my picture")));
  EXPECT_FALSE(isForeignFile(folder.write("b.png", encodePng(blankImage(2, 2)))));
  EXPECT_FALSE(isForeignFile(folder.write("empty", "")));
  EXPECT_FALSE(isForeignFile(folder.path / "none"));
  EXPECT_FALSE(isForeignFile(folder.path));
  EXPECT_FALSE(isForeignFile("/dev/null"));
}

}  // namespace
}  // namespace cloudbake
