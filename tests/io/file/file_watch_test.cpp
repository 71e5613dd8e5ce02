// Changes of a file and of those that it refers to; files that vanish for a moment, or are being written.
#include "io/file/file_watch.h"

#include <fcntl.h>
#include <sys/stat.h>

#include "tests/io/io_helpers.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;

struct FileWatchTest : testing::Test {
  // A change is reported in the second call that finds it.
  static bool reports(FileWatch& watch) { return !watch.changed() && watch.changed(); }
  static bool isQuiet(FileWatch& watch) {
    for (int i = 0; i < 2 * FileWatch::kPatience; ++i)
      if (watch.changed()) return false;
    return true;
  }
  // Over the same file, as an editor does that keeps it.
  static void writeOver(const fs::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }
  static void setTime(const fs::path& path, time_t seconds) {
    const timespec times[2] = {{seconds, 0}, {seconds, 0}};
    ASSERT_EQ(::utimensat(AT_FDCWD, path.c_str(), times, 0), 0);
  }

  TestFolder folder;
  fs::path file = folder.write("a.obj", "one");
  std::vector<fs::path> others;
  FileWatch watch{[&] {
    std::vector<fs::path> files{file};
    files.insert(files.end(), others.begin(), others.end());
    return files;
  }};
};

TEST_F(FileWatchTest, ReportsAChangeOnce) {
  EXPECT_TRUE(isQuiet(watch));
  writeOver(file, "longer");
  EXPECT_TRUE(reports(watch));
  EXPECT_TRUE(isQuiet(watch));
  writeOver(file, "again longer");
  EXPECT_TRUE(reports(watch));
}

TEST_F(FileWatchTest, NoticesEachSign) {
  setTime(file, 1000);
  EXPECT_TRUE(reports(watch)) << "the time alone, also an earlier one";
  writeOver(file, "four");
  setTime(file, 1000);
  EXPECT_TRUE(reports(watch)) << "the size alone";
  folder.write("new.obj", "five");
  setTime(folder.path / "new.obj", 1000);
  fs::rename(folder.path / "new.obj", file);
  EXPECT_TRUE(reports(watch)) << "another file of the same size and time in its place";
}

TEST_F(FileWatchTest, WaitsWhileTheFileIsWritten) {
  for (int i = 0; i < 10; ++i) {
    writeOver(file, std::string(size_t(10 + i), 'x'));
    EXPECT_FALSE(watch.changed());
  }
  EXPECT_TRUE(watch.changed());
}

TEST_F(FileWatchTest, WaitsForAFileThatIsBeingReplaced) {
  fs::remove(file);
  for (int i = 0; i < FileWatch::kPatience / 2; ++i) EXPECT_FALSE(watch.changed());
  folder.write("a.obj", "two");
  EXPECT_TRUE(reports(watch));
  EXPECT_TRUE(isQuiet(watch));
  // Moved away and back, it is the same as before.
  fs::rename(file, folder.path / "b.obj");
  EXPECT_FALSE(watch.changed());
  fs::rename(folder.path / "b.obj", file);
  EXPECT_TRUE(isQuiet(watch));
}

TEST_F(FileWatchTest, WaitsForTheBytesOfAFile) {
  writeOver(file, "");
  for (int i = 0; i < FileWatch::kPatience / 2; ++i) EXPECT_FALSE(watch.changed());
  writeOver(file, "two");
  EXPECT_TRUE(reports(watch));
  writeOver(file, "");
  for (int i = 1; i < FileWatch::kPatience; ++i) EXPECT_FALSE(watch.changed()) << i;
  EXPECT_TRUE(watch.changed()) << "it stays empty";
}

TEST_F(FileWatchTest, ReportsAFileThatHasGone) {
  fs::remove(file);
  for (int i = 1; i < FileWatch::kPatience; ++i) EXPECT_FALSE(watch.changed()) << i;
  EXPECT_TRUE(watch.changed());
  EXPECT_TRUE(isQuiet(watch));
  folder.write("a.obj", "one");
  EXPECT_TRUE(reports(watch)) << "it is back";
}

TEST_F(FileWatchTest, WatchesTheFilesThatAreNamed) {
  const fs::path material = folder.write("a.mtl", "red"), missing = folder.path / "b.png";
  writeOver(file, "names a.mtl and b.png");
  others = {material, missing};
  EXPECT_TRUE(reports(watch));
  EXPECT_TRUE(isQuiet(watch));
  writeOver(material, "green");
  EXPECT_TRUE(reports(watch));
  folder.write("b.png", "picture");
  EXPECT_TRUE(reports(watch)) << "a file that was missing";
  others = {};
  writeOver(file, "names nothing");
  EXPECT_TRUE(reports(watch));
  writeOver(material, "blue as the sea");
  EXPECT_TRUE(isQuiet(watch)) << "it is not named any more";
}

TEST_F(FileWatchTest, FollowsLinks) {
  const fs::path target = folder.write("target.obj", "one");
  fs::remove(file);
  fs::create_symlink("target.obj", file);
  EXPECT_TRUE(reports(watch));
  writeOver(target, "longer");
  EXPECT_TRUE(reports(watch));
}

}  // namespace
}  // namespace cloudbake
