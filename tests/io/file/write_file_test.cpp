#include "io/file/write_file.h"

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <thread>

#include "tests/io/io_helpers.h"

using namespace cloudbake;
namespace fs = std::filesystem;

namespace {

size_t filesIn(const fs::path& folder) { return size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator())); }

}  // namespace

TEST(WriteFile, WritesAndReplaces) {
  const TestFolder folder;
  const fs::path target = folder.path / "a.bin";
  const std::string first("one\0two", 7), second(300000, 'x');
  writeFileAtomically(target, first);
  EXPECT_EQ(readFileBytes(target), first);
  writeFileAtomically(target, second);
  EXPECT_EQ(readFileBytes(target), second);
  writeFileAtomically(target, std::string_view());
  EXPECT_EQ(readFileBytes(target), "");
  EXPECT_EQ(filesIn(folder.path), 1U);
}

TEST(WriteFile, KeepsThePermissionsOfTheFileItReplaces) {
  const TestFolder folder;
  const fs::path target = folder.write("a.txt", "old");
  fs::permissions(target, fs::perms::owner_read | fs::perms::owner_write | fs::perms::others_read);
  writeFileAtomically(target, std::string_view("new"));
  EXPECT_EQ(fs::status(target).permissions(), fs::perms::owner_read | fs::perms::owner_write | fs::perms::others_read);
}

TEST(WriteFile, GivesANewFileWhatTheUmaskLeaves) {
  const TestFolder folder;
  const mode_t before = ::umask(027);
  writeFileAtomically(folder.path / "a.txt", "new");
  EXPECT_EQ(::umask(before), 027U);
  struct stat status {};
  ASSERT_EQ(::stat((folder.path / "a.txt").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0640U);
}

TEST(WriteFile, APendingFileReplacesNothingBeforeItsCommit) {
  const TestFolder folder;
  const fs::path target = folder.write("a.txt", "old");
  {
    PendingFile file(target);
    file.write("half of the");
  }
  EXPECT_EQ(readFileBytes(target), "old");
  EXPECT_EQ(filesIn(folder.path), 1U);
  PendingFile file(target);
  file.write("in two ");
  file.write("pieces");
  EXPECT_EQ(readFileBytes(target), "old");
  file.commit();
  EXPECT_EQ(readFileBytes(target), "in two pieces");
  EXPECT_EQ(filesIn(folder.path), 1U);
}

TEST(WriteFile, AProbeFindsWhatCannotBeWritten) {
  const TestFolder folder;
  const fs::path file = folder.write("file", "x"), long_name = folder.path / std::string(300, 'a');
  const auto refused = [](const fs::path& target, const std::string& why) {
    expectError<IoError>([&] { probeTargets({&target, 1}); }, target.string() + ": cannot write: " + why);
  };
  refused(folder.path / "nowhere" / "a.glb", "No such file");
  refused(folder.path, "Is a directory");
  refused(file / "a.glb", "Not a directory");
  refused(long_name, "File name too long");
  expectError<IoError>([&] { probeFolder(file / "below" / "folder"); }, "part of the path is a file");
  const std::vector<fs::path> right{folder.path / "new.glb", file, "/dev/null"};
  probeTargets(right);
  probeFolder(folder.path / "new" / "folder");
  EXPECT_EQ(filesIn(folder.path), 1U);
  EXPECT_EQ(readFileBytes(file), "x");
}

TEST(WriteFile, NamesTargetReasonAndCure) {
  const TestFolder folder;
  const fs::path missing = folder.path / "nowhere" / "a.glb";
  expectError<IoError>([&] { writeFileAtomically(missing, std::string_view("x")); }, missing.string() + ": cannot write: No such file");
  expectError<IoError>([&] { writeFileAtomically(missing, std::string_view("x")); }, "create the folder first");
  fs::create_directory(folder.path / "taken");
  expectError<IoError>([&] { writeFileAtomically(folder.path / "taken", std::string_view("x")); }, "a folder has this name");
  EXPECT_EQ(filesIn(folder.path), 1U);
}

// A limit on file sizes makes write(2) fail halfway, as a full disk does.
TEST(WriteFile, LeavesTheOldFileAndNoTemporaryWhenWritingFails) {
  const TestFolder folder;
  const fs::path target = folder.write("a.glb", "the old file");
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 4096;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  expectError<IoError>([&] { writeFileAtomically(target, std::string(100000, 'x')); }, "cannot write");
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(readFileBytes(target), "the old file");
  EXPECT_EQ(filesIn(folder.path), 1U);
}

TEST(WriteFile, WritersOfOneTargetDoNotMix) {
  const TestFolder folder;
  const fs::path target = folder.path / "a.glb";
  std::vector<std::thread> writers;
  for (const char letter : {'a', 'b', 'c', 'd'})
    writers.emplace_back([&target, letter] {
      for (int i = 0; i < 20; ++i) writeFileAtomically(target, std::string(200000, letter));
    });
  for (std::thread& writer : writers) writer.join();
  const std::string bytes = readFileBytes(target);
  EXPECT_EQ(bytes, std::string(200000, bytes.at(0)));
  EXPECT_EQ(filesIn(folder.path), 1U);
}

TEST(ReadFile, SaysWhatIsWrong) {
  const TestFolder folder;
  expectError<IoError>([&] { readFileBytes(folder.path / "none.obj"); }, "No such file");
  expectError<IoError>([&] { readFileBytes(folder.path); }, "this is a folder");
}

// XXH3-128 of nothing, seed 0, as the reference implementation documents it; any bit of the input changes the digits.
TEST(HashBytes, IsXxh3) {
  EXPECT_EQ(hashBytes(""), "99aa06d3014798d86001c324468d497f");
  EXPECT_EQ(hashBytes(std::string(1000, 'a')).size(), 32U);
  EXPECT_NE(hashBytes(std::string(1000, 'a')), hashBytes(std::string(999, 'a') + 'b'));
}

TEST(WriteFile, ALinkStaysAndItsTargetIsReplaced) {
  const TestFolder folder;
  const fs::path target = folder.write("real.glb", "old");
  fs::create_symlink("real.glb", folder.path / "link.glb");
  fs::create_symlink("new.glb", folder.path / "dangling.glb");
  writeFileAtomically(folder.path / "link.glb", std::string_view("new"));
  writeFileAtomically(folder.path / "dangling.glb", std::string_view("made"));
  EXPECT_TRUE(fs::is_symlink(folder.path / "link.glb"));
  EXPECT_TRUE(fs::is_symlink(folder.path / "dangling.glb"));
  EXPECT_EQ(readFileBytes(target), "new");
  EXPECT_EQ(readFileBytes(folder.path / "new.glb"), "made");
  EXPECT_EQ(filesIn(folder.path), 4U);
  fs::create_symlink("round.glb", folder.path / "round.glb");
  expectError<IoError>([&] { writeFileAtomically(folder.path / "round.glb", std::string_view("x")); }, "cannot write");
}

TEST(WriteFile, PipesAndDevicesAreWrittenToAsTheyAre) {
  const TestFolder folder;
  const fs::path pipe = folder.path / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::string read;
  std::thread reader([&] { read = readFileOrPipe(pipe); });
  writeFileAtomically(pipe, std::string_view("through"));
  reader.join();
  EXPECT_EQ(read, "through");
  EXPECT_TRUE(fs::is_fifo(pipe));
  writeFileAtomically("/dev/null", std::string_view("gone"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  expectError<IoError>([&] { writeFileAtomically("/dev/full", std::string_view("x")); }, "No space left");
}

// A file below /dev is a file; only what a process has opened is written to as it is.
TEST(WriteFile, AFileInSharedMemoryIsReplaced) {
  const fs::path target = "/dev/shm/cloudbake-" + std::to_string(::getpid()) + ".glb";
  writeFileAtomically(target, std::string_view("a long old file"));
  struct stat before {
  }, after{};
  ASSERT_EQ(::stat(target.c_str(), &before), 0);
  writeFileAtomically(target, std::string_view("new"));
  ASSERT_EQ(::stat(target.c_str(), &after), 0);
  EXPECT_EQ(readFileBytes(target), "new");
  EXPECT_NE(before.st_ino, after.st_ino);
  fs::remove(target);
}

TEST(WriteFile, NamesThatCannotBeAreErrors) {
  const TestFolder folder;
  expectError<IoError>([&] { writeFileAtomically(folder.path / std::string(300, 'a'), std::string_view("x")); }, "choose a shorter name");
  folder.write("file", "x");
  expectError<IoError>([&] { writeFileAtomically(folder.path / "file" / "a.glb", std::string_view("x")); }, "part of the path is a file");
}

TEST(ReadFile, OnlyRegularFilesAreOpened) {
  const TestFolder folder;
  const fs::path pipe = folder.path / "pipe.obj";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  expectError<IoError>([&] { readFileBytes(pipe); }, "this is a pipe");  // opening it would wait for ever
  expectError<IoError>([&] { readFileBytes("/dev/zero"); }, "this is a device");
  expectError<IoError>([&] { readFileBytes(folder.path); }, "this is a folder");
  const fs::path huge = folder.write("huge.obj", "");
  fs::resize_file(huge, kMaxFileBytes + 1);
  expectError<InputError>([&] { readFileBytes(huge); }, "larger than 8 GiB");
}
