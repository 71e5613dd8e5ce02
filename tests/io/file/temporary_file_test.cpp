// What is left of processes that were killed, and what only looks like it.
#include "io/file/temporary_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "io/file/write_file.h"
#include "tests/io/io_helpers.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> filesOf(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

// The temporary file of a process that is killed while it writes.
fs::path leaveOne(const fs::path& folder) {
  const std::vector<fs::path> before = filesOf(folder);
  const pid_t child = ::fork();
  if (child == 0) {
    const TemporaryFile file(folder, 0600);
    writeAll(file.descriptor(), std::string_view("half of it"));
    ::raise(SIGKILL);
  }
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status));
  const std::vector<fs::path> after = filesOf(folder);
  EXPECT_EQ(after.size(), before.size() + 1);
  for (const fs::path& file : after)
    if (std::find(before.begin(), before.end(), file) == before.end()) return file;
  return {};
}

TEST(TemporaryFile, OfAKilledProcessIsRemovedByTheNextProbe) {
  const TestFolder folder;
  leaveOne(folder.path);
  leaveOne(folder.path);
  const fs::path target = folder.write("a.glb", "old");
  probeTargets({&target, 1});
  EXPECT_EQ(filesOf(folder.path), std::vector{target});
}

TEST(TemporaryFile, OfALivingProcessStays) {
  const TestFolder folder;
  const TemporaryFile file(folder.path, 0600);
  ASSERT_GE(file.descriptor(), 0);
  const std::vector<fs::path> before = filesOf(folder.path);
  removeAbandonedFiles(folder.path);
  EXPECT_EQ(filesOf(folder.path), before);
}

TEST(TemporaryFile, WhatMayBeSomebodyElsesStays) {
  const TestFolder folder;
  const fs::path left = leaveOne(folder.path);
  const std::string name = left.filename().string();
  fs::create_hard_link(left, folder.path / "my_other_name");
  folder.write(".cloudbake-0123456789abcdef", "mine");           // what is missing is the machine
  folder.write(".cloudbake-00000000-0123456789abcdef", "mine");  // of another machine
  folder.write(name.substr(0, name.size() - 1) + "x", "mine");   // no number
  folder.write(name + "0", "mine");
  fs::create_symlink("my_other_name", folder.path / (name.substr(0, name.size() - 4) + "0000"));
  fs::create_directory(folder.path / (name.substr(0, name.size() - 4) + "0001"));
  const std::vector<fs::path> before = filesOf(folder.path);
  ASSERT_EQ(before.size(), 8U);
  removeAbandonedFiles(folder.path);
  EXPECT_EQ(filesOf(folder.path), before);
  fs::remove(folder.path / "my_other_name");
  removeAbandonedFiles(folder.path);
  EXPECT_EQ(filesOf(folder.path).size(), 6U);
}

TEST(TemporaryFile, ThatSomebodyElseLocksDisturbsNobody) {
  const TestFolder folder;
  const fs::path left = leaveOne(folder.path), target = folder.path / "a.glb";
  const Descriptor foreign(::open(left.c_str(), O_RDONLY | O_CLOEXEC));
  ASSERT_EQ(::flock(foreign.number, LOCK_EX | LOCK_NB), 0);
  probeTargets({&target, 1});
  writeFileAtomically(target, "new");
  EXPECT_EQ(readFileBytes(target), "new");
  EXPECT_EQ(readFileBytes(left), "half of it");
}

TEST(TemporaryFile, AllOfAProcessAreRemovedAtASignal) {
  const TestFolder folder;
  const fs::path target = folder.write("a.glb", "old");
  PendingFile replacing(target), making(folder.path / "b.glb");
  replacing.write("new");
  EXPECT_EQ(filesOf(folder.path).size(), 3U);
  removeTemporaryFiles();
  EXPECT_EQ(filesOf(folder.path), std::vector{target});
  EXPECT_EQ(readFileBytes(target), "old");
}

}  // namespace
}  // namespace cloudbake
