#include "io/file/manifest.h"

#include "tests/io/io_helpers.h"

namespace cloudbake {
namespace {

const std::string kWhole = R"(name = '{stem}.glb'
[defaults]
rays = 64
bias = "-0.5%"
separate = true
[scene]
camera_distance = 200
field_of_view = 50
image_height = 1080
sun_elevation = [5, 60]
[[cloud]]
preset = 'humilis'
seeds = '3-5'
name = 'low/{seed}.glb'
vertices = 8000
[[cloud]]
sculpt = ['a/**/*.fbx', 'b.obj']
repair = ['orient', 'fill']
[[cloud]]
rules = 'r.txt'
seeds = [7, 1]
)";

TEST(ManifestTest, ReadsEveryPart) {
  const Manifest manifest = parseManifest(kWhole, "clouds.toml");
  EXPECT_EQ(manifest.name->value, "{stem}.glb");
  ASSERT_EQ(manifest.defaults.size(), 3U);
  EXPECT_EQ(manifest.defaults[0].key, "rays");
  EXPECT_EQ(manifest.defaults[0].value, "64");
  EXPECT_EQ(manifest.defaults[1].value, "-0.5%");
  EXPECT_EQ(manifest.defaults[1].line, 4);
  EXPECT_EQ(manifest.defaults[2].value, "true");
  ASSERT_TRUE(manifest.scene && manifest.scene->sun_arc);
  EXPECT_EQ(manifest.scene->image_height, 1080);
  EXPECT_EQ(manifest.scene->sun_arc->elevation_high_degrees, 60);
  // 2 · 200 · tan 25° / 1080
  EXPECT_NEAR(manifest.scene->pixel(), 0.172707, 1e-6);

  ASSERT_EQ(manifest.clouds.size(), 3U);
  const auto& [humilis, sculpts, rules] = std::tie(manifest.clouds[0], manifest.clouds[1], manifest.clouds[2]);
  EXPECT_EQ(humilis.kind, CloudSourceKind::kPreset);
  EXPECT_EQ(humilis.seeds, (std::vector<uint64_t>{3, 4, 5}));
  EXPECT_EQ(humilis.name->value, "low/{seed}.glb");
  ASSERT_EQ(humilis.options.size(), 1U);
  EXPECT_EQ(humilis.options[0].key + "=" + humilis.options[0].value, "vertices=8000");
  EXPECT_EQ(humilis.options[0].line, 15);
  EXPECT_EQ(sculpts.kind, CloudSourceKind::kSculpt);
  ASSERT_EQ(sculpts.sources.size(), 2U);
  EXPECT_EQ(sculpts.sources[1].value, "b.obj");
  EXPECT_EQ(sculpts.sources[1].line, 17);
  EXPECT_EQ(sculpts.options[0].value, "orient,fill");
  EXPECT_EQ(rules.kind, CloudSourceKind::kRules);
  EXPECT_EQ(rules.seeds, (std::vector<uint64_t>{7, 1}));
}

struct Refusal {
  const char* text;
  const char* message;
};

TEST(ManifestTest, FaultsNameTheirPlace) {
  const Refusal refusals[] = {
      {"", "a.toml: no cloud"},
      {"x = 1\n", "a.toml:1:1: unknown key 'x'"},
      {"[[cloud]]\npreset = 'a'\n[extra]\n", "a.toml:3:"},
      {"[[cloud]]\npreset = 'a\n", "a.toml:2:"},
      {"[[cloud]]\nrays = 3\n", "a.toml:1:1: a cloud without a source"},
      {"[[cloud]]\npreset = 'a'\nsculpt = 'b'\n", "a.toml:3:1: a cloud has one source"},
      {"[[cloud]]\npreset = ['a', 'b']\n", "a.toml:2:10: 'preset' is no text"},
      {"[[cloud]]\nsculpt = []\n", "a.toml:2:10: 'sculpt' is an empty list"},
      {"[[cloud]]\nsculpt = ['a', 3]\n", "'sculpt' is no text"},
      {"[[cloud]]\nsculpt = 'a'\nseeds = [1]\n", "a.toml:3:9: 'seeds' are for clouds that grow"},
      {"[[cloud]]\npreset = 'a'\nseed = 1\nseeds = [1]\n", "a.toml:3:8: 'seed' and 'seeds'"},
      {"[[cloud]]\npreset = 'a'\nseeds = []\n", "a.toml:3:9: 'seeds' are no seeds"},
      {"[[cloud]]\npreset = 'a'\nseeds = [-1]\n", "'seeds' are no seeds"},
      {"[[cloud]]\npreset = 'a'\nseeds = '5-1'\n", "'seeds' are no seeds"},
      {"[[cloud]]\npreset = 'a'\nseeds = '0-99999999999'\n", "'seeds' are no seeds"},
      {"[[cloud]]\npreset = 'a'\nrays = nan\n", "a.toml:3:8: no option takes this"},
      {"[[cloud]]\npreset = 'a'\nrays = {a = 1}\n", "a.toml:3:8: no option takes this"},
      {"[[cloud]]\npreset = 'a'\nrays = [[1]]\n", "no option takes this"},
      {"cloud = 3\n", "a.toml:1:9: 'cloud' must be a list of tables"},
      {"cloud = [1]\n", "'cloud' must be a list of tables"},
      {"defaults = 3\n", "'defaults' must be a table"},
      {"[scene]\nfov = 3\n[[cloud]]\npreset = 'a'\n", "a.toml:2:1: unknown key 'fov' in a scene"},
      {"[scene]\ncamera_distance = 3\n[[cloud]]\npreset = 'a'\n", "a.toml:1:1: 'field_of_view' is missing"},
      {"[scene]\ncamera_distance = -3\nfield_of_view = 3\nimage_height = 3\n", "a.toml:2:19: 'camera_distance' is out of range"},
      {"[scene]\ncamera_distance = 3\nfield_of_view = 3\nimage_height = 3\nsun_azimuth = [9, 1]\n",
       "a.toml:5:15: 'sun_azimuth' is no range"},
  };
  for (const auto& [text, message] : refusals) {
    SCOPED_TRACE(text);
    expectError<InputError>([&, text = text] { parseManifest(text, "a.toml"); }, message);
  }
  expectError<InputError>([] { parseManifest(std::string(17 << 20, ' '), "a.toml"); }, "more than 16 MiB");
  const TestFolder folder;
  expectError<IoError>([&] { readManifest(folder.path / "no.toml"); }, "no.toml");
}

TEST(ManifestTest, RangeOfSeedsEndsAtTheLargest) {
  const Manifest manifest = parseManifest("[[cloud]]\npreset = 'a'\nseeds = '18446744073709551614-18446744073709551615'\n", "a.toml");
  EXPECT_EQ(manifest.clouds[0].seeds, (std::vector<uint64_t>{UINT64_MAX - 1, UINT64_MAX}));
}

}  // namespace
}  // namespace cloudbake
