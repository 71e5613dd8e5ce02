#include "io/sculpt/child_reader.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "core/error.h"
#include "io/file/write_file.h"
#include "tests/folders.h"
#include "tests/io/io_helpers.h"
#include "tests/io/sculpt/sculpt_helpers.h"
#include "tests/wait.h"

using namespace cloudbake;

namespace fs = std::filesystem;

namespace {

const fs::path kFbx = sourceFolder() / "tests/data/two_quads.fbx";
const fs::path kSelf = "/proc/self/exe";

// What the child of this program does with a file of this name instead of reading it.
int misbehave(const fs::path& file) {
  const std::string name = file.stem().string();
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

std::string failureOf(const fs::path& file, const ChildLimits& limits = ChildLimits(kMemoryLimit)) {
  Warnings warnings;
  try {
    readInChild(file, "bytes", "fbx", {.child_program = kSelf}, warnings, limits);
  } catch (const InputError& error) {
    EXPECT_EQ(error.file, file.string());
    return error.message;
  }
  return "";
}

}  // namespace

// The same sculpt, bit by bit, with the same warnings, settings passed on.
TEST(ChildReader, GivesWhatThisProcessWouldRead) {
  for (const ReadSettings& settings : {ReadSettings{}, ReadSettings{1e-7 / 3, UpAxis::kZ, {}}}) {
    ReadSettings in_child = settings;
    in_child.child_program = kSelf;
    Warnings here, there;
    const Sculpt expected = readMesh(kFbx, settings, here), sculpt = readMesh(kFbx, in_child, there);
    ASSERT_EQ(sculpt.parts.size(), expected.parts.size());
    for (size_t p = 0; p < sculpt.parts.size(); ++p) {
      const SculptPart &a = sculpt.parts[p], &b = expected.parts[p];
      EXPECT_EQ(a.name, b.name);
      EXPECT_EQ(a.positions, b.positions);
      EXPECT_EQ(a.normals, b.normals);
      EXPECT_EQ(a.triangles, b.triangles);
      ASSERT_EQ(a.uvs.size(), b.uvs.size());
      for (size_t i = 0; i < a.uvs.size(); ++i) EXPECT_TRUE(a.uvs[i].x == b.uvs[i].x && a.uvs[i].y == b.uvs[i].y);
      EXPECT_EQ(a.to_scene.linear, b.to_scene.linear);
    }
    ASSERT_EQ(there.entries().size(), here.entries().size());
    for (const auto& [kind, entry] : here.entries()) {
      EXPECT_EQ(there.entries().at(kind).count, entry.count);
      EXPECT_EQ(there.entries().at(kind).first, entry.first);
    }
  }
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
    if (!fs::exists(argv[2])) return misbehave(argv[2]);
    return serveChildReader(argc - 1, argv + 1);
  }
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
