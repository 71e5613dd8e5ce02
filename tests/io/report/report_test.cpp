#include "io/report/report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

using namespace cloudbake;

namespace {

BakeReport sampleBakeReport() {
  BakeReport report;
  report.command = "bake";
  report.input = "in \"quoted\".obj";
  report.output = "out.glb";
  report.info.shape = {3, -0.01F};
  report.info.extinction = 2.5F;
  report.info.sampler = "stratified";
  report.info.quadrature = "crossing";
  report.info.rays = 100;
  report.info.steps = 50;
  report.info.seed = 18446744073709551615ULL;
  report.info.input_hash = "abc";
  report.vertices = 5000000000ULL;
  report.triangles = 4;
  report.undefined_directions = 1;
  report.seconds = {{"read", 0.25}, {"bake", 1.5}};
  report.warnings.add(WarningKind::kOpenEdges, "edge 3", 2);
  return report;
}

}  // namespace

TEST(Report, JsonHasEveryKeyInOrder) {
  const auto json = nlohmann::ordered_json::parse(reportJson(sampleBakeReport()));
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  EXPECT_EQ(keys, (std::vector<std::string>{"schema", "command", "input", "output", "settings", "vertices", "triangles",
                                            "undefined_directions", "seconds", "warnings"}));
  EXPECT_EQ(json["schema"], "cloudbake-report-1");
  EXPECT_EQ(json["input"], "in \"quoted\".obj");
  EXPECT_EQ(json["vertices"], 5000000000ULL);
  EXPECT_EQ(json["settings"]["seed"], 18446744073709551615ULL);
  EXPECT_EQ(json["settings"]["bias"].dump(), "-0.01");
  EXPECT_EQ(json["seconds"].dump(), R"({"read":0.25,"bake":1.5,"total":1.75})");
  EXPECT_EQ(json["warnings"].dump(), R"([{"kind":"open-edges","count":2,"first":"edge 3"}])");
}

TEST(Report, SurvivesAFileNameThatIsNoUtf8) {
  BakeReport report = sampleBakeReport();
  report.input = "bad\xFFname";
  EXPECT_EQ(nlohmann::json::parse(reportJson(report))["input"], "bad\xEF\xBF\xBDname");
}

// JSON has no NaN and no infinity, and a null is no number.
TEST(Report, NumbersThatAreNotFiniteAreLeftOut) {
  EXPECT_EQ(
      nlohmann::json::parse(reportJsonText({{"a", NAN}, {"b", {{"c", INFINITY}, {"d", 1}}}, {"e", {{{"f", -INFINITY}}, 2.5}}})).dump(),
      R"({"b":{"d":1},"e":[{},2.5]})");
  EXPECT_EQ(reportJsonText("text"), "\"text\"\n");
}

TEST(Report, TextIsAligned) {
  EXPECT_EQ(reportText(sampleBakeReport()),
            "bake        in \"quoted\".obj -> out.glb\n"
            "mesh        5000000000 vertices, 4 triangles\n"
            "lobe        mean, k 3, b -0.01, extinction 2.5\n"
            "method      rays, stratified, crossing, 100 rays of 50 steps\n"
            "undefined   1 vertices without a direction\n"
            "read           0.250 s\n"
            "bake           1.500 s\n"
            "total          1.750 s\n");
}

TEST(Report, ErrorAsJson) {
  const auto json = nlohmann::ordered_json::parse(errorJson(InputError("a.obj", 7, "no number; repair it")));
  EXPECT_EQ(json.dump(), R"({"schema":"cloudbake-error-1","code":3,"file":"a.obj","line":7,"column":0,"message":"no number; repair it"})");
}

TEST(Report, TellsTheFitAndTheTarget) {
  BakeReport report = sampleBakeReport();
  report.info.lobe = "fit";
  report.info.method = "sweep";
  report.info.field = "coverage";
  report.info.extinction_low = 1.25F;
  report.info.extinction_high = 5;
  report.info.steps = 0;
  report.fit = {{1.25, 0.3, 0.2}, {5, 0.4, 0.25}};
  report.target = TargetReport{"direction rms, degrees", 0.5, 0.375, "Embree, all hits", 256, 70};
  const auto json = nlohmann::ordered_json::parse(reportJson(report));
  EXPECT_EQ(json["settings"]["extinction_range"].dump(), "[1.25,5.0]");
  EXPECT_EQ(json["settings"]["field"], "coverage");
  EXPECT_EQ(json["fit"].dump(),
            R"([{"extinction":1.25,"mean_rms":0.3,"fitted_rms":0.2},{"extinction":5.0,"mean_rms":0.4,"fitted_rms":0.25}])");
  EXPECT_EQ(json["target"].dump(),
            R"({"quantity":"direction rms, degrees","target":0.5,"measured":0.375,"truth":"Embree, all hits","vertices":256,"voxels":70})");
  const std::string text = reportText(report);
  EXPECT_NE(text.find("fit         extinction 5: rms of T 0.2500, of the mean lobe 0.4000\n"), std::string::npos) << text;
  report.info.volume.emplace();
  EXPECT_NE(reportText(report).find("extinction 5: rms of the volume's light 0.2500"), std::string::npos);
  EXPECT_NE(text.find("target      direction rms, degrees 0.5: measured 0.375 on 256 vertices (Embree, all hits), 70 voxels\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("sweep, coverage, stratified, crossing, 100 directions\n"), std::string::npos) << text;
}

TEST(Report, TellsSmoothingAndTheNewSurface) {
  BakeReport report = sampleBakeReport();
  EXPECT_FALSE(nlohmann::json::parse(reportJson(report))["settings"].contains("smooth"));
  report.info.smooth = 3;
  report.surface_error = SurfaceError{0.000125, 0.025};
  const auto json = nlohmann::ordered_json::parse(reportJson(report));
  EXPECT_EQ(json["settings"]["smooth"], 3);
  EXPECT_EQ(json["surface_error"].dump(), R"({"rms":0.000125,"largest":0.025})");
  const std::string text = reportText(report);
  EXPECT_NE(text.find("lobe        mean, k 3, b -0.01, extinction 2.5, smoothed 3 times\n"), std::string::npos) << text;
  EXPECT_NE(text.find("surface     rms 0.0125 %, largest 2.5 % of the longest side from the sculpt\n"), std::string::npos) << text;
}

TEST(Report, TellsWhatRefiningDid) {
  BakeReport report = sampleBakeReport();
  EXPECT_FALSE(nlohmann::json::parse(reportJson(report)).contains("refine"));
  report.refine = RefineSummary{24, 242, 0.25, 0.0625};
  EXPECT_EQ(nlohmann::ordered_json::parse(reportJson(report))["refine"].dump(),
            R"({"vertices_before":24,"vertices_after":242,"blending_before":0.25,"blending_after":0.0625})");
  EXPECT_NE(reportText(report).find("refine      24 vertices became 242, rms of T that blending adds 0.0625, before 0.2500\n"),
            std::string::npos)
      << reportText(report);
}

// A dry run has no mesh: only how the cloud grew.
TEST(Report, GrowthSaysWhatBecameOfThePoints) {
  BakeReport report;
  report.command = "grow";
  report.input = "mine.toml";
  GrowthSummary growth;
  growth.generations = {{{'A', 1}}, {{'A', 2}, {'F', 30}}};
  growth.expansion = "FA";
  growth.points = 9;
  growth.hidden = 2;
  growth.over_count = 1;
  growth.parts = 2;
  growth.connected = true;
  growth.radii = {1, 1, 1.5F, 3, 5};
  report.growth = growth;
  EXPECT_EQ(reportText(report),
            "grow        mine.toml\n"
            "premise            1 symbols:  A 1\n"
            "generation 1       32 symbols:  A 2  F 30\n"
            "expansion   FA\n"
            "points      9 of the turtle, 0 leaves\n"
            "dropped     0 without a radius, 2 hidden in others, 1 over the count\n"
            "spheres     5 in 2 parts, pulled together\n"
            "radii              1 … 1.5           2  ########################################\n"
            "                 1.5 … 2             1  ####################\n"
            "                   2 … 2.5           0  \n"
            "                 2.5 … 3             0  \n"
            "                   3 … 3.5           1  ####################\n"
            "                 3.5 … 4             0  \n"
            "                   4 … 4.5           0  \n"
            "                 4.5 … 5             1  ####################\n"
            "total          0.000 s\n");
  const auto json = nlohmann::json::parse(reportJson(report))["growth"];
  EXPECT_EQ(json["generations"].dump(), R"([{"A":1},{"A":2,"F":30}])");
  EXPECT_EQ(json["spheres"], 5);
  EXPECT_EQ(json["hidden"], 2);
  EXPECT_EQ(json["radii"].size(), 5U);
}
