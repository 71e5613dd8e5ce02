#include "io/sculpt/child_reader.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <fstream>
#include <thread>

#include "core/error.h"
#include "io/file/process.h"
#include "io/file/write_file.h"
#include "tests/folders.h"
#include "tests/io/io_helpers.h"
#include "tests/io/sculpt/sculpt_helpers.h"
#include "tests/pipeline/settings_text.h"
#include "tests/wait.h"

using namespace cloudbake;

namespace fs = std::filesystem;

namespace {

const fs::path kFbx = sourceFolder() / "tests/data/two_quads.fbx";
const fs::path kSelf = "/proc/self/exe";

// The answer of a child that does its work.
std::string answerOf(int argc, char** argv) {
  Descriptor memory;
  openInMemory(memory, "");
  const Descriptor to_parent(::dup(3));
  ::dup2(memory.number, 3);
  serveChildReader(argc, argv);
  ::lseek(3, 0, SEEK_SET);
  std::string answer;
  readToEnd(3, answer);
  ::dup2(to_parent.number, 3);
  return answer;
}

bool isLimited(auto resource, rlim_t most) {
  rlimit limit{};
  return ::getrlimit(resource, &limit) == 0 && limit.rlim_cur == most && limit.rlim_max == most;
}

constexpr const char* kParent = "parent-of-a-child-reader";

fs::path fifoBeside(const fs::path& file) { return file.parent_path() / "fifo"; }

// Never has the whole sculpt. Once it waits for more, it writes to a FIFO, which it keeps open.
[[noreturn]] void waitForInput(int argc, char** argv) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) std::abort();
  ::dup2(ends[0], 4);
  std::thread([&] {
    const std::string more_than_a_pipe_holds(1 << 20, 'x');
    writeAll(ends[1], more_than_a_pipe_holds);
    writeAll(::open(fifoBeside(argv[1]).c_str(), O_WRONLY), "waits");
  }).detach();
  std::exit(serveChildReader(argc, argv));
}

// What the child of this program does with a file of this name instead of reading it.
int misbehave(int argc, char** argv) {
  const std::string name = fs::path(argv[1]).stem().string();
  if (name == "waits") waitForInput(argc, argv);
  if (name == "limited") {
    const int code = serveChildReader(argc, argv);
#if !defined(__SANITIZE_ADDRESS__)
    if (!isLimited(RLIMIT_DATA, kMemoryLimit / 3 * 2)) return 11;
#endif
    return isLimited(RLIMIT_CPU, 121) && isLimited(RLIMIT_CORE, 0) ? code : 12;
  }
  if (name == "whole" || name == "longer" || name == "shorter" || name == "older" || name == "neither") {
    std::string answer = answerOf(argc, argv);
    if (name == "longer") answer += "x";
    if (name == "shorter") answer.pop_back();
    if (name == "older") answer.at(1) ^= 1;    // of the version
    if (name == "neither") answer.back() = 2;  // of an error: whether memory was short
    return writeAll(3, answer);
  }
  if (name == "crash") std::abort();
  if (name == "killed") std::raise(SIGKILL);
  if (name == "hang" || name == "spin") alarm(kHangs.count());  // a signal ends it if nobody else does
  if (name == "hang") pause();
  for (volatile bool spins = name == "spin"; spins;) {
  }
  if (name == "junk" && write(3, "Sjunkjunkjunk", 13) != 13) return 1;
  if (name == "flood")
    for (const std::string block(1 << 16, 'S'); write(3, block.data(), block.size()) > 0;) {
    }
  if (name == "fail") return 7;
  return 0;
}

std::string failureOf(const fs::path& file, const ChildLimits& limits = ChildLimits(kMemoryLimit), const std::string& bytes = "bytes") {
  Warnings warnings;
  std::string message;
  try {
    readInChild(file, bytes, "fbx", {.child_program = kSelf}, warnings, limits);
  } catch (const InputError& error) {
    EXPECT_EQ(error.file, file.string());
    message = error.message;
  }
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a process is left";
  return message;
}

std::string textOfSculpt(const Sculpt& sculpt) {
  return textOf(sculpt.parts) + textOf(sculpt.nodes) + textOf(sculpt.materials) + textOf(sculpt.images) + sculpt.frame_note;
}

}  // namespace

// The same sculpt, every member of it, with the same warnings, settings passed on.
TEST(ChildReader, GivesWhatThisProcessWouldRead) {
  const TestFolder folder;
  folder.write("skin.png", kPng);
  for (const fs::path& file : {kFbx, folder.write("a.dae", texturedDae())})
    for (const ReadSettings& settings : {ReadSettings{}, ReadSettings{1e-7 / 3, UpAxis::kZ, {}}}) {
      ReadSettings in_child = settings;
      in_child.child_program = kSelf;
      Warnings here, there;
      const Sculpt expected = readMesh(file, settings, here), sculpt = readMesh(file, in_child, there);
      EXPECT_FALSE(sculpt.parts.empty());
      EXPECT_EQ(textOfSculpt(sculpt), textOfSculpt(expected));
      EXPECT_EQ(textOf(there.entries()), textOf(here.entries()));
    }
}

// The moment of an animation is passed on too.
TEST(ChildReader, KnowsTheAnimation) {
  ReadSettings settings{.child_program = kSelf};
  settings.moment = {"a name", 0.5};
  Warnings warnings;
  expectError<Error>([&] { readMesh(kFbx, settings, warnings); }, "it has no animation");
}

// An answer is taken if it comes from the same version, and is neither cut off nor longer than its contents.
TEST(ChildReader, AnAnswerIsWhole) {
  const std::string sculpt = readFileBytes(kFbx);
  const auto failure = [&](const char* name, const std::string& bytes) { return failureOf(name, ChildLimits(kMemoryLimit), bytes); };
  EXPECT_EQ(failure("whole.fbx", sculpt), "");
  for (const char* name : {"longer.fbx", "shorter.fbx", "older.fbx"})
    EXPECT_NE(failure(name, sculpt).find("without a result that is whole"), std::string::npos) << name;
  expectError<Error>([&] { failure("whole.fbx", "no sculpt"); }, "FBX-Parser");
  EXPECT_NE(failure("neither.fbx", "no sculpt").find("without a result that is whole"), std::string::npos);
}

TEST(ChildReader, HasTheLimits) { EXPECT_EQ(failureOf("limited.fbx", ChildLimits(kMemoryLimit), readFileBytes(kFbx)), ""); }

// Nobody kills the child of a parent that was killed.
TEST(ChildReader, EndsWithItsParent) {
  const TestFolder folder;
  const fs::path file = folder.path / "waits.fbx", fifo = fifoBeside(file);
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  ::alarm(unsigned(kHangs.count()));  // a signal ends the test if the child does not come or does not end
  const pid_t parent = startProcess(kSelf, {kSelf.string(), kParent, file.string()}, {});
  const Descriptor from_child(::open(fifo.c_str(), O_RDONLY));
  std::array<char, 5> waits{};
  EXPECT_EQ(::read(from_child.number, waits.data(), waits.size()), ssize_t(waits.size()));
  ::kill(parent, SIGKILL);
  waitForProcess(parent);
  std::string rest;
  EXPECT_EQ(readToEnd(from_child.number, rest), 0) << "the FIFO is open as long as the child lives";
  ::alarm(0);
}

TEST(ChildReader, PassesErrorsOn) {
  const fs::path damaged = fs::path(testing::TempDir()) / "damaged.fbx";
  std::ofstream(damaged) << "Kaydara FBX Binary  \x00\x1a";
  Warnings warnings;
  std::string here;
  try {
    readMesh(damaged, {}, warnings);
  } catch (const InputError& error) {
    here = error.what();
  }
  ReadSettings in_child;
  in_child.child_program = kSelf;
  try {
    readMesh(damaged, in_child, warnings);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code, ExitCode::kInput);
    EXPECT_EQ(error.what(), here);
  }
  fs::remove(damaged);
}

// The bytes are those that this process has read, whatever the file has become since.
TEST(ChildReader, ReadsWhatItIsGiven) {
  const TestFolder folder;
  const fs::path file = folder.write("a.fbx", "saved meanwhile");
  Warnings warnings;
  const Sculpt sculpt = readMesh(file, readFileBytes(kFbx), {.child_program = kSelf}, warnings);
  EXPECT_EQ(sculpt.parts.at(0).positions, readMesh(kFbx, {}, warnings).parts.at(0).positions);
}

// A texture is read by the child. If this process has read other bytes, or none, the sculpt is refused.
TEST(ChildReader, ATextureThatChangesMeanwhileIsRefused) {
  const TestFolder folder;
  const fs::path file = folder.write("a.dae", texturedDae()), skin = folder.write("skin.png", kPng);
  const auto read = [&](const FileReader& read_file) {
    Warnings warnings;
    return readMesh(file, texturedDae(), {.child_program = kSelf, .read_file = read_file}, warnings).images.size();
  };
  EXPECT_EQ(read(readFileBytes), 1U);
  const std::string changed = skin.string() + ": the file was changed while it was read: run again";
  expectError<Error>([&] { read([](const fs::path&) { return kPng + "x"; }); }, changed);
  expectError<Error>([&] { read([](const fs::path& gone) -> std::string { throw IoError(gone.string(), "gone"); }); }, changed);
  fs::remove(skin);
  EXPECT_EQ(read(readFileBytes), 0U) << "it is missing for both";
  expectError<Error>([&] { read([](const fs::path&) { return kPng; }); }, changed);
}

// Whatever the library does to its process, the caller gets an error that names the file.
TEST(ChildReader, ACrashIsAnError) {
  EXPECT_NE(failureOf("crash.fbx").find("crashed (Aborted); the file may be damaged"), std::string::npos);
  EXPECT_NE(failureOf("fail.fbx").find("ended with exit code 7 and without a result"), std::string::npos);
  EXPECT_NE(failureOf("junk.fbx").find("export it again"), std::string::npos);
}

// What the system or someone else ended was not the file's fault.
TEST(ChildReader, AKillIsNoCrash) {
  const std::string failure = failureOf("killed.fbx");
  EXPECT_EQ(failure.find("its reader process was killed (Killed); "), 0U) << failure;
  EXPECT_EQ(failure.find("damaged"), std::string::npos) << failure;
}

TEST(ChildReader, AHangIsAnError) {
  ChildLimits hasty(kMemoryLimit);
  hasty.seconds = 0.5;
  for (const char* name : {"hang.fbx", "spin.fbx"}) EXPECT_NE(failureOf(name, hasty).find("stopped after"), std::string::npos) << name;
}

TEST(ChildReader, AFloodIsAnError) {
  const std::string failure = failureOf("flood.fbx", ChildLimits(3 << 20));
  EXPECT_NE(failure.find("passed on so far, would take about 1 MiB of memory, over the limit of 1 MiB (--memory)"), std::string::npos)
      << failure;
}

TEST(ChildReader, NoProgramIsAnError) {
  Warnings warnings;
  EXPECT_THROW(readInChild(kFbx, "bytes", "fbx", {.child_program = "/no/such/program"}, warnings, ChildLimits(kMemoryLimit)), IoError);
}

int main(int argc, char** argv) {
  if (argc > 2 && std::string(argv[1]) == kChildReaderCommand) {
    if (!fs::exists(argv[2])) return misbehave(argc - 1, argv + 1);
    return serveChildReader(argc - 1, argv + 1);
  }
  if (argc > 2 && std::string(argv[1]) == kParent) return failureOf(argv[2]).empty() ? 0 : 1;
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
