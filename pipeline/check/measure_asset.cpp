// The truth is that of docs/lobe_math.md, at a sample of vertices. It judges what lobes mean. It cannot tell a changed lobe from a rough
// one, so the asset is also baked anew with its own settings: a bake is deterministic, so that the same mesh gets the same lobes back, and
// what differs was changed. docs/check.md has the differences that were measured.
#include "pipeline/check/measure_asset.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bake/lobe/fit_lobe.h"
#include "bake/lobe/sweep.h"
#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/shells.h"
#include "bake/truth/error_metrics.h"
#include "core/error.h"
#include "core/harmonics.h"
#include "core/lobe_lighting.h"
#include "core/parallel.h"
#include "io/file/write_file.h"
#include "io/volume/lattice.h"
#include "pipeline/check/bake_anew.h"
#include "pipeline/measure/oracle.h"
#include "pipeline/sources/sculpt.h"

namespace cloudbake {

namespace {

constexpr size_t kTruthVertices = 200, kNewVertices = 2000, kVerticesOfDiagnosis = 400;
constexpr int kTruthDirections_check = 1024;  // of the truth's mean lobes: 4096 change the rms of 2° by 0.02°
constexpr size_t kComparedAxes = 64, kAxesOfDiagnosis = 32;

// How much a new bake may differ from a bake that nothing has changed, as rms of T.
constexpr double kSealedAgreement =
    0.1;  // of a seal that is whole: by what the metadata does not record, such as the wrap of --close or the lattice of --separate
constexpr double kFilledAgreement = 1;  // likewise, with holes, which are filled otherwise if the triangles have another order
constexpr double kAgreement = 0.01;     // by the rounding of a lattice
constexpr double kLooseAgreement =
    0.03;  // of a level of detail, whose lobes are the full asset's, and of objects with lattices of their own
constexpr double kUnknownAgreement = 0.06;  // of an asset without metadata, whose settings are guessed
constexpr double kNoiseFactor = 1.5;

// The truth of the asset. If its objects were baked separately, each has its own.
Oracle askTruth(const CheckedAsset& asset, const Settings& settings, const OracleQuestion& question, CheckReport& report) {
  const size_t count = asset.cloud.surface.positions.size(),
               wanted = std::min(count, settings.judge.truth_vertices.value_or(kTruthVertices));
  if (!report.run.info.separate) return askOracle(asset.cloud, settings.field, wanted, question);
  Oracle all;
  size_t first = 0;
  for (const Cloud& object : separateObjects(asset.cloud, settings.mesh, report.run)) {
    const size_t own = object.surface.positions.size();
    const Oracle part = askOracle(object, settings.field, std::max<size_t>(1, wanted * own / count), question);
    all.name = part.name;
    all.axes = part.axes;
    for (const size_t v : part.vertices) all.vertices.push_back(first + v);
    all.positions.insert(all.positions.end(), part.positions.begin(), part.positions.end());
    all.truth.lobes.insert(all.truth.lobes.end(), part.truth.lobes.begin(), part.truth.lobes.end());
    all.truth.concentration.insert(all.truth.concentration.end(), part.truth.concentration.begin(), part.truth.concentration.end());
    all.lengths.insert(all.lengths.end(), part.lengths.begin(), part.lengths.end());
    all.light.insert(all.light.end(), part.light.begin(), part.light.end());
    for (SurfacePoint point : part.surface.points) {
      for (uint32_t& corner : point.corners) corner += uint32_t(first);
      all.surface.points.push_back(point);
    }
    all.surface.light.insert(all.surface.light.end(), part.surface.light.begin(), part.surface.light.end());
    first += own;
  }
  return all;
}

// Lobes fitted again to the truth with the asset's k and b: to exact chords over its σ, or to the volume at one σ.
std::vector<Lobe> fitAnew(const Oracle& oracle, const std::vector<float>& weights, const AssetInfo& info) {
  FitSettings fit;
  fit.shape = info.shape;
  const auto range = rangeOfFit(info);
  fit.extinctions = range && !info.volume ? extinctionSteps(range->first, range->second) : std::vector<float>{info.extinction};
  const std::span<const float> targets = info.volume ? std::span(oracle.light) : std::span<const float>();
  return fitLobes(oracle.truth.lobes, {bothSenses(oracle.axes), oracle.lengths, weights, targets}, fit);
}

std::vector<uint32_t> piecesOfVertices(const SurfaceMesh& surface) {
  std::vector<uint32_t> pieces(surface.positions.size(), 0);
  const std::vector<Shell> shells = shellsOf(weldedByPosition(surface));
  for (uint32_t i = 0; i < shells.size(); ++i)
    for (const uint32_t triangle : shells[i].triangles)
      for (const uint32_t v : surface.triangles[triangle]) pieces[v] = i;
  return pieces;
}

// Through a sheet of thickness t a chord is t/cos θ long, so that half the median is t; on a ball half the median is half the radius.
float thicknessFrom(std::span<const float> lengths) {
  constexpr float kRounding = 1e-3F;  // of the longest; shorter chords come from rounding
  const float least = lengths.empty() ? 0 : kRounding * *std::max_element(lengths.begin(), lengths.end());
  std::vector<float> chords;
  std::copy_if(lengths.begin(), lengths.end(), std::back_inserter(chords), [&](float length) { return length > least; });
  if (chords.empty()) return 0;
  const auto middle = chords.begin() + ptrdiff_t(chords.size() / 2);
  std::nth_element(chords.begin(), middle, chords.end());
  return *middle / 2;
}

bool isUsable(const Lobe& lobe) { return isFinite(lobe.direction) && std::isfinite(lobe.thickness); }

// Per vertex, the rms of T over the lights between one lobe and another. A lobe that is not finite is as wrong as can be.
std::vector<double> lightErrors(std::span<const Lobe> a, std::span<const Lobe> b, const AssetInfo& info, std::span<const Vec3> lights) {
  std::vector<double> errors(a.size());
  parallelFor(a.size(), [&](size_t v) {
    double squares = 0;
    for (const Vec3& light : lights) {
      const double difference = double(lobeTransmittance(a[v], light, info.shape, info.extinction)) -
                                double(lobeTransmittance(b[v], light, info.shape, info.extinction));
      squares += difference * difference;
    }
    errors[v] = std::isfinite(squares) && isUsable(a[v]) ? std::sqrt(squares / double(lights.size())) : 1;
  });
  return errors;
}

double rmsOf(const std::vector<double>& errors) {
  double squares = 0;
  for (const double error : errors) squares += error * error;
  return errors.empty() ? 0 : std::sqrt(squares / double(errors.size()));
}

// The coefficients of some vertices.
std::vector<float> pickedRows(const std::vector<float>& rows, std::span<const size_t> vertices, size_t width) {
  std::vector<float> picked;
  for (const size_t v : vertices)
    picked.insert(picked.end(), rows.begin() + ptrdiff_t(v * width), rows.begin() + ptrdiff_t((v + 1) * width));
  return picked;
}

// T by coefficients, row by row, towards the lights.
std::vector<float> harmonicLight(std::span<const float> rows, size_t width, std::span<const Vec3> lights) {
  std::vector<float> light;
  for (size_t first = 0; first < rows.size(); first += width)
    for (const Vec3& l : lights) light.push_back(harmonicTransmittance(rows.subspan(first, width), l));
  return light;
}

double rmsBetween(std::span<const float> a, std::span<const float> b) {
  double squares = 0;
  for (size_t i = 0; i < a.size(); ++i) squares += (double(a[i]) - double(b[i])) * (double(a[i]) - double(b[i]));
  return a.empty() ? 0 : std::sqrt(squares / double(a.size()));
}

// Bakes the asset anew, and once more with another seed if its settings leave anything to chance.
Agreement agreementOf(const CheckedAsset& asset, const Settings& settings, CheckReport& report, AssetSample& sample) {
  const AssetInfo& info = report.run.info;
  const std::vector<Vec3> lights = bothSenses(sweepAxes(kComparedAxes));
  Warnings told_by_the_bake;
  const NewBake anew = bakeAnew(asset.cloud, info, settings.mesh, kNewVertices, told_by_the_bake);
  sample.vertices = anew.vertices;
  sample.right = anew.lobes;
  sample.errors = lightErrors(pick(asset.lobes, anew.vertices), anew.lobes, info, lights);
  Agreement agreement{anew.vertices.size(), rmsOf(sample.errors)};
  if (!asset.harmonics.empty()) {
    const size_t width = harmonicCount(info.harmonic_order);
    agreement.harmonics_rms = rmsBetween(harmonicLight(pickedRows(asset.harmonics, anew.vertices, width), width, lights),
                                         harmonicLight(anew.harmonics, width, lights));
  }
  if (info.method == "rays") {
    AssetInfo other = info;
    other.seed = info.seed + 1;
    other.harmonic_order = 0;
    const NewBake again = bakeAnew(asset.cloud, other, settings.mesh, kNewVertices, told_by_the_bake);
    agreement.noise = rmsOf(lightErrors(again.lobes, anew.lobes, info, lights));
  }
  // What a mean lobe shows does not depend on the size of the whole, a fitted one was fitted for one.
  const bool is_in_place = report.seal && !(info.lobe == "fit" ? report.seal->isReshaped() : report.seal->isDeformed());
  agreement.most = kNoiseFactor * agreement.noise + (asset.most_disagreement ? *asset.most_disagreement
                                                     : is_in_place           ? (asset.cloud.filled ? kFilledAgreement : kSealedAgreement)
                                                     : !asset.has_metadata   ? kUnknownAgreement
                                                     : info.level > 0 || info.separate ? kLooseAgreement
                                                                                       : kAgreement);
  return agreement;
}

// Whether the default constants, those of a search for a fit to a volume, give the stored lobes of a fitted asset.
std::string constantsOfFit(const CheckedAsset& asset, const AssetInfo& info, const AssetSample& sample) {
  constexpr double kShare = 0.9, kTurn_degrees = 1, kScale = 0.02;
  Warnings told_by_the_bake;
  LobeShape shape;
  const std::vector<Lobe> lobes = lobesByDefault(asset.cloud, info, sample.vertices, shape, told_by_the_bake);
  size_t same = 0;
  for (size_t i = 0; i < lobes.size(); ++i) {
    const Lobe& stored = asset.lobes[sample.vertices[i]];
    same += angleDegrees(stored.direction, lobes[i].direction) < kTurn_degrees &&
            std::fabs(stored.thickness - lobes[i].thickness) <= kScale * lobes[i].thickness;
  }
  const auto isNear = [&](float a, float b) { return std::fabs(a - b) <= 0.01F * std::max(std::fabs(a), std::fabs(b)); };
  if (isNear(shape.exponent, info.shape.exponent) && isNear(shape.bias, info.shape.bias)) return "";
  return double(same) > kShare * double(lobes.size()) ? fmt::format("exponent {:.4g} and bias {:.4g}", shape.exponent, shape.bias) : "";
}

DiagnosisSample diagnosisSample(const CheckedAsset& asset, const AssetSample& sample, const std::vector<float>& weights,
                                const std::vector<Vec3>& lights, const CheckReport& report) {
  const std::vector<uint32_t> pieces = piecesOfVertices(asset.cloud.surface);
  const AssetInfo& info = report.run.info;
  const bool is_fit = report.figures->bake.is_fit;
  DiagnosisSample diagnosis;
  diagnosis.shape = info.shape;
  diagnosis.extinction = info.extinction;
  const size_t axis_stride = std::max<size_t>(1, lights.size() / 2 / kAxesOfDiagnosis);
  for (size_t i = 0; is_fit && i < lights.size(); ++i)
    if (i / 2 % axis_stride == 0 && (weights.empty() || weights[i] > 0)) diagnosis.lights.push_back(lights[i]);
  for (const size_t i : drawnFromStretches(sample.vertices.size(), kVerticesOfDiagnosis)) {
    const size_t v = sample.vertices[i];
    if (!isUsable(asset.lobes[v])) continue;
    diagnosis.stored.push_back(report.file.uvs[v]);
    diagnosis.to_scene.push_back(asset.to_scene[v]);
    diagnosis.truth.push_back(sample.right[i]);
    diagnosis.pieces.push_back(pieces[v]);
    for (const Vec3& light : diagnosis.lights)
      diagnosis.true_fit.push_back(lobeTransmittance(sample.right[i], light, info.shape, info.extinction));
  }
  return diagnosis;
}

// The lattice beside a new one of the same cells.
double latticeError(const CheckedAsset& asset, const Settings& settings, const AssetInfo& info) {
  const std::filesystem::path& file = *settings.judge.lattice;
  const HarmonicLattice lattice =
      decodeLattice(file, readFileBytes(file), [&](const std::string& name) { return readFileBytes(file.parent_path() / name); });
  if (lattice.extinction != info.extinction)
    throw InputError(file.string(), "the lattice is for an extinction of " + std::to_string(lattice.extinction) + ", the asset has " +
                                        std::to_string(info.extinction) + ": bake both together");
  const HarmonicLattice anew = latticeAnew(asset.cloud, info, settings.mesh, lattice);
  if (anew.cells != lattice.cells || !(length(anew.origin - lattice.origin) <= 0.01F * lattice.cell_size)) return INFINITY;
  const std::vector<Vec3> lights = bothSenses(sweepAxes(kComparedAxes));
  const size_t width = harmonicCount(lattice.order);
  return rmsBetween(harmonicLight(lattice.coefficients, width, lights), harmonicLight(anew.coefficients, width, lights));
}

}  // namespace

std::optional<SealDifference> sealDifference(const CheckedAsset& asset, const AssetInfo& info, std::span<const LobeUvs> uvs) {
  if (!asset.has_metadata || !info.seal) return std::nullopt;
  SealMaker maker;
  size_t first = 0;
  const size_t width = asset.harmonics.empty() ? 0 : harmonicCount(info.harmonic_order);
  for (const SculptPart& part : asset.cloud.sculpt.parts) {
    const size_t count = part.positions.size();
    maker.add(part, uvs.subspan(first, count), std::span(asset.harmonics).subspan(first * width, count * width));
    first += count;
  }
  return differenceOf(*info.seal, maker.finished(info));
}

AssetSample measureAsset(const CheckedAsset& asset, const Settings& settings, float ray_length, CheckReport& report) {
  const AssetInfo& info = report.run.info;
  const LightSet lights = judgingLights(info);
  const Oracle oracle =
      askTruth(asset, settings, {info.extinction, info.volume, ray_length, lights.axes, kTruthDirections_check, true, true}, report);
  constexpr float kRounding = 1e-5F;
  const auto is_long = [&](float length) { return length > kRounding * ray_length; };
  if (std::none_of(oracle.lengths.begin(), oracle.lengths.end(), is_long))
    throw InputError("", "no ray finds any cloud behind the surface");
  const std::vector<Vec3> directions = bothSenses(oracle.axes);
  const auto rms = [&](const std::vector<Lobe>& of, LobeShape shape) {
    return compareLight(of, shape, directions, oracle.light, info.extinction, lights.weights).rms;
  };
  CheckFigures& figures = report.figures.emplace();
  figures.bake = figuresAgainst(oracle, asset.lobes, info.lobe == "fit", info.shape, info.extinction, lights.weights);
  figures.lights = directions.size();
  figures.mean_rms = rms(oracle.truth.lobes, defaultMeanShape(asset.cloud.surface));
  std::vector<Lobe> truth = oracle.truth.lobes;
  if (figures.bake.is_fit) {
    truth = fitAnew(oracle, lights.weights, info);
    figures.best_fit_rms = rms(truth, info.shape);
  }
  if (!asset.harmonics.empty()) {
    const size_t width = harmonicCount(info.harmonic_order);
    figures.harmonics =
        HarmonicError{info.harmonic_order, figures.bake.transmittance.rms,
                      rmsBetween(harmonicLight(pickedRows(asset.harmonics, oracle.vertices, width), width, directions), oracle.light)};
  }

  AssetSample sample;
  figures.agreement = agreementOf(asset, settings, report, sample);
  sample.diagnosis = diagnosisSample(asset, sample, lights.weights, directions, report);
  for (size_t i = 0; i < oracle.vertices.size(); ++i)
    sample.thickness.push_back(thicknessFrom(std::span(oracle.lengths).subspan(i * directions.size(), directions.size())));
  DiagnosisSample against_truth;
  against_truth.truth = truth;
  const std::vector<Lobe> stored = pick(asset.lobes, oracle.vertices);
  sample.off = figures.bake.is_fit ? lightErrors(stored, truth, info, directions) : vertexErrors(stored, against_truth);
  if (figures.bake.is_fit && !report.seal && figures.agreement.rms > figures.agreement.most)
    sample.other_constants = constantsOfFit(asset, info, sample);
  if (settings.judge.lattice) report.lattice_rms = latticeError(asset, settings, info);
  return sample;
}

}  // namespace cloudbake
