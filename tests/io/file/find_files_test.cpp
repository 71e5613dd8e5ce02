#include "io/file/find_files.h"

#include <fcntl.h>

#include <array>
#include <tuple>

#include "tests/io/io_helpers.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

struct Tree : TestFolder {
  explicit Tree(const Names& files) {
    for (const std::string& file : files) {
      fs::create_directories((path / file).parent_path());
      write(file, file);
    }
  }
  Names matching(const std::string& pattern) {
    Names names;
    for (const fs::path& file : filesMatching(path / pattern, folders)) names.push_back(file.lexically_relative(path).string());
    return names;
  }
  std::set<fs::path> folders;
};

TEST(FindFilesTest, PatternsMatchNamesAndFolders) {
  Tree tree({"a.obj", "b.obj", "b.OBJ", "c d ü.obj", ".hidden.obj", "one/a.obj", "one/two/a.obj", "one/two/b.fbx", ".secret/a.obj",
             "odd[1].obj"});
  EXPECT_EQ(tree.matching("a.obj"), Names{"a.obj"});
  EXPECT_EQ(tree.matching("?.obj"), (Names{"a.obj", "b.obj"}));
  EXPECT_EQ(tree.matching("[bc]*.obj"), (Names{"b.obj", "c d ü.obj"}));
  EXPECT_EQ(tree.matching("*/a.obj"), Names{"one/a.obj"});
  EXPECT_EQ(tree.matching("**/a.obj"), (Names{"a.obj", "one/a.obj", "one/two/a.obj"}));
  EXPECT_EQ(tree.matching("one/**"), (Names{"one/a.obj", "one/two/a.obj", "one/two/b.fbx"}));
  EXPECT_EQ(tree.matching("o*/*/b.*"), Names{"one/two/b.fbx"});
  EXPECT_EQ(tree.matching(".*.obj"), Names{".hidden.obj"});
  EXPECT_EQ(tree.matching("odd[1].obj"), Names{"odd[1].obj"}) << "a file of exactly that name";
  EXPECT_EQ(tree.matching("*.stl"), Names{});
  EXPECT_EQ(tree.matching("no/*.stl"), Names{});
  EXPECT_EQ(tree.matching("one"), Names{}) << "a folder is no file";
}

TEST(FindFilesTest, FoldersThatWereLookedIntoAreTold) {
  Tree tree({"x/a.obj", "x/y/b.obj", "z/c.obj"});
  tree.matching("x/**/*.obj");
  EXPECT_EQ(tree.folders, (std::set<fs::path>{tree.path / "x", tree.path / "x/y"}));
}

TEST(FindFilesTest, LinksToFoldersEndNowhere) {
  Tree tree({"x/a.obj"});
  fs::create_directory_symlink(tree.path / "x", tree.path / "x/loop");
  EXPECT_EQ(tree.matching("**/*.obj"), Names{"x/a.obj"});
  std::set<fs::path> folders;
  EXPECT_EQ(filesBelow(tree.path, "", folders).size(), 1U);
}

// The answers are those of fnmatch(3) in glibc.
TEST(FindFilesTest, PatternsMatchWholeNames) {
  for (const auto& [pattern, name, matches] : std::to_array<std::tuple<const char*, const char*, bool>>({
           {"", "", true},
           {"", "a", false},
           {"*", "", true},
           {"*", "cloud.obj", true},
           {"*.obj", "a.obj", true},
           {"*.obj", "a.off", false},
           {"a*b*c", "aXbYbZc", true},
           {"a*b*c", "aXbYbZ", false},
           {"?", "", false},
           {"a?c", "abc", true},
           {"[a-c]x", "bx", true},
           {"[a-c]x", "dx", false},
           {"[!a-c]x", "dx", true},
           {"[^a-c]x", "bx", false},
           {"[]x]", "]", true},
           {"[a-]", "-", true},
           {"[ab", "[ab", true},
           {"\\*", "*", true},
           {"\\*", "a", false},
           {"_[0-9][0-9].png", "_07.png", true},
           {"**", "ab", true},
           {"a*", "b", false},
           {"*a", "aXa", true},
           {"[\xC3]", "\xC3", true},
       }))
    EXPECT_EQ(matchesPattern(pattern, name), matches) << pattern << " and " << name;
}

TEST(FindFilesTest, FilesBelowLeaveOutTheOutputFolder) {
  Tree tree({"a.obj", "sub/b.obj", "baked/a.glb", ".git/c.obj", ".d.obj"});
  std::set<fs::path> folders;
  EXPECT_EQ(filesBelow(tree.path, tree.path / "sub/../baked", folders),
            (std::vector<fs::path>{tree.path / "a.obj", tree.path / "sub/b.obj"}));
  expectError<IoError>([&] { filesBelow(tree.path / "no", "", folders); }, "cannot read the folder");
}

TEST(FindFilesTest, FixedFolder) {
  EXPECT_EQ(fixedFolder("a/b/*.obj"), "a/b");
  EXPECT_EQ(fixedFolder("**/x.obj"), "");
  EXPECT_EQ(fixedFolder("/a/b?/c"), "/a");
}

}  // namespace
}  // namespace cloudbake
