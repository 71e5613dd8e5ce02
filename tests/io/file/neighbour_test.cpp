#include "io/file/neighbour.h"

#include <sys/stat.h>

#include "tests/io/io_helpers.h"

using namespace cloudbake;

namespace fs = std::filesystem;

// One rule for every file that a sculpt names. Nothing is opened before it is known to be a regular file of a size that fits.
TEST(Neighbour, RefusesByPlaceKindAndSize) {
  const TestFolder folder;
  fs::create_directories(folder.path / "in" / "below");
  const fs::path sculpt = folder.write("in/a.obj", "v 0 0 0\n");
  folder.write("in/b.png", "b"), folder.write("in/below/c.png", "c"), folder.write("out.png", "o");
  const auto refusal = [&](const char* name, bool allow = false) { return refusalOfNeighbour(sculpt, folder.path / "in" / name, allow); };
  for (const char* name : {"b.png", "below/c.png", "below/../b.png", "gone.png"}) EXPECT_EQ(refusal(name), std::nullopt) << name;
  EXPECT_NE(refusal("../out.png").value_or("").find("--allow-outside"), std::string::npos);
  EXPECT_EQ(refusal("../out.png", true), std::nullopt);
  fs::create_symlink(folder.path / "out.png", folder.path / "in" / "link.png");
  EXPECT_TRUE(refusal("link.png").has_value());

  ASSERT_EQ(mkfifo((folder.path / "in" / "pipe.png").c_str(), 0600), 0);
  for (const char* name : {"pipe.png", "below"}) EXPECT_NE(refusal(name).value_or("").find("regular file"), std::string::npos) << name;
  EXPECT_NE(refusalOfNeighbour(sculpt, "/dev/zero", true).value_or("").find("regular file"), std::string::npos);
  expectError<InputError>([&] { readNeighbour(sculpt, folder.path / "in" / "pipe.png", {}); }, "regular file");

  folder.write("in/huge.png", "");
  fs::resize_file(folder.path / "in" / "huge.png", kLargestNeighbour + 1);  // sparse
  EXPECT_NE(refusal("huge.png").value_or("").find("4 GiB"), std::string::npos);
  EXPECT_EQ(readNeighbour(sculpt, folder.path / "in" / "b.png", {}), "b");
  expectError<IoError>([&] { readNeighbour(sculpt, folder.path / "in" / "gone.png", {}); }, "No such file");
}

// Names as programs of other systems write them.
TEST(Neighbour, FindsFilesByNamesOfOtherMachines) {
  const TestFolder folder;
  fs::create_directories(folder.path / "textures");
  const fs::path sculpt = folder.write("a.fbx", "x");
  folder.write("textures/wood.png", "w"), folder.write("stone.png", "s");
  EXPECT_EQ(neighbourNamed(sculpt, "textures\\wood.png", false), folder.path / "textures/wood.png");
  EXPECT_EQ(neighbourNamed(sculpt, "C:\\Users\\me\\stone.png", false), folder.path / "stone.png");
  EXPECT_EQ(neighbourNamed(sculpt, "/home/me/stone.png", false), folder.path / "stone.png");
  EXPECT_EQ(neighbourNamed(sculpt, "gone.png", false), folder.path / "gone.png");
}

// The place that is written comes first; a place that is not allowed is passed over for one that is.
TEST(Neighbour, PrefersThePlaceThatIsWritten) {
  const TestFolder folder;
  fs::create_directories(folder.path / "in/textures");
  const fs::path sculpt = folder.write("in/a.fbx", "x");
  for (const char* name : {"wood.png", "in/wood.png", "in/textures/wood.png"}) folder.write(name, "w");
  EXPECT_EQ(neighbourNamed(sculpt, "textures/wood.png", false), folder.path / "in/textures/wood.png");
  EXPECT_EQ(neighbourNamed(sculpt, "../wood.png", false), folder.path / "in/wood.png");
  EXPECT_EQ(neighbourNamed(sculpt, "../wood.png", true), folder.path / "wood.png");
}
