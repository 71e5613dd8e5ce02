#include "pipeline/batch/manifest.h"

#include "tests/io/io_helpers.h"

namespace cloudbake {
namespace {

const std::string kWhole = R"(name = '{stem}.glb'
[defaults]
rays = 64
bias = "-0.5%"
separate = true
[scene.camera]
distance = 200
fov = 50
[scene.picture]
height = 1080
[scene.sun]
elevation = [5, 60]
azimuth = 90
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

Manifest parse(const std::string& text) { return parseManifest(text, "a.toml"); }

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
  EXPECT_EQ(manifest.scene->view.height, 1080);
  EXPECT_EQ(manifest.scene->sun_arc->elevation_low_degrees, 5);
  EXPECT_EQ(manifest.scene->sun_arc->elevation_high_degrees, 60);
  EXPECT_EQ(manifest.scene->sun_arc->azimuth_low_degrees, 90);
  EXPECT_EQ(manifest.scene->sun_arc->azimuth_high_degrees, 90);
  // 2 · 200 · tan 25° / 1080
  EXPECT_NEAR(pixelSize(*manifest.scene, {{0, 0, 0}, {1, 2, 3}}), 0.172707, 1e-6);

  ASSERT_EQ(manifest.clouds.size(), 3U);
  const auto& [humilis, sculpts, rules] = std::tie(manifest.clouds[0], manifest.clouds[1], manifest.clouds[2]);
  EXPECT_EQ(humilis.kind, SourceKind::kPreset);
  EXPECT_EQ(humilis.seeds, (std::vector<uint64_t>{3, 4, 5}));
  EXPECT_EQ(humilis.name->value, "low/{seed}.glb");
  ASSERT_EQ(humilis.options.size(), 1U);
  EXPECT_EQ(humilis.options[0].key + "=" + humilis.options[0].value, "vertices=8000");
  EXPECT_EQ(humilis.options[0].line, 18);
  EXPECT_EQ(sculpts.kind, SourceKind::kSculpt);
  ASSERT_EQ(sculpts.sources.size(), 2U);
  EXPECT_EQ(sculpts.sources[1].value, "b.obj");
  EXPECT_EQ(sculpts.sources[1].line, 20);
  EXPECT_EQ(sculpts.options[0].value, "orient,fill");
  EXPECT_EQ(rules.kind, SourceKind::kRules);
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
      {"[[cloud]]\nrays = 3\n", "a.toml:1:1: this cloud has no source"},
      {"[[cloud]]\npreset = 'a'\nsculpt = 'b'\n", "a.toml:3:1: a cloud has only one source"},
      {"[[cloud]]\npreset = ['a', 'b']\n", "a.toml:2:10: 'preset' must be a non-empty string"},
      {"[[cloud]]\nsculpt = []\n", "a.toml:2:10: 'sculpt' is an empty list"},
      {"[[cloud]]\nsculpt = ['a', 3]\n", "'sculpt' must be a non-empty string"},
      {"[[cloud]]\nsculpt = 'a'\nseeds = [1]\n", "a.toml:3:9: 'seeds' are for clouds that grow"},
      {"[[cloud]]\npreset = 'a'\nseed = 1\nseeds = [1]\n", "a.toml:3:8: 'seed' and 'seeds'"},
      {"[[cloud]]\npreset = 'a'\nseeds = []\n", "a.toml:3:9: 'seeds' is an empty list"},
      {"[[cloud]]\npreset = 'a'\nseeds = [1, -1]\n", "a.toml:3:13: 'seeds' has a value that is no whole number from 0 on"},
      {"[[cloud]]\npreset = 'a'\nseeds = '5-1'\n", "'seeds' is '5-1', which is no range"},
      {"[[cloud]]\npreset = 'a'\nseeds = '0-99999999999'\n", "'seeds' is '0-99999999999', more than 1000000 seeds"},
      {"[[cloud]]\npreset = 'a'\nseeds = '0-99999999999999999999'\n", "'seeds' is '0-99999999999999999999', which is no range"},
      {"[[cloud]]\npreset = 'a'\nrays = nan\n", "a.toml:3:8: no option takes this"},
      {"[[cloud]]\npreset = 'a'\nrays = {a = 1}\n", "a.toml:3:8: no option takes this"},
      {"[[cloud]]\npreset = 'a'\nrays = [[1]]\n", "no option takes this"},
      {"cloud = 3\n", "a.toml:1:9: 'cloud' must be a list of tables"},
      {"cloud = [1]\n", "'cloud' must be a list of tables"},
      {"defaults = 3\n", "'defaults' must be a table"},
      {"[scene]\nfov = 3\n[[cloud]]\npreset = 'a'\n", "a.toml:2:1: unknown key 'fov' in [scene]"},
      {"[scene.camera]\ndistance = -3\n", "a.toml:2:12: distance must be a number from 1e-30"},
      {"[scene.camera]\nposition = [0, 0, 1]\n", "a.toml:2:12: [camera] has a position but no target"},
      {"[scene.picture]\nheight = 0\n", "a.toml:2:10: height must be a whole number from 1"},
      {"[scene.sun]\nazimuth = [9, 1]\n", "a.toml:2:11: azimuth must be a number from -3600 to 3600, or a range"},
      {"[scene]\ncamera_distance = 3\n", "a.toml:2:1: unknown key 'camera_distance' in [scene]"},
  };
  for (const auto& [text, message] : refusals) {
    SCOPED_TRACE(text);
    expectError<InputError>([&, text = text] { parse(text); }, message);
  }
  expectError<InputError>([] { parse(std::string(17 << 20, ' ')); }, "larger than 16 MiB");
  const TestFolder folder;
  expectError<IoError>([&] { readManifest(folder.path / "no.toml"); }, "no.toml");
}

// The sun of a fit goes all the way where the scene does not say.
TEST(ManifestTest, ASunWithoutAnAzimuthGoesRound) {
  const auto arc = parse("[scene.sun]\nelevation = [5, 60]\n[[cloud]]\npreset = 'a'\n").scene->sun_arc;
  ASSERT_TRUE(arc);
  EXPECT_EQ(arc->elevation_low_degrees, 5);
  EXPECT_EQ(arc->azimuth_low_degrees, 0);
  EXPECT_EQ(arc->azimuth_high_degrees, 360);
  EXPECT_FALSE(parse("[scene.camera]\ndistance = 5\n[[cloud]]\npreset = 'a'\n").scene->sun_arc);
}

// Without a distance the cloud fills the picture; a position and a target have theirs.
TEST(ManifestTest, DistanceOfACamera) {
  const std::string cloud = "[[cloud]]\npreset = 'a'\n";
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  const auto pixel = [&](const std::string& camera) { return pixelSize(*parse("[scene.camera]\n" + camera + "\n" + cloud).scene, box); };
  const double per_unit = 2 * std::tan(35 * kPi / 360) / 640;
  EXPECT_NEAR(pixel("position = [0, 3, 4]\ntarget = [0, 0, 0]"), 5 * per_unit, 1e-9);
  EXPECT_NEAR(pixel("distance = 50"), 50 * per_unit, 1e-7);
  // A cube of side 2 fills no more than the picture's height of 2 · distance · tan(fov / 2).
  EXPECT_GT(pixel("fov = 35") * 640, 2);
  EXPECT_LT(pixel("fov = 35") * 640, 4);
}

TEST(ManifestTest, RangeOfSeedsEndsAtTheLargest) {
  const Manifest manifest = parse("[[cloud]]\npreset = 'a'\nseeds = '18446744073709551614-18446744073709551615'\n");
  EXPECT_EQ(manifest.clouds[0].seeds, (std::vector<uint64_t>{UINT64_MAX - 1, UINT64_MAX}));
}

}  // namespace
}  // namespace cloudbake
