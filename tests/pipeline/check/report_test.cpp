// A report by hand, as the lines and the keys of docs/check.md.
#include "pipeline/check/report.h"

#include <nlohmann/json.hpp>

#include "tests/pipeline/pipeline_helpers.h"

namespace cloudbake {
namespace {

CheckReport emptyReport() {
  CheckReport report;
  report.run.input = "a.glb";
  report.run.vertices = 12;
  report.run.triangles = 20;
  report.run.info.shape = {3, -0.5F};
  report.run.info.extinction = 2.5F;
  report.run.seconds = {{"read", 0.25}, {"truth", 0.5}};
  report.file.first_set = 2;
  return report;
}

CheckFigures figures(bool is_fit) {
  CheckFigures f;
  f.bake.truth = "chords";
  f.bake.vertices = 7;
  f.bake.is_fit = is_fit;
  f.bake.lobe = {1.5, 1.25, 3, 4, 7, 2, 0.125, -0.25};
  f.bake.transmittance = {0.0625, -0.03125};
  f.mean_rms = 0.5;
  f.best_fit_rms = 0.375;
  f.lights = 512;
  return f;
}

CheckReport measured(bool is_fit) {
  CheckReport report = emptyReport();
  if (is_fit) report.run.info.lobe = "fit";
  report.figures = figures(is_fit);
  report.bounds = {{&figureField("direction_rms_degrees"), 10}, {&figureField("transmittance_rms"), 0.25}};
  return report;
}

CheckReport compared() {
  CheckReport report = emptyReport();
  ComparisonFigures& c = report.comparison.emplace();
  c.before = "b.glb";
  c.matched = 10, c.added = 2, c.lost = 3;
  c.difference = figures(false).bake;
  c.density_max = 0.0625;
  c.sets = "TEXCOORD_2", c.sets_before = "TEXCOORD_0";
  c.materials = "rock", c.materials_before = "snow";
  return report;
}

std::vector<std::string> keysOf(const Json& json) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  return keys;
}

// The line that begins with this label, without the label.
std::string lineOf(const std::string& text, const std::string& label) {
  const std::string padded = "\n" + text;
  const size_t at = padded.find("\n" + label + " ");
  if (at == std::string::npos) return "(none)";
  const size_t from = padded.find_first_not_of(' ', at + 1 + label.size());
  return padded.substr(from, padded.find('\n', from) - from);
}

TEST(CheckReportText, WhatEveryReportSays) {
  const std::string text = checkText(emptyReport());
  EXPECT_EQ(lineOf(text, "check"), "a.glb");
  EXPECT_EQ(lineOf(text, "mesh"), "12 vertices, 20 triangles");
  EXPECT_EQ(lineOf(text, "lobe"), "mean, k 3, b -0.5, extinction 2.5, in TEXCOORD_2 and TEXCOORD_3");
  EXPECT_EQ(lineOf(text, "total"), "0.750 s");
  EXPECT_EQ(lineOf(text, "verdict"), "sound");
  EXPECT_EQ(text.back(), '\n');
  for (const char* label : {"volume", "truth", "transmittance", "against", "fault", "note"})
    EXPECT_EQ(lineOf(text, label), "(none)") << label;
}

TEST(CheckReportText, WithoutSetsThereIsNoLobe) {
  CheckReport report = emptyReport();
  report.file.first_set = -1;
  EXPECT_EQ(lineOf(checkText(report), "lobe"), "(none)");
  report.file.first_set = 0;
  EXPECT_TRUE(contains(lineOf(checkText(report), "lobe"), "in TEXCOORD_0 and TEXCOORD_1"));
}

TEST(CheckReportText, FaultsNotesVolumeAndVerdict) {
  CheckReport report = emptyReport();
  report.run.volume_note = "closed by a wrap";
  report.file.faults = {{"moved", "elsewhere", "read there"}};
  report.file.harmless = {{"half-float", "rounded", "none"}};
  report.verdict = AssetFault{"stale", "other mesh", "bake"};
  const std::string text = checkText(report);
  EXPECT_EQ(lineOf(text, "volume"), "closed by a wrap");
  EXPECT_EQ(lineOf(text, "fault"), "moved: elsewhere");
  EXPECT_EQ(lineOf(text, "note"), "half-float: rounded");
  EXPECT_EQ(lineOf(text, "verdict"), "stale");
}

TEST(CheckReportText, FiguresOfMeanLobes) {
  const std::string text = checkText(measured(false));
  EXPECT_EQ(lineOf(text, "truth"), "chords, 7 vertices, 4096 directions");
  EXPECT_TRUE(contains(lineOf(text, "direction"), "1.500°")) << text;
  EXPECT_TRUE(contains(lineOf(text, "density"), "-25.000 %")) << text;
  EXPECT_EQ(lineOf(text, "transmittance"), "rms 0.0625, bias -0.0312 of the lobe (512 lights)");
  EXPECT_EQ(lineOf(text, "fitted lobe"), "(none)");
}

TEST(CheckReportText, FiguresOfFittedLobes) {
  const std::string text = checkText(measured(true));
  EXPECT_EQ(lineOf(text, "direction"), "(none)") << "it means nothing";
  EXPECT_EQ(lineOf(text, "fitted lobe"), "rms of T 0.0625, of the mean lobe 0.5000, of a fit to exact chords 0.3750");
  CheckReport report = measured(true);
  report.run.info.volume.emplace();
  const std::string of_volume = checkText(report);
  EXPECT_EQ(lineOf(of_volume, "transmittance"), "(none)");
  EXPECT_EQ(lineOf(of_volume, "radiance"), "rms 0.0625, bias -0.0312 of the lobe (512 lights)");
  EXPECT_EQ(lineOf(of_volume, "fitted lobe"), "rms of the volume's light 0.0625, of the mean lobe 0.5000, of a fit to that light 0.3750");
}

TEST(CheckReportText, AComparison) {
  const std::string text = checkText(compared());
  EXPECT_EQ(lineOf(text, "against"), "b.glb: 10 vertices matched, 2 only in the asset, 3 only before");
  EXPECT_TRUE(contains(text, "largest difference of d 6.250 %")) << text;
  EXPECT_EQ(lineOf(text, "transmittance"), "rms 0.06250, bias -0.03125 between the two");
  EXPECT_EQ(lineOf(text, "UV sets"), "TEXCOORD_2; before: TEXCOORD_0");
  EXPECT_EQ(lineOf(text, "materials"), "rock; before: snow");
  EXPECT_EQ(lineOf(text, "constants"), "the same");
  EXPECT_EQ(lineOf(text, "harmonics"), "(none)");
  CheckReport report = compared();
  report.comparison->constants = "bias 1 instead of 2";
  report.comparison->harmonics_rms = 0.25;
  EXPECT_EQ(lineOf(checkText(report), "constants"), "bias 1 instead of 2");
  EXPECT_EQ(lineOf(checkText(report), "harmonics"), "rms of T 0.25000 between the two");
}

TEST(CheckReportText, TheSealTheNewBakeAndTheLattice) {
  CheckReport report = measured(false);
  EXPECT_EQ(lineOf(checkText(report), "since the bake"), "(none)");
  EXPECT_EQ(lineOf(checkText(report), "lattice"), "(none)");
  report.figures->agreement = {2000, 0.0125, 0.25, 0.03, 0.055};
  report.seal = SealDifference{.constants = true, .shape = 0.25, .lobes = 0.125};
  report.lattice_rms = 0.0625;
  std::string text = checkText(report);
  EXPECT_EQ(lineOf(text, "since the bake"), "mesh the same, constants changed, shape 25 %, lobes 12 % rms");
  EXPECT_EQ(lineOf(text, "new bake"), "T differs by 0.0125 rms at 2000 vertices (at most 0.0550)");
  EXPECT_EQ(lineOf(text, "lattice"), "T differs by 0.0625 rms from a new one");
  EXPECT_EQ(lineOf(text, "harmonics"), "(none)");
  report.figures->harmonics = HarmonicError{2, 0.5, 0.125};
  report.seal->mesh = true;
  text = checkText(report);
  EXPECT_EQ(lineOf(text, "harmonics"), "order 2: rms 0.1250, of the lobe 0.5000");
  EXPECT_TRUE(contains(text, "T by the harmonics by 0.2500 rms")) << text;
  EXPECT_EQ(lineOf(text, "since the bake"), "mesh changed, constants changed, shape 25 %, lobes not to be told");
}

TEST(CheckReportJson, TheSealTheNewBakeAndTheLattice) {
  CheckReport report = measured(true);
  EXPECT_FALSE(Json::parse(checkJson(report)).contains("since_the_bake") || Json::parse(checkJson(report)).contains("lattice_rms"));
  report.figures->agreement = {2000, 0.0125, 0.25, 0.03125, 0.0625};
  report.figures->harmonics = HarmonicError{2, 0.5, 0.125};
  report.seal = SealDifference{.constants = true, .shape = 0.25, .lobes = 0.125, .harmonics = 0.5};
  report.lattice_rms = 0.0625;
  const Json json = Json::parse(checkJson(report));
  EXPECT_EQ(json["figures"]["new_bake"],
            (Json{{"vertices", 2000}, {"rms", 0.0125}, {"noise", 0.03125}, {"most", 0.0625}, {"harmonics_rms", 0.25}}));
  EXPECT_EQ(json["figures"]["harmonics"], (Json{{"order", 2}, {"rms", 0.125}}));
  EXPECT_EQ(json["since_the_bake"],
            (Json{{"mesh_changed", false}, {"constants_changed", true}, {"shape", 0.25}, {"lobes", 0.125}, {"harmonics", 0.5}}));
  EXPECT_EQ(json["lattice_rms"], 0.0625);
  report.seal->mesh = true;
  EXPECT_FALSE(Json::parse(checkJson(report))["since_the_bake"].contains("lobes")) << "without the same mesh nothing is known";
}

TEST(CheckReportJson, KeysInAFixedOrder) {
  const std::string text = checkJson(emptyReport());
  EXPECT_EQ(text.back(), '\n');
  const Json json = Json::parse(text);
  EXPECT_EQ(keysOf(json), (std::vector<std::string>{"schema", "input", "sound", "settings", "uv_sets", "vertices", "triangles", "bounds",
                                                    "faults", "harmless", "warnings", "seconds"}));
  EXPECT_EQ(json["schema"], "cloudbake-check-1");
  EXPECT_EQ(json["input"], "a.glb");
  EXPECT_EQ(json["sound"], true);
  EXPECT_EQ(json["settings"]["extinction"], 2.5);
  EXPECT_EQ(json["uv_sets"], (Json{2, 3}));
  EXPECT_EQ(json["vertices"], 12);
  EXPECT_EQ(json["triangles"], 20);
  EXPECT_TRUE(json["bounds"].is_object() && json["bounds"].empty());
  EXPECT_TRUE(json["faults"].is_array() && json["faults"].empty());
  EXPECT_EQ(json["seconds"], (Json{{"read", 0.25}, {"truth", 0.5}}));
}

TEST(CheckReportJson, FaultsAndVerdict) {
  CheckReport report = emptyReport();
  report.file.first_set = -1;
  report.file.faults = {{"stripped", "gone", "keep"}, {"zeros", "all 0", "bake"}};
  report.file.harmless = {{"no-metadata", "gone too", "keep too"}};
  report.verdict = report.file.faults[0];
  report.run.volume_note = "filled";
  report.run.warnings.add(WarningKind::kOpenEdges, "edge 3", 4);
  const Json json = Json::parse(checkJson(report));
  EXPECT_EQ(json["sound"], false);
  EXPECT_EQ(json["verdict"], (Json{{"cause", "stripped"}, {"what", "gone"}, {"cure", "keep"}}));
  EXPECT_TRUE(json["uv_sets"].is_null());
  EXPECT_EQ(json["faults"].size(), 2U);
  EXPECT_EQ(json["faults"][1]["cause"], "zeros");
  EXPECT_EQ(json["harmless"], (Json::array({Json{{"cause", "no-metadata"}, {"what", "gone too"}, {"cure", "keep too"}}})));
  EXPECT_EQ(json["volume"], "filled");
  EXPECT_EQ(json["warnings"][0]["kind"], "open-edges");
  EXPECT_EQ(json["warnings"][0]["count"], 4);
}

TEST(CheckReportJson, Figures) {
  const Json mean = Json::parse(checkJson(measured(false)));
  EXPECT_EQ(mean["figures"]["truth"], "chords");
  EXPECT_EQ(mean["figures"]["vertices"], 7);
  EXPECT_EQ(mean["figures"]["lobe"], "mean");
  EXPECT_EQ(mean["figures"]["left_out"], 2);
  EXPECT_EQ(mean["figures"]["direction_degrees"], (Json{{"rms", 1.5}, {"median", 1.25}, {"p95", 3.0}, {"max", 4.0}}));
  EXPECT_EQ(mean["figures"]["density"], (Json{{"rms", 0.125}, {"bias", -0.25}}));
  EXPECT_EQ(mean["figures"]["transmittance"], (Json{{"rms", 0.0625}, {"bias", -0.03125}, {"mean_lobe_rms", 0.5}}));
  EXPECT_EQ(mean["bounds"], (Json{{"direction_rms_degrees", 10.0}, {"transmittance_rms", 0.25}}));
  const Json fit = Json::parse(checkJson(measured(true)));
  EXPECT_EQ(fit["figures"]["lobe"], "fit");
  EXPECT_FALSE(fit["figures"].contains("direction_degrees") || fit["figures"].contains("left_out"));
  EXPECT_EQ(fit["figures"]["transmittance"], (Json{{"rms", 0.0625}, {"bias", -0.03125}, {"mean_lobe_rms", 0.5}, {"best_fit_rms", 0.375}}));
}

TEST(CheckReportJson, Comparison) {
  const Json json = Json::parse(checkJson(compared()))["comparison"];
  EXPECT_EQ(json["before"], "b.glb");
  EXPECT_EQ(json["matched"], 10);
  EXPECT_EQ(json["only_in_asset"], 2);
  EXPECT_EQ(json["only_before"], 3);
  EXPECT_EQ(json["density"], (Json{{"rms", 0.125}, {"bias", -0.25}, {"max", 0.0625}}));
  EXPECT_EQ(json["uv_sets"], (Json{{"asset", "TEXCOORD_2"}, {"before", "TEXCOORD_0"}}));
  EXPECT_EQ(json["materials"], (Json{{"asset", "rock"}, {"before", "snow"}}));
  EXPECT_EQ(json["transmittance"], (Json{{"rms", 0.0625}, {"bias", -0.03125}}));
  EXPECT_EQ(json["constants"], "");
  EXPECT_FALSE(json.contains("harmonics_rms"));
  CheckReport report = compared();
  report.comparison->harmonics_rms = INFINITY;
  EXPECT_EQ(Json::parse(checkJson(report))["comparison"]["harmonics_rms"], "only one has them");
}

// The first hypothesis undoes nothing and never explains anything.
TEST(CheckReportJson, Hypotheses) {
  CheckReport report = emptyReport();
  report.diagnosis.emplace();
  report.diagnosis->tried = {
      {"as-is", "nothing", "", 0.5, 0.25}, {"units", "d is 3", "scale", 0.125, 0.75}, {"axes", "turned", "turn", 1, 0}};
  for (const size_t best : {0, 1, 2}) {
    report.diagnosis->best = best;
    const Json json = Json::parse(checkJson(report))["hypotheses"];
    ASSERT_EQ(json.size(), 3U);
    for (size_t i = 0; i < 3; ++i) EXPECT_EQ(json[i]["explains"], i > 0 && i == best) << i << " of " << best;
    EXPECT_EQ(json[1], (Json{{"cause", "units"}, {"what", "d is 3"}, {"error", 0.125}, {"right", 0.75}, {"explains", best == 1}}));
  }
}

// File names may hold any bytes.
TEST(CheckReportJson, BytesThatAreNoText) {
  CheckReport report = emptyReport();
  report.run.input = "a\xff.glb";
  EXPECT_EQ(Json::parse(checkJson(report))["input"], "a\xEF\xBF\xBD.glb");
}

}  // namespace
}  // namespace cloudbake
