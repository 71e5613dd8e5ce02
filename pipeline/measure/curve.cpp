#include "pipeline/measure/curve.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <map>

#include "bake/field/dense_field.h"
#include "bake/lobe/directions.h"
#include "bake/truth/error_metrics.h"
#include "bake/truth/peers.h"
#include "bake/lobe/sweep.h"
#include "io/report/curve.h"
#include "io/report/plot.h"
#include "io/file/write_file.h"

namespace cloudbake {

namespace {

constexpr size_t kTruthVertices = 2000, kMarchedTruthVertices = 200;

double secondsOf(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// The least of several runs: at least two, more of what is quick.
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
  Curve(const Scene& scene, const Settings& settings, const BakeReport& report)
      : scene_(scene), settings_(settings), report_(report), oracle_(askOracle(scene, settings)), directions_(bothSenses(oracle_.axes)) {}

  void addSweep(FieldChoice choice, int voxels, int directions) {
    const Field& field = fieldOf(Method::kSweep, choice, voxels);
    BakeSettings bake = settings_.bake;
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
  // The peers' level set counts as their field; the copy into bricks is ours.
  void addPlainPort(int voxels) { addTreePeer("plain port", plainSphereRays, voxels, 100); }
  void addHdda(int voxels) { addTreePeer("OpenVDB HDDA", hddaSphereRays, voxels, 0); }
  void addEmbree(int rays) {
    std::unique_ptr<Reference> reference;
    CurveRow row;
    row.method = "Embree all hits";
    row.sampler = "stratified";
    row.directions = rays;
    row.seconds_field = leastSeconds([&] { reference = meshReference(scene_.surface); });
    const BakeSettings bake = raySettings(Sampler::kStratified, Quadrature::kCrossing, rays, 100);
    add(row, [&](Warnings& warnings) { return embreeSphereRays(points(), *reference, bake, warnings); });
  }

  std::vector<CurveRow> rows;

 private:
  struct Field {
    IntegrationField integration;
    int voxels = 0;
    double seconds = 0;
  };

  BakePoints points() const { return {scene_.surface.positions, scene_.surface.normals}; }

  BakeSettings raySettings(Sampler sampler, Quadrature quadrature, int rays, int steps) const {
    BakeSettings bake = settings_.bake;
    bake.method = Method::kRays;
    bake.sampler = sampler;
    bake.quadrature = quadrature;
    bake.rays = rays;
    bake.steps = steps;
    return bake;
  }
  Settings resolution(Method method, FieldChoice choice, int voxels) const {
    Settings settings = settings_;
    settings.bake.method = method;
    settings.field = choice;
    settings.bake_voxels = voxels;
    return settings;
  }
  const Field& fieldOf(Method method, FieldChoice choice, int voxels) {
    const auto [found, is_new] = fields_.try_emplace({method, choice, voxels});
    Field& field = found->second;
    if (is_new) {
      const Settings settings = resolution(method, choice, voxels);
      Warnings not_told;
      field.seconds = leastSeconds([&] { field.integration = buildField(scene_, settings, not_told); });
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
    const Settings settings = resolution(Method::kRays, FieldChoice::kAuto, voxels);
    LevelSet level_set;
    Field field;
    field.seconds = leastSeconds([&] { level_set = levelSetOf(scene_, settings, Lattice::kIntegration, not_told); });
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
    const std::vector<Lobe> lobes = pick(all, oracle_.vertices);
    const LobeError error = compareLobes(lobes, oracle_.truth);
    row.direction_rms_degrees = error.angle_rms_degrees;
    row.direction_median_degrees = error.angle_median_degrees;
    row.direction_p95_degrees = error.angle_p95_degrees;
    row.direction_max_degrees = error.angle_max_degrees;
    row.density_rms = error.density_rms;
    row.density_bias = error.density_bias;
    row.transmittance_rms = compareTransmittance(lobes, report_.info.shape, directions_, oracle_.lengths, report_.info.extinction).rms;
    rows.push_back(row);
  }

  const Scene& scene_;
  const Settings& settings_;
  const BakeReport& report_;
  Oracle oracle_;
  std::vector<Vec3> directions_;
  std::map<std::tuple<Method, FieldChoice, int>, Field> fields_;
};

// What is worth showing: along N, along the resolution, and each choice beside the default.
void addAll(Curve& curve, bool closed) {
  for (const int voxels : {35, 100}) curve.addPlainPort(voxels);
  curve.addHdda(100);
  if (closed)
    for (const int rays : {36, 100, 400}) curve.addEmbree(rays);

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

ScatterPlot plotOf(const std::vector<CurveRow>& rows, const std::string& input) {
  ScatterPlot plot;
  plot.title = input + ": seconds and error";
  plot.x_title = "field and bake, seconds";
  plot.y_title = "direction, rms error in degrees";
  for (const CurveRow& row : rows) {
    std::string name = row.method;
    if (row.method == "sweep") name += ", " + row.field + ", " + std::to_string(row.voxels) + " voxels";
    if (row.method == "rays") name += ", " + row.sampler;
    auto series = std::find_if(plot.series.begin(), plot.series.end(), [&](const PlotSeries& s) { return s.name == name; });
    if (series == plot.series.end()) series = plot.series.insert(plot.series.end(), {name, {}});
    series->points.push_back({row.seconds(), row.direction_rms_degrees, "N=" + std::to_string(row.directions)});
  }
  return plot;
}

}  // namespace

Oracle askOracle(const Scene& scene, const Settings& settings, const std::vector<Vec3>& axes) {
  Oracle oracle;
  const size_t wanted = settings.truth_vertices.value_or(truthIsMarched(scene) ? kMarchedTruthVertices : kTruthVertices);
  oracle.vertices = evenlySpread(scene.surface.positions.size(), wanted);
  oracle.positions = pick(scene.surface.positions, oracle.vertices);
  const auto reference = referenceFor(scene, settings);
  const double ray_length = *settings.bake.ray_length;
  oracle.name = reference->name();
  oracle.truth = trueLobes(*reference, oracle.positions, fibonacciDirections(kTruthDirections), ray_length);
  oracle.axes = axes.empty() ? sweepAxes(kTransmittanceDirections) : axes;
  oracle.lengths = trueLengths(*reference, oracle.positions, bothSenses(oracle.axes), ray_length);
  return oracle;
}

ExitCode runCurve(const Scene& scene, const Settings& settings, const BakeReport& report) {
  Curve curve(scene, settings, report);
  addAll(curve, scene.solid() != nullptr);
  const auto plain = std::find_if(curve.rows.begin(), curve.rows.end(),
                                  [](const CurveRow& row) { return row.method == "plain port" && row.voxels == 100; });
  const CurveRow baseline = *plain;
  rankCurve(curve.rows, baseline);
  if (!settings.quiet) std::fputs(curveMarkdown(curve.rows).c_str(), stdout);

  std::error_code failed;
  std::filesystem::create_directories(settings.output, failed);
  if (failed) throw IoError(settings.output.string(), "the folder cannot be made: " + failed.message());
  const std::string name = report.input.empty() ? "input" : std::filesystem::path(report.input).filename().string();
  writeFileAtomically(settings.output / "curve.csv", curveCsv(curve.rows));
  writeFileAtomically(settings.output / "curve.json", curveJson(curve.rows));
  writeFileAtomically(settings.output / "curve.svg", scatterSvg(plotOf(curve.rows, name)));
  return ExitCode::kDone;
}

}  // namespace cloudbake
