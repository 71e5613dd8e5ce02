// Our own libraries are found beside the program, wherever that was started.
#include "io/file/own_library.h"

#include "tests/io/io_helpers.h"

using namespace cloudbake;

namespace fs = std::filesystem;

TEST(OwnLibrary, IsBesideTheProgramOnly) {
  const fs::path program = fs::read_symlink("/proc/self/exe"), before = fs::current_path();
  EXPECT_EQ(ownLibrary(program.filename().string()), program) << "the program itself lies there";
  const TestFolder folder;
  folder.write("libcloudbake_nowhere.so", "x");
  fs::current_path(folder.path);
  EXPECT_EQ(ownLibrary("libcloudbake_nowhere.so"), std::nullopt) << "the working folder does not count";
  EXPECT_EQ(ownLibrary(program.filename().string()), program);
  fs::current_path(before);
  EXPECT_EQ(ownLibrary(""), std::nullopt) << "a folder is no library";
}
