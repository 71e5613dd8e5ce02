// Grown clouds that are kept: found as they were, not found when damaged, and the oldest removed.
#include "pipeline/picture/cloud_cache.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>

#include "io/file/write_file.h"
#include "pipeline/picture/picture.h"
#include "tests/io/io_helpers.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;

size_t filesIn(const fs::path& folder) {
  size_t count = 0;
  if (fs::exists(folder))
    for (const auto& entry : fs::recursive_directory_iterator(folder)) count += entry.is_regular_file();
  return count;
}

TEST(CloudCache, FindsWhatWasAddedUnlessItIsDamaged) {
  const TestFolder folder;
  const CloudCache cache(folder.path / "new" / "clouds");
  EXPECT_FALSE(cache.find("a"));
  cache.add("a", "bytes of a");
  cache.add("b", "");
  EXPECT_EQ(cache.find("a"), "bytes of a");
  EXPECT_EQ(cache.find("b"), "");
  EXPECT_FALSE(cache.find("c"));

  const fs::path file = folder.path / "new" / "clouds" / "a.cloud";
  std::string bytes = readFileBytes(file);
  for (const std::string& damaged : {bytes.substr(0, 12), bytes.substr(1), "x" + bytes.substr(1), std::string()}) {
    folder.write("new/clouds/a.cloud", damaged);
    EXPECT_FALSE(cache.find("a")) << damaged;
  }
  cache.add("a", "bytes of a");
  EXPECT_EQ(cache.find("a"), "bytes of a");
}

TEST(CloudCache, KeepsWhatWasUsedLast) {
  const TestFolder folder;
  const std::string bytes(1000, 'x');
  const CloudCache cache(folder.path, 3200);  // three of them with their hashes
  for (const char* key : {"a", "b", "c"}) {
    cache.add(key, bytes);
    // Files that are written one after the other can have the same time.
    fs::last_write_time(folder.path / (std::string(key) + ".cloud"),
                        fs::file_time_type::clock::now() - std::chrono::hours(*key == 'a'   ? 3
                                                                              : *key == 'b' ? 2
                                                                                            : 1));
  }
  folder.write("other.txt", bytes + bytes + bytes);
  EXPECT_TRUE(cache.find("a"));
  cache.add("d", bytes);
  EXPECT_TRUE(cache.find("a"));
  EXPECT_FALSE(cache.find("b"));
  EXPECT_TRUE(cache.find("c"));
  EXPECT_TRUE(cache.find("d"));
  EXPECT_TRUE(fs::exists(folder.path / "other.txt"));
  cache.add("e", std::string(4000, 'x'));
  EXPECT_FALSE(cache.find("e"));
  EXPECT_TRUE(cache.find("d"));
}

TEST(CloudCache, DoesWithoutAFolder) {
  const CloudCache none{std::nullopt};
  none.add("a", "bytes");
  EXPECT_FALSE(none.find("a"));
  const TestFolder folder;
  const CloudCache blocked(folder.write("file", "") / "below");
  blocked.add("a", "bytes");
  EXPECT_FALSE(blocked.find("a"));
}

// As long as it lives, an environment variable has this value.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* had = std::getenv(name)) before_ = had;
    ::setenv(name, value, 1);
  }
  ~Variable() { before_ ? ::setenv(name_, before_->c_str(), 1) : ::unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

TEST(CloudCache, LiesWhereTheUserKeepsCaches) {
  const Variable home("HOME", "/home/a"), caches("XDG_CACHE_HOME", "/caches");
  EXPECT_EQ(cloudCacheFolder(), "/caches/cloudbake/clouds");
  const Variable relative("XDG_CACHE_HOME", "caches");
  EXPECT_EQ(cloudCacheFolder(), "/home/a/.cache/cloudbake/clouds");
  const Variable nowhere("HOME", "");
  EXPECT_FALSE(cloudCacheFolder());
}

// The clouds of a scene, grown several at a time.
class GrownScene : public testing::Test {
 protected:
  Scenery read(const std::string& clouds, BakeReport& report) const {
    const fs::path scene = folder_.write("s.toml", clouds);
    const std::vector<Given> given = options({"scene=" + scene.string()}, kPreview);
    return readScenery(resolve(sourceOf(SourceKind::kSculpt, ""), given), given, report);
  }
  fs::path kept() const { return folder_.path / "cloudbake" / "clouds"; }

  const TestFolder folder_;
  const Variable caches_{"XDG_CACHE_HOME", folder_.path.c_str()};
};

TEST_F(GrownScene, HasTheSameCloudsFromTheCache) {
  constexpr const char* kTwo =
      "[[cloud]]\npreset = 'humilis'\nvertices = 600\nlobe = 'mean'\n[[cloud]]\npreset = 'humilis'\nseed = 2\nvertices = 600\nlobe = "
      "'mean'\n"
      "[[cloud]]\npreset = 'humilis'\nvertices = 600\nlobe = 'mean'\nposition = [9, 0, 0]\n";
  BakeReport first, second;
  const Scenery grown = read(kTwo, first), found = read(kTwo, second);
  EXPECT_EQ(filesIn(kept()), 2U);
  ASSERT_EQ(grown.meshes.size(), 2U);
  ASSERT_EQ(grown.instances.size(), 3U);
  EXPECT_EQ(grown.instances[0].mesh, grown.instances[2].mesh);
  for (size_t i = 0; i < 3; ++i) {
    const BakedMesh &one = *grown.instances[i].mesh, &other = *found.instances[i].mesh;
    EXPECT_EQ(one.surface.positions, other.surface.positions);
    EXPECT_EQ(one.surface.triangles, other.surface.triangles);
    ASSERT_EQ(one.lobes.size(), other.lobes.size());
    for (size_t v = 0; v < one.lobes.size(); ++v) EXPECT_EQ(one.lobes[v].thickness, other.lobes[v].thickness);
    EXPECT_EQ(one.info.input_hash, other.info.input_hash);
  }
  EXPECT_NE(grown.instances[0].mesh->surface.positions, grown.instances[1].mesh->surface.positions);
}

// A recipe that changes is grown anew, and what is told about a cloud is told each time.
TEST_F(GrownScene, KeepsOnlyCloudsWithoutWarnings) {
  const auto write = [&](const std::string& premise) { folder_.write("r.toml", "premise = '" + premise + "'\ngenerations = 0\n"); };
  constexpr const char* kScene = "[[cloud]]\npreset = 'r.toml'\nvertices = 600\nlobe = 'mean'\n";
  write("FF");
  BakeReport whole;
  read(kScene, whole);
  EXPECT_TRUE(whole.warnings.empty());
  EXPECT_EQ(filesIn(kept()), 1U);
  write("FFF]");
  for (int run = 0; run < 2; ++run) {
    BakeReport odd;
    read(kScene, odd);
    EXPECT_EQ(odd.warnings.entries().count(WarningKind::kGrammar), 1U);
    EXPECT_EQ(filesIn(kept()), 1U);
  }
}

// The error is that of the first cloud in the file, whichever fails first.
TEST_F(GrownScene, NamesTheFirstFault) {
  for (const char* name : {"a.toml", "b.toml"}) folder_.write(name, "premise = 'F('\n");
  BakeReport report;
  for (int run = 0; run < 5; ++run)
    expectError<InputError>([&] { read("[[cloud]]\npreset = 'a.toml'\n[[cloud]]\npreset = 'b.toml'\n", report); }, "a.toml");
}

}  // namespace
}  // namespace cloudbake
