#include "io/report/curve.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

using namespace cloudbake;

namespace {

BakeFigures figuresOf(double rms, double median, double p95, double max, double density_rms, double density_bias,
                      double transmittance_rms) {
  BakeFigures figures;
  figures.lobe = {rms, median, p95, max, 0, 0, density_rms, density_bias};
  figures.transmittance.rms = transmittance_rms;
  return figures;
}

std::vector<CurveRow> sampleRows() {
  CurveRow plain{"plain port", "uniform", "end", "level set", 100, 100, 100, 0.2, 4, figuresOf(8, 6, 14, 40, 0.05, -0.03, 0.2), 0, 0,
                 false};
  CurveRow sweep{"sweep", "fibonacci", "", "coverage", 64, 0, 80, 0.004, 0.1, figuresOf(0.5, 0.4, 1, 5, 0.01, 0.001, 0.2), 0, 0, false};
  CurveRow slow = sweep;
  slow.method = "a \"slow\", odd|one", slow.seconds_bake = 0.3,
  slow.figures.lobe.angle_max_degrees = std::numeric_limits<double>::quiet_NaN();
  return {plain, sweep, slow};
}

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> result;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) result.push_back(line);
  return result;
}

const std::vector<std::string> kKeys{"method",
                                     "sampler",
                                     "quadrature",
                                     "field",
                                     "directions",
                                     "steps",
                                     "voxels",
                                     "seconds_field",
                                     "seconds_bake",
                                     "direction_rms_degrees",
                                     "direction_median_degrees",
                                     "direction_p95_degrees",
                                     "direction_max_degrees",
                                     "density_rms",
                                     "density_bias",
                                     "transmittance_rms",
                                     "speedup_bake",
                                     "speedup_with_field",
                                     "pareto"};

}  // namespace

TEST(Curve, RanksAgainstThePlainPort) {
  auto rows = sampleRows();
  rankCurve(rows, rows[0]);
  EXPECT_DOUBLE_EQ(rows[0].speedup_bake, 1);
  EXPECT_DOUBLE_EQ(rows[1].speedup_bake, 4 / 0.1);
  EXPECT_DOUBLE_EQ(rows[1].speedup_with_field, 4.2 / 0.104);
  EXPECT_FALSE(rows[0].pareto);
  EXPECT_TRUE(rows[1].pareto);
  EXPECT_FALSE(rows[2].pareto);
  rows[0].seconds_bake = 0.01, rows[0].seconds_field = 0;  // fast and coarse: on the front as well
  rankCurve(rows, rows[0]);
  EXPECT_TRUE(rows[0].pareto && rows[1].pareto);
}

TEST(Curve, CsvByHand) {
  const auto rows = sampleRows();
  const auto csv = lines(curveCsv(rows));
  ASSERT_EQ(csv.size(), 4U);
  std::string header;
  for (const std::string& key : kKeys) header += (header.empty() ? "" : ",") + key;
  header += ",made_by";
  const std::string maker = "cloudbake " CLOUDBAKE_VERSION;
  EXPECT_EQ(csv[0], header);
  EXPECT_EQ(csv[1], "plain port,uniform,end,level set,100,100,100,0.2,4.0,8.0,6.0,14.0,40.0,0.05,-0.03,0.2,0.0,0.0,false," + maker);
  EXPECT_EQ(csv[2], "sweep,fibonacci,,coverage,64,,80,0.004,0.1,0.5,0.4,1.0,5.0,0.01,0.001,0.2,0.0,0.0,false," + maker);
  EXPECT_EQ(csv[3], "\"a \"\"slow\"\", odd|one\",fibonacci,,coverage,64,,80,0.004,0.3,0.5,0.4,1.0,,0.01,0.001,0.2,0.0,0.0,false," + maker);
  EXPECT_EQ(curveCsv({}), header + "\n");
}

TEST(Curve, JsonHasTheSameKeysInOrder) {
  auto rows = sampleRows();
  rows[1].method = "bad\xFF";
  const auto json = nlohmann::ordered_json::parse(curveJson(rows));
  EXPECT_EQ(json["schema"], "cloudbake-curve-1");
  ASSERT_EQ(json["rows"].size(), 3U);
  for (const auto& row : json["rows"]) {
    std::vector<std::string> keys;
    for (const auto& [key, value] : row.items()) keys.push_back(key);
    EXPECT_EQ(keys, kKeys);
  }
  EXPECT_EQ(json["rows"][0]["seconds_bake"], 4.0);
  EXPECT_EQ(json["rows"][1]["method"], "bad\xEF\xBF\xBD");
  EXPECT_TRUE(json["rows"][1]["steps"].is_null());
  EXPECT_TRUE(json["rows"][2]["direction_max_degrees"].is_null());
  EXPECT_TRUE(nlohmann::json::parse(curveJson({}))["rows"].empty());
}

TEST(Curve, MarkdownIsAlignedAndEscaped) {
  auto rows = sampleRows();
  rankCurve(rows, rows[0]);
  const auto table = lines(curveMarkdown(rows));
  ASSERT_EQ(table.size(), 5U);
  const auto width = [](const std::string& s) { return std::count_if(s.begin(), s.end(), [](char c) { return (c & 0xC0) != 0x80; }); };
  for (const std::string& line : table) EXPECT_EQ(width(line), width(table[0])) << line;
  EXPECT_EQ(table[0].find("| method "), 0U);
  EXPECT_NE(table[1].find("-: |"), std::string::npos);
  // Milliseconds and percent, where the file has seconds and shares.
  const auto cells = [&](size_t line) {
    std::string words;
    std::istringstream in(table[line]);
    for (std::string word; in >> word;) words += (words.empty() ? "" : " ") + word;
    return words;
  };
  EXPECT_EQ(cells(2),
            "| plain port | uniform | end | level set | 100 | 100 | 100 | 200.0 | 4000.0 | 8.00 | 6.00 | 14.00 | 40.0 | 5.00 | -3.00 | "
            "0.2000 | 1.0 | 1.0 | |");
  EXPECT_EQ(cells(3),
            "| sweep | fibonacci | – | coverage | 64 | – | 80 | 4.0 | 100.0 | 0.50 | 0.40 | 1.00 | 5.0 | 1.00 | 0.10 | 0.2000 | 40.0 | "
            "40.4 | * |");
  EXPECT_NE(table[4].find("odd\\|one"), std::string::npos);
}
