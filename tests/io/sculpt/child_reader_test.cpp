#include "io/sculpt/child_reader.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "core/error.h"
#include "tests/folders.h"

using namespace cloudbake;

namespace fs = std::filesystem;

namespace {

const fs::path kFbx = sourceFolder() / "tests/data/two_quads.fbx";
const fs::path kSelf = "/proc/self/exe";

// What the child of this program does with a file of this name instead of reading it.
int misbehave(const fs::path& file) {
  const std::string name = file.stem().string();
  if (name == "crash") std::abort();
  if (name == "hang") std::this_thread::sleep_for(std::chrono::minutes(10));
  if (name == "spin")
    while (getppid() > 0) {
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
    readInChild(kSelf, file, "fbx", {}, warnings, limits);
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

// Whatever the library does to its process, the caller gets an error that names the file.
TEST(ChildReader, ACrashIsAnError) {
  EXPECT_NE(failureOf("crash.fbx").find("crashed (Aborted)"), std::string::npos);
  EXPECT_NE(failureOf("fail.fbx").find("without a result"), std::string::npos);
  EXPECT_NE(failureOf("junk.fbx").find("export it again"), std::string::npos);
}

TEST(ChildReader, AHangIsAnError) {
  ChildLimits hasty(kMemoryLimit);
  hasty.seconds = 0.5;
  for (const char* name : {"hang.fbx", "spin.fbx"}) {
    const auto start = std::chrono::steady_clock::now();
    EXPECT_NE(failureOf(name, hasty).find("stopped after"), std::string::npos);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
  }
}

TEST(ChildReader, AFloodIsAnError) {
  const std::string failure = failureOf("flood.fbx", ChildLimits(3 << 20));
  EXPECT_NE(failure.find("passed on so far, would take about 1 MiB of memory, over the limit of 1 MiB (--memory)"), std::string::npos)
      << failure;
}

TEST(ChildReader, NoProgramIsAnError) {
  Warnings warnings;
  EXPECT_THROW(readInChild("/no/such/program", kFbx, "fbx", {}, warnings, ChildLimits(kMemoryLimit)), IoError);
}

int main(int argc, char** argv) {
  if (argc > 2 && std::string(argv[1]) == kChildReaderCommand) {
    if (!fs::exists(argv[2])) return misbehave(argv[2]);
    return serveChildReader(argc - 1, argv + 1);
  }
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
