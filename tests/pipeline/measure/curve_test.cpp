// The rows of `measure`, of a bar that is so thin that even 200 voxels along it are few.
#include "pipeline/measure/curve.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "core/ray_scene.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

const std::string kAllHits = RayScene::kName + std::string(" all hits");

Cloud bar() { return cloudOf(boxMesh({0, 0, 0}, {1, 0.1F, 0.12F})); }

const std::vector<CurveRow>& rows() {
  static const std::vector<CurveRow> all = [] {
    const Cloud cloud = bar();
    const Settings settings = resolve(sourceOf(SourceKind::kSculpt), {});
    return measureCurve(cloud, settings, parametersFor(cloud, settings));
  }();
  return all;
}

std::vector<const CurveRow*> rowsOf(const std::string& method) {
  std::vector<const CurveRow*> found;
  for (const CurveRow& row : rows())
    if (row.method == method) found.push_back(&row);
  return found;
}

TEST(Curve, EveryMethodAndChoiceIsThereOnce) {
  std::set<std::tuple<std::string, std::string, std::string, std::string, int, int, int>> seen;
  std::set<std::string> methods, samplers, quadratures, fields;
  for (const CurveRow& row : rows()) {
    EXPECT_TRUE(seen.insert({row.method, row.sampler, row.quadrature, row.field, row.directions, row.steps, row.voxels}).second)
        << row.method << row.sampler << row.directions << " " << row.voxels;
    methods.insert(row.method);
    if (row.method == "rays") samplers.insert(row.sampler), quadratures.insert(row.quadrature);
    if (row.method == "sweep") fields.insert(row.field);
  }
  EXPECT_EQ(methods, (std::set<std::string>{"rays", "sweep", "plain port", "OpenVDB HDDA", kAllHits}));
  EXPECT_EQ(samplers, (std::set<std::string>{"stratified", "fibonacci", "uniform"}));
  EXPECT_EQ(quadratures, (std::set<std::string>{"crossing", "midpoint", "end"}));
  EXPECT_EQ(fields, (std::set<std::string>{"coverage", "level set"}));
}

TEST(Curve, ErrorsFallWithDirectionsAndVoxels) {
  const auto errorOf = [](int voxels, int directions) {
    for (const CurveRow* row : rowsOf("sweep"))
      if (row->field == "coverage" && row->voxels == voxels && row->directions == directions) return row->figures.lobe.angle_rms_degrees;
    ADD_FAILURE() << "no row";
    return 0.0;
  };
  EXPECT_LT(errorOf(100, 1024), errorOf(100, 16) / 2);
  EXPECT_LT(errorOf(200, 1024), errorOf(24, 1024));
  for (const CurveRow& row : rows()) {
    EXPECT_EQ(row.figures.vertices, 8U);
    EXPECT_GT(row.seconds_bake, 0);
    EXPECT_GT(row.seconds_field, 0);
    EXPECT_FALSE(row.figures.is_fit);
  }
}

// Against the plain port at 100 voxels, and the front of seconds and error, found by comparing each with each.
TEST(Curve, RowsAreRanked) {
  const auto ports = rowsOf("plain port");
  const auto plain = std::find_if(ports.begin(), ports.end(), [](const CurveRow* row) { return row->voxels == 100; });
  ASSERT_NE(plain, ports.end());
  EXPECT_DOUBLE_EQ((*plain)->speedup_bake, 1);
  size_t front = 0;
  for (const CurveRow& row : rows()) {
    EXPECT_NEAR(row.speedup_bake, (*plain)->seconds_bake / row.seconds_bake, 1e-9 * row.speedup_bake);
    EXPECT_NEAR(row.speedup_with_field, (*plain)->seconds() / row.seconds(), 1e-9 * row.speedup_with_field);
    const bool beaten = std::any_of(rows().begin(), rows().end(), [&](const CurveRow& other) {
      const double time = other.seconds() - row.seconds(),
                   error = other.figures.lobe.angle_rms_degrees - row.figures.lobe.angle_rms_degrees;
      return time <= 0 && error <= 0 && (time < 0 || error < 0);
    });
    EXPECT_EQ(row.pareto, !beaten) << row.method << " " << row.directions << " " << row.voxels;
    front += row.pareto;
  }
  EXPECT_GT(front, 0U);
  EXPECT_LT(front, rows().size());
}

TEST(Curve, ThePlotShowsEveryMethod) {
  const std::string svg = curveSvg(rows(), "bar & co");
  EXPECT_TRUE(contains(svg, "<svg") && contains(svg, "bar &amp; co: seconds and error"));
  for (const std::string& name : std::vector<std::string>{"plain port", kAllHits, "OpenVDB HDDA", "rays", "sweep", "sweep, level set"})
    EXPECT_TRUE(contains(svg, ">" + name + "</text>")) << name;
  for (const char* point : {"rays, N=100, fibonacci: ", "sweep, 100 voxels, N=16: ", "sweep, level set, 35 voxels, N=100: "})
    EXPECT_TRUE(contains(svg, point)) << point;
  EXPECT_TRUE(contains(svg, ">default, N=100</text>"));
}

// A method looks the same in a plot that lacks others, such as that of an open mesh.
TEST(Curve, AMethodHasOneLook) {
  std::vector<CurveRow> fewer = rows();
  std::erase_if(fewer, [](const CurveRow& row) { return row.method == kAllHits || row.method == "rays"; });
  const auto lookOf = [](const std::string& svg) {
    const size_t end = svg.find("><title>plain port"), begin = svg.rfind("fill=", end);
    return svg.substr(begin, end - begin);
  };
  EXPECT_EQ(lookOf(curveSvg(fewer, "bar")), lookOf(curveSvg(rows(), "bar")));
}

}  // namespace
}  // namespace cloudbake
