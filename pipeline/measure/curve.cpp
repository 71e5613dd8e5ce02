#include "pipeline/measure/curve.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <map>

#include "bake/field/dense_field.h"
#include "bake/lobe/directions.h"
#include "bake/lobe/sweep.h"
#include "bake/truth/peers.h"
#include "core/ray_scene.h"
#include "io/report/plot.h"
#include "pipeline/fields/fields.h"
#include "pipeline/measure/oracle.h"

namespace cloudbake {

namespace {

double secondsOf(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// The least time of several runs: at least two, and more if they are quick.
double leastSeconds(const std::function<void()>& work) {
  constexpr int kMost = 20;
  constexpr double kEnough_seconds = 0.3;
  double least = secondsOf(work), total = least;
  for (int run = 1; run < kMost && (run < 2 || total < kEnough_seconds); ++run) {
    const double seconds = secondsOf(work);
    least = std::min(least, seconds);
    total += seconds;
  }
  return least;
}

class Curve {
 public:
  Curve(const Cloud& cloud, const Settings& settings, const BakeParameters& parameters)
      : cloud_(cloud),
        fields_of_(settings.field),
        parameters_(parameters),
        oracle_(askOracle(cloud, settings.field, settings.judge.truth_vertices, {parameters.extinction, {}, *parameters.bake.ray_length})) {
  }

  void addSweep(FieldChoice choice, int voxels, int directions) {
    const Field& field = fieldOf(Method::kSweep, choice, voxels);
    BakeSettings bake = parameters_.bake;
    bake.method = Method::kSweep;
    bake.rays = directions;
    CurveRow row = rowOf("sweep", "", "", field, directions, 0);
    add(row, [&](Warnings& warnings) { return bakeSweep(points(), *field.integration.coverage, bake, warnings); });
  }
  void addRays(int voxels, Sampler sampler, Quadrature quadrature, int rays, int steps) {
    const Field& field = fieldOf(Method::kRays, FieldChoice::kAuto, voxels);
    const BakeSettings bake = raySettings(sampler, quadrature, rays, steps);
    CurveRow row = rowOf("rays", std::string(samplerName(sampler)), std::string(quadratureName(quadrature)), field, rays, steps);
    add(row, [&](Warnings& warnings) { return bakeSphereRays(points(), *field.integration.dense, bake, warnings); });
  }
  // The level set counts as the field of these peers; the copy into bricks belongs to our method.
  void addPlainPort(int voxels) { addTreePeer("plain port", plainSphereRays, voxels, 100); }
  void addHdda(int voxels) { addTreePeer("OpenVDB HDDA", hddaSphereRays, voxels, 0); }
  void addAllHits(int rays) {
    std::unique_ptr<Reference> reference;
    CurveRow row;
    row.method = RayScene::kName + std::string(" all hits");
    row.sampler = "stratified";
    row.directions = rays;
    row.seconds_field = leastSeconds([&] { reference = meshReference(cloud_.surface); });
    const BakeSettings bake = raySettings(Sampler::kStratified, Quadrature::kCrossing, rays, 100);
    add(row, [&](Warnings& warnings) { return referenceSphereRays(points(), *reference, bake, warnings); });
  }

  std::vector<CurveRow> rows;

 private:
  struct Field {
    IntegrationField integration;
    int voxels = 0;
    double seconds = 0;
  };

  BakePoints points() const { return {cloud_.surface.positions, cloud_.surface.normals}; }

  BakeSettings raySettings(Sampler sampler, Quadrature quadrature, int rays, int steps) const {
    BakeSettings bake = parameters_.bake;
    bake.method = Method::kRays;
    bake.sampler = sampler;
    bake.quadrature = quadrature;
    bake.rays = rays;
    bake.steps = steps;
    return bake;
  }
  FieldSettings resolution(FieldChoice choice, int voxels) const {
    FieldSettings settings = fields_of_;
    settings.kind = choice;
    settings.bake_voxels = voxels;
    return settings;
  }
  const Field& fieldOf(Method method, FieldChoice choice, int voxels) {
    const auto [found, is_new] = fields_.try_emplace({method, choice, voxels});
    Field& field = found->second;
    if (is_new) {
      const FieldSettings settings = resolution(choice, voxels);
      Warnings not_told;
      field.seconds = leastSeconds([&] { field.integration = buildField(cloud_, settings, method, not_told); });
      field.voxels = voxels;
    }
    return field;
  }
  CurveRow rowOf(const char* method, const std::string& sampler, const std::string& quadrature, const Field& field, int directions,
                 int steps) const {
    CurveRow row;
    row.method = method;
    row.sampler = sampler;
    row.quadrature = quadrature;
    row.field = field.integration.kind;
    row.directions = directions;
    row.steps = steps;
    row.voxels = field.voxels;
    row.seconds_field = field.seconds;
    return row;
  }
  template <class Peer>
  void addTreePeer(const char* name, const Peer& peer, int voxels, int steps) {
    Warnings not_told;
    const FieldSettings settings = resolution(FieldChoice::kAuto, voxels);
    LevelSet level_set;
    Field field;
    field.seconds = leastSeconds([&] { level_set = levelSetOf(cloud_, settings, Lattice::kIntegration, not_told); });
    field.voxels = voxels;
    field.integration.kind = "level set";
    const BakeSettings bake = raySettings(Sampler::kStratified, Quadrature::kCrossing, 100, 100);
    CurveRow row = rowOf(name, "stratified", steps ? "crossing" : "", field, 100, steps);
    add(row, [&](Warnings& warnings) { return peer(points(), level_set, bake, warnings); });
  }
  template <class Bake>
  void add(CurveRow& row, const Bake& bake) {
    std::vector<Lobe> all;
    row.seconds_bake = leastSeconds([&] {
      Warnings not_told;
      all = bake(not_told);
    });
    row.figures = figuresAgainst(oracle_, all, false, parameters_.shape, parameters_.extinction);
    rows.push_back(row);
  }

  const Cloud& cloud_;
  const FieldSettings& fields_of_;
  const BakeParameters& parameters_;
  Oracle oracle_;
  std::map<std::tuple<Method, FieldChoice, int>, Field> fields_;
};

// The rows worth showing: over N, over the resolution, and every choice other than the default.
void addAll(Curve& curve, bool closed) {
  for (const int voxels : {35, 100}) curve.addPlainPort(voxels);
  curve.addHdda(100);
  if (closed)
    for (const int rays : {36, 100, 400}) curve.addAllHits(rays);

  for (const int voxels : {35, 100}) curve.addRays(voxels, Sampler::kStratified, Quadrature::kCrossing, 100, 100);
  for (const Sampler sampler : {Sampler::kUniform, Sampler::kFibonacci}) curve.addRays(100, sampler, Quadrature::kCrossing, 100, 100);
  for (const Quadrature quadrature : {Quadrature::kMidpoint, Quadrature::kEnd})
    curve.addRays(100, Sampler::kStratified, quadrature, 100, 100);
  for (const int steps : {50, 200}) curve.addRays(100, Sampler::kStratified, Quadrature::kCrossing, 100, steps);
  for (const int rays : {36, 400}) curve.addRays(100, Sampler::kFibonacci, Quadrature::kCrossing, rays, 100);

  for (const int voxels : {35, 100})
    for (const int directions : {16, 24, 36, 50, 72, 100, 144, 200, 400, 1024}) curve.addSweep(FieldChoice::kAuto, voxels, directions);
  for (const int voxels : {24, 50, 70, 140, 200})
    for (const int directions : {50, 100, 400, 1024}) curve.addSweep(FieldChoice::kAuto, voxels, directions);
  if (closed)
    for (const int voxels : {35, 100}) curve.addSweep(FieldChoice::kLevelSet, voxels, 100);
}

// The same in every plot, whatever else is in it.
size_t styleOf(const std::string& name) {
  const std::array<std::string, 7> names = {
      "sweep", "rays", RayScene::kName + std::string(" all hits"), "OpenVDB HDDA", "plain port", "", "sweep, level set"};
  return size_t(std::find(names.begin(), names.end(), name) - names.begin());
}

bool isDefault(const CurveRow& row) {
  return row.method == "sweep" && row.directions == BakeSettings().rays && row.voxels == FieldSettings().voxels;
}

// A series for each method, and for each resolution of the sweep a line over N. What is not the default of rays is in the label.
ScatterPlot plotOf(const std::vector<CurveRow>& rows, const std::string& input) {
  ScatterPlot plot;
  plot.title = input + ": seconds and error of every method";
  plot.x_title = "time of field and bake, seconds";
  plot.y_title = "rms error of the direction, degrees";
  bool default_is_there = false;
  for (const CurveRow& row : rows) {
    const bool is_sweep = row.method == "sweep";
    const std::string name = row.method + (is_sweep && row.field == "level set" ? ", level set" : "");
    const std::string line = is_sweep ? std::to_string(row.voxels) + " voxels" : "";
    auto series =
        std::find_if(plot.series.begin(), plot.series.end(), [&](const PlotSeries& s) { return s.name == name && s.line_label == line; });
    if (series == plot.series.end()) series = plot.series.insert(plot.series.end(), {name, {}, styleOf(name), line});
    std::string label = "N=" + std::to_string(row.directions);
    if (row.method == "rays" && row.sampler != "stratified") label += ", " + row.sampler;
    if (row.method == "rays" && row.quadrature != "crossing") label += ", " + row.quadrature;
    const bool is_default = isDefault(row) && !default_is_there;  // the sweep through the field that is chosen by itself comes first
    default_is_there = default_is_there || is_default;
    series->points.push_back({row.seconds(), row.figures.lobe.angle_rms_degrees, label, is_default});
  }
  return plot;
}

}  // namespace

std::vector<CurveRow> measureCurve(const Cloud& cloud, const Settings& settings, const BakeParameters& parameters) {
  Curve curve(cloud, settings, parameters);
  addAll(curve, cloud.solid() != nullptr);
  const auto plain = std::find_if(curve.rows.begin(), curve.rows.end(),
                                  [](const CurveRow& row) { return row.method == "plain port" && row.voxels == 100; });
  const CurveRow baseline = *plain;
  rankCurve(curve.rows, baseline);
  return curve.rows;
}

std::string curveSvg(const std::vector<CurveRow>& rows, const std::string& input) { return scatterSvg(plotOf(rows, input)); }

}  // namespace cloudbake
