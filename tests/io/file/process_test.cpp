#include "io/file/process.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <cstdlib>

#include "tests/io/io_helpers.h"

using namespace cloudbake;

namespace {

// What `sh -c SCRIPT` writes to its descriptor 3, and its exit code.
std::pair<std::string, int> outputOf(const std::string& script, std::vector<Inherited> inherited = {}) {
  Descriptor to_read, to_write;
  openPipe(to_read, to_write);
  inherited.push_back({3, to_write.number});
  const pid_t process = startProcess("/bin/sh", {"sh", "-c", script}, inherited);
  to_write.close();
  std::string bytes;
  EXPECT_EQ(readToEnd(to_read.number, bytes), 0);
  const ProcessEnd end = waitForProcess(process);
  return {bytes, end.signal == 0 ? end.code : -end.signal};
}

}  // namespace

TEST(Process, WritesToItsPipeAndEndsWithItsCode) {
  EXPECT_EQ(outputOf("printf 'one\\0two' >&3; exit 7"), (std::pair{std::string("one\0two", 7), 7}));
  EXPECT_EQ(outputOf("kill -9 $$").second, -9);
  EXPECT_EQ(outputOf("head -c 300000 /dev/zero >&3").first.size(), 300000U);
}

// The targets have the numbers that copies of the sources would get, crossed: none may be replaced before it is used.
TEST(Process, InheritsWhatIsListed) {
  Descriptor first, second;
  openInMemory(first, "first"), openInMemory(second, "second");
  const int free = std::max(first.number, second.number) + 3;  // beyond the pipe that outputOf opens
  // sh knows only descriptors below ten by their numbers.
  const auto copied = [](int from) { return "cat /proc/self/fd/" + std::to_string(from) + " >&3; "; };
  const auto [read, code] = outputOf(copied(free) + copied(free + 1) + "cat >&3", {{0}, {free + 1, first.number}, {free, second.number}});
  EXPECT_EQ(read, "secondfirst");
}

TEST(Process, AProgramThatIsMissingIsAnError) {
  expectError<IoError>([] { startProcess("/no/such/program", {"program"}, {}); },
                       "/no/such/program: cannot start this program: No such file");
}

// A program in the working folder is not ours, whatever PATH says.
TEST(Process, NothingIsStartedFromTheWorkingFolder) {
  expectError<IoError>([] { startProcess("tool", {"tool"}, {}); }, "tool: cannot start this program: its path is not absolute");
}

// A child gets a few variables by their names, and no others: code that LD_PRELOAD names does not go on into it.
TEST(Process, PassesOnAFewVariables) {
  ::setenv("LANG", "C.UTF-8", 1), ::setenv("NO_COLOR", "1", 1), ::setenv("CLOUDBAKE_SECRET", "x", 1);
  const std::string told = "\n" + outputOf("env >&3").first;
  for (const char* line : {"\nPATH=", "\nLANG=C.UTF-8\n", "\nNO_COLOR=1\n"}) EXPECT_NE(told.find(line), std::string::npos) << told;
  EXPECT_EQ(told.find("CLOUDBAKE_SECRET"), std::string::npos) << told;
  ::unsetenv("CLOUDBAKE_SECRET"), ::unsetenv("NO_COLOR");
}

TEST(Process, AClosedReaderIsAnErrorOfWriting) {
  Descriptor full(::open("/dev/full", O_WRONLY));
  EXPECT_EQ(writeAll(full.number, std::string_view("x")), ENOSPC);
}

// Without a free descriptor the message says what could not be made, and why.
TEST(Process, NoDescriptorIsLeft) {
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit none{0, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  Descriptor file, other;
  expectError<IoError>([&] { openInMemory(file, "bytes"); }, "cannot create a file in memory: Too many open files");
  expectError<IoError>([&] { openPipe(file, other); }, "cannot create a pipe: Too many open files");
  ::setrlimit(RLIMIT_NOFILE, &before);
}
