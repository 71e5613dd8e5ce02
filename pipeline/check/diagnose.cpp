// Importers and optimisers change lobes in few ways: they flip V, swap sets or channels, turn or mirror axes, scale, or move vertices by a
// node's transform and leave the lobes. Each change is undone here. Discrete changes are tried in full (the 48 signed permutations of three
// axes). Continuous ones are estimated from the sample: a scale as the median of d*/d, a node's transform as the least-squares linear map M
//   Σ w ‖v* − M·v‖²   →   M = (Σ w v* vᵀ)(Σ w v vᵀ)⁻¹,    v = o·d, weights w = 1/(residual + ε) renewed five times,
// its rotation by Newton's iteration on the polar decomposition, R ← (R + R⁻ᵀ)/2 (Higham, SIAM J. Sci. Stat. Comput. 7(4), 1986), a scaled
// channel as a least-squares line. None of these has enough freedom to explain the lobes of another mesh.
#include "pipeline/check/diagnose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "core/lobe_lighting.h"
#include "core/portable_math.h"

namespace cloudbake {

namespace {

constexpr double kExplains = 0.6, kAsGood = 1.15, kAsGoodToo = 0.01;
constexpr double kNothingToExplain = 0.06, kNothingToExplain_fit = 0.03, kRight = 0.25, kRight_fit = 0.15;
constexpr int kRounds = 5;
constexpr size_t kLeastOfPiece = 20;

// A discrete change of the four numbers, undone in this order.
struct Undo {
  bool flip_first = false, flip_second = false, swap_sets = false, swap_first = false, swap_second = false;
  std::array<int, 3> axis{0, 1, 2}, sign{1, 1, 1};
  float scale = 1;
};

LobeUvs undone(LobeUvs uvs, const Undo& undo) {
  if (undo.flip_first) uvs.first.y = 1 - uvs.first.y;
  if (undo.flip_second) uvs.second.y = 1 - uvs.second.y;
  if (undo.swap_sets) std::swap(uvs.first, uvs.second);
  if (undo.swap_first) std::swap(uvs.first.x, uvs.first.y);
  if (undo.swap_second) std::swap(uvs.second.x, uvs.second.y);
  const float o[3] = {uvs.first.x, uvs.first.y, uvs.second.x};
  const auto component = [&](size_t i) { return float(undo.sign[i]) * o[undo.axis[i]]; };
  return {{component(0), component(1)}, {component(2), uvs.second.y * undo.scale}};
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return values.empty() ? 0 : sum / double(values.size());
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<Lobe> decoded(const DiagnosisSample& sample, const Undo& undo) {
  std::vector<Lobe> lobes;
  for (size_t v = 0; v < sample.stored.size(); ++v) {
    const Lobe lobe = unpackLobe(undone(sample.stored[v], undo), sample.to_scene[v]);
    lobes.push_back({lobe.direction, std::fabs(lobe.thickness)});
  }
  return lobes;
}

std::vector<Vec3> vectorsOf(const std::vector<Lobe>& lobes) {
  std::vector<Vec3> vectors;
  for (const Lobe& lobe : lobes) vectors.push_back(lobe.direction * lobe.thickness);
  return vectors;
}

std::vector<Lobe> mapped(const std::vector<Lobe>& lobes, const Affine& map) {
  std::vector<Lobe> result;
  for (const Lobe& lobe : lobes) result.push_back(mappedLobe(lobe, map));
  return result;
}

double densityRatio(const std::vector<Lobe>& lobes, const std::vector<Lobe>& truth) {
  std::vector<double> ratios;
  for (size_t v = 0; v < lobes.size(); ++v)
    if (lobes[v].thickness > 0) ratios.push_back(double(truth[v].thickness) / lobes[v].thickness);
  return median(ratios);
}

// The right o in terms of the stored one, such as "(x, -z, y)".
std::string axesText(const Undo& undo) {
  std::string text;
  for (size_t i = 0; i < 3; ++i) text += (i ? ", " : "(") + std::string(undo.sign[i] < 0 ? "-" : "") + "xyz"[undo.axis[i]];
  return text + ")";
}

constexpr const char* kCureOfV = "decode with 1 - v, or switch the importer's V flip off for these sets (docs/asset_format.md)";
constexpr const char* kCureOfAxes = "turn o as the importer turned the positions (docs/asset_format.md), or import with glTF's axes";
constexpr const char* kCureOfNodes = "do not apply node transforms after the bake (gltfpack -kn, no join), or bake again as the last step";

class Trial {
 public:
  explicit Trial(const DiagnosisSample& sample) : sample_(sample) { add("as-is", "the asset as it is", "", decoded(sample, {})); }

  void add(const std::string& cause, const std::string& what, const std::string& cure, const std::vector<Lobe>& lobes) {
    const std::vector<double> errors = vertexErrors(lobes, sample_);
    const double bound = sample_.true_fit.empty() ? kRight : kRight_fit;
    const auto right = std::count_if(errors.begin(), errors.end(), [&](double error) { return error < bound; });
    result_.tried.push_back({cause, what, cure, mean(errors), errors.empty() ? 0 : double(right) / double(errors.size())});
  }
  void add(const std::string& cause, const std::string& what, const std::string& cure, const Undo& undo) {
    add(cause, what, cure, decoded(sample_, undo));
  }
  double errorOf(const Undo& undo) const { return mean(vertexErrors(decoded(sample_, undo), sample_)); }

  // With the best scale of d.
  Undo scaled(Undo undo) const {
    const double ratio = densityRatio(decoded(sample_, undo), sample_.truth);
    if (ratio > 0) undo.scale = float(ratio);
    return undo;
  }

  Diagnosis judged() {
    const double as_is = result_.tried.front().error;
    if (as_is < (sample_.true_fit.empty() ? kNothingToExplain : kNothingToExplain_fit)) return result_;
    double least = as_is;
    for (const Hypothesis& one : result_.tried) least = std::min(least, one.error);
    const double right = result_.tried.front().right;  // a change of all lobes does not make right ones wrong when it is undone
    for (size_t i = 1; i < result_.tried.size() && result_.best == 0; ++i)
      if (result_.tried[i].error < kExplains * as_is && result_.tried[i].error <= kAsGood * least + kAsGoodToo &&
          result_.tried[i].right >= right)
        result_.best = i;
    return result_;
  }

 private:
  const DiagnosisSample& sample_;
  Diagnosis result_;
};

void tryChannels(Trial& trial) {
  trial.add("v-flipped", "V is flipped in both sets (1 - v)", kCureOfV, Undo{.flip_first = true, .flip_second = true});
  trial.add("v-flipped", "V is flipped in the first set (1 - v)", kCureOfV, Undo{.flip_first = true});
  trial.add("v-flipped", "V is flipped in the second set (1 - v)", kCureOfV, Undo{.flip_second = true});
  constexpr const char* kCureOfOrder = "give the shader the sets and channels in the order of docs/asset_format.md";
  trial.add("sets-swapped", "the two UV sets are swapped", kCureOfOrder, Undo{.swap_sets = true});
  trial.add("channels-swapped", "u and v are swapped in both sets", kCureOfOrder, Undo{.swap_first = true, .swap_second = true});
  trial.add("channels-swapped", "u and v of the first set (o.x, o.y) are swapped", kCureOfOrder, Undo{.swap_first = true});
  trial.add("channels-swapped", "u and v of the second set (o.z, d) are swapped", kCureOfOrder, Undo{.swap_second = true});
}

// All signed permutations except the identity, grouped by their cause.
std::map<std::string, std::vector<Undo>> axisChanges() {
  std::map<std::string, std::vector<Undo>> changes;
  std::array<int, 3> axis{0, 1, 2};
  do
    for (int signs = 0; signs < 8; ++signs) {
      Undo undo;
      undo.axis = axis;
      int negated = 0;
      for (size_t i = 0; i < 3; ++i)
        if (signs & (1 << i)) undo.sign[i] = -1, ++negated;
      const bool in_place = axis == std::array{0, 1, 2};
      if (in_place && negated == 0) continue;
      changes[in_place && negated == 1 ? "handedness" : in_place && negated == 3 ? "inverted" : "axes"].push_back(undo);
    }
  while (std::next_permutation(axis.begin(), axis.end()));
  return changes;
}

// Adds the best of many changes as one hypothesis.
void tryBest(Trial& trial, const std::string& cause, const std::vector<Undo>& all, const char* cure,
             const std::function<std::string(const Undo&)>& what) {
  const Undo* best = &all.front();
  double least = INFINITY;
  for (const Undo& undo : all)
    if (const double error = trial.errorOf(undo); error < least) least = error, best = &undo;
  trial.add(cause, what(*best), cure, *best);
}

std::string unitsText(const Undo& undo) { return fmt::format("d is {:.4g} times what it should be", 1 / double(undo.scale)); }

void tryAxes(Trial& trial) {
  auto changes = axisChanges();
  const auto negated = [](const Undo& undo) { return "xyz"[undo.sign[0] < 0 ? 0 : undo.sign[1] < 0 ? 1 : 2]; };
  const auto turned = [](const Undo& undo) { return "o has other axes than the positions: it should be " + axesText(undo); };
  tryBest(trial, "handedness", changes["handedness"], kCureOfAxes,
          [&](const Undo& undo) { return std::string("wrong handedness: o.") + negated(undo) + " is negated"; });
  tryBest(trial, "inverted", changes["inverted"], kCureOfAxes,
          [](const Undo&) { return "o points out of the cloud: all three components are negated"; });
  tryBest(trial, "axes", changes["axes"], kCureOfAxes, turned);

  constexpr const char* kCureOfUnits =
      "scale d as the importer scaled the positions (docs/asset_format.md), or bake again as the last step";
  trial.add("units", unitsText(trial.scaled({})) + ": positions and lobes are in different units", kCureOfUnits, trial.scaled({}));
  std::vector<Undo> scaled, flipped, both;
  for (const auto& [kind, all] : changes)
    for (Undo undo : all) {
      scaled.push_back(trial.scaled(undo));
      undo.flip_first = undo.flip_second = true;
      flipped.push_back(undo);
      both.push_back(trial.scaled(undo));
    }
  both.push_back(trial.scaled({.flip_first = true, .flip_second = true}));
  tryBest(trial, "v-flipped", flipped, kCureOfAxes,
          [&](const Undo& undo) { return "V is flipped in both sets (1 - v), and then " + turned(undo); });
  tryBest(trial, "units", scaled, kCureOfAxes, [&](const Undo& undo) { return turned(undo) + ", and " + unitsText(undo); });
  tryBest(trial, "v-flipped", both, kCureOfAxes,
          [&](const Undo& undo) { return "V is flipped in both sets (1 - v), then " + turned(undo) + ", and " + unitsText(undo); });
}

std::string mapText(const Affine& map) {
  const double det = determinant(map), scale = portablePow(std::fabs(det), 1.0 / 3);
  if (!(scale > 0)) return "";
  Affine even = map;
  for (auto& row : even.linear)
    for (double& x : row) x /= det < 0 ? -scale : scale;
  const Affine turn = nearestRotation(even);
  const auto& r = turn.linear;
  double skew = 0;
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j) skew = std::max(skew, std::fabs(even.linear[i][j] - r[i][j]));
  const double angle = acosDegrees(std::clamp((r[0][0] + r[1][1] + r[2][2] - 1) / 2, -1.0, 1.0));
  return fmt::format(" (turned by {:.3g} degrees, scaled by {:.3g}", angle, scale) + (skew > 0.05 ? ", unevenly" : "") +
         (det < 0 ? ", mirrored)" : ")");
}

void tryNodes(Trial& trial, const DiagnosisSample& sample) {
  constexpr const char* kWhat = "a node's transform was applied to the vertices, but not to the lobes";
  const std::vector<Lobe> lobes = decoded(sample, {});
  const std::vector<Vec3> from = vectorsOf(lobes), to = vectorsOf(sample.truth);
  if (const auto map = linearMapBetween(from, to)) {
    const Affine turn = determinant(*map) > 0 ? nearestRotation(*map) : Affine{};
    trial.add("node-transform", kWhat + mapText(turn), kCureOfNodes, mapped(lobes, turn));
    trial.add("node-transform", kWhat + mapText(*map), kCureOfNodes, mapped(lobes, *map));
  }
  // If a tool joined nodes, each piece of the mesh has its own transform.
  std::map<uint32_t, std::vector<size_t>> pieces;
  for (size_t v = 0; v < sample.pieces.size(); ++v) pieces[sample.pieces[v]].push_back(v);
  if (pieces.size() < 2) return;
  std::vector<Lobe> all = lobes;
  for (const auto& [piece, members] : pieces) {
    std::vector<Lobe> own;
    std::vector<Vec3> own_from, own_to;
    for (const size_t v : members) own.push_back(lobes[v]), own_from.push_back(from[v]), own_to.push_back(to[v]);
    const auto map = members.size() < kLeastOfPiece ? std::nullopt : linearMapBetween(own_from, own_to);
    if (!map) continue;
    own = mapped(own, *map);
    for (size_t i = 0; i < members.size(); ++i) all[members[i]] = own[i];
  }
  trial.add("node-transform", std::string(kWhat) + ", with a different one for each piece of the mesh", kCureOfNodes, all);
}

// The least-squares line y = a·x + b, with outliers weighted less.
std::pair<double, double> lineBetween(const std::vector<double>& x, const std::vector<double>& y) {
  double slope = 1, offset = 0;
  std::vector<double> weights(x.size(), 1.0);
  for (int round = 0; round < kRounds; ++round) {
    double w = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (size_t i = 0; i < x.size(); ++i)
      w += weights[i], sx += weights[i] * x[i], sy += weights[i] * y[i], sxx += weights[i] * x[i] * x[i], sxy += weights[i] * x[i] * y[i];
    const double spread = w * sxx - sx * sx;
    if (!(spread > 1e-12 * w * sxx)) return {1, 0};
    slope = (w * sxy - sx * sy) / spread;
    offset = (sy - slope * sx) / w;
    for (size_t i = 0; i < x.size(); ++i) weights[i] = 1 / (std::fabs(y[i] - slope * x[i] - offset) + 0.01);
  }
  return {slope, offset};
}

void tryRescaled(Trial& trial, const DiagnosisSample& sample) {
  std::vector<LobeUvs> uvs = sample.stored;
  std::string what = "the UVs are scaled:";
  float Vec2::*const component[] = {&Vec2::x, &Vec2::y};
  for (size_t channel = 0; channel < 4; ++channel) {
    Vec2 LobeUvs::*const set = channel < 2 ? &LobeUvs::first : &LobeUvs::second;
    float Vec2::*const part = component[channel % 2];
    std::vector<double> x, y;
    for (size_t v = 0; v < uvs.size(); ++v) {
      const auto from_scene = inverted(sample.to_scene[v]);
      x.push_back(sample.stored[v].*set.*part);
      y.push_back(packLobe(sample.truth[v], from_scene.value_or(Affine{})).*set.*part);
    }
    auto [slope, offset] = lineBetween(x, y);
    if (channel == 3 && slope <= 0) slope = 1, offset = 0;  // thicker where it should be thinner: not a scale
    for (LobeUvs& one : uvs) one.*set.*part = float(slope * (one.*set.*part) + offset);
    static constexpr const char* kNames[] = {"o.x", "o.y", "o.z", "d"};
    what += (channel ? ", " : " ") + std::string(kNames[channel]) + fmt::format(" = {:.3g} stored {:+.3g}", slope, offset);
  }
  std::vector<Lobe> lobes;
  for (size_t v = 0; v < uvs.size(); ++v) {
    const LobeUvs& one = uvs[v];
    const auto unit = normalized({one.first.x, one.first.y, one.second.x});
    const Vec3 o = unit.value_or(Vec3{0, -1, 0});
    lobes.push_back(unpackLobe({{o.x, o.y}, {o.z, std::fabs(one.second.y)}}, sample.to_scene[v]));
  }
  trial.add("rescaled", what, "export UVs unscaled, as float32, or undo the scale in the shader", lobes);
}

// 0 … 2. In double, because the square of a huge d overflows a float.
double lobeError(const Lobe& lobe, const Lobe& truth) {
  double difference = 0, size = 0, true_size = 0;
  for (float Vec3::*const axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    const double a = double(lobe.direction.*axis) * lobe.thickness, b = double(truth.direction.*axis) * truth.thickness;
    difference += (a - b) * (a - b);
    size += a * a;
    true_size += b * b;
  }
  const double sum = std::sqrt(size) + std::sqrt(true_size);
  if (!std::isfinite(sum)) return 2;
  return sum > 0 ? 2 * std::sqrt(difference) / sum : 0;
}

}  // namespace

std::vector<double> vertexErrors(const std::vector<Lobe>& lobes, const DiagnosisSample& sample) {
  std::vector<double> errors;
  const size_t lights = sample.lights.size();
  for (size_t v = 0; v < lobes.size(); ++v) {
    if (sample.true_fit.empty()) {
      errors.push_back(lobeError(lobes[v], sample.truth[v]));
      continue;
    }
    double squares = 0;
    for (size_t i = 0; i < lights; ++i) {
      const double error =
          double(lobeTransmittance(lobes[v], sample.lights[i], sample.shape, sample.extinction)) - sample.true_fit[v * lights + i];
      squares += error * error;
    }
    errors.push_back(std::isfinite(squares) ? std::sqrt(squares / double(lights)) : 1);
  }
  return errors;
}

std::optional<Affine> linearMapBetween(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  std::optional<Affine> map;
  std::vector<double> weights(from.size(), 1.0);
  for (int round = 0; round < kRounds; ++round) {
    Affine cross, own;
    cross.linear = own.linear = {};
    for (size_t v = 0; v < from.size(); ++v) {
      const double size = length(to[v]);
      if (!(size > 0)) continue;
      const float a[3] = {from[v].x, from[v].y, from[v].z}, b[3] = {to[v].x, to[v].y, to[v].z};
      for (size_t r = 0; r < 3; ++r)
        for (size_t c = 0; c < 3; ++c) {
          cross.linear[r][c] += weights[v] * b[r] * a[c] / (size * size);
          own.linear[r][c] += weights[v] * a[r] * a[c] / (size * size);
        }
    }
    const double trace = own.linear[0][0] + own.linear[1][1] + own.linear[2][2];
    const auto inverse = determinant(own) > 1e-9 * trace * trace * trace ? inverted(own) : std::nullopt;
    if (!inverse) return std::nullopt;
    map = compose(cross, *inverse);
    for (size_t v = 0; v < from.size(); ++v)
      weights[v] = 1 / (double(length(to[v] - transformVector(*map, from[v]))) / std::max(double(length(to[v])), 1e-30) + 0.01);
  }
  return map;
}

Affine nearestRotation(const Affine& map) {
  Affine turn = map;
  turn.offset = {0, 0, 0};
  for (int round = 0; round < 30; ++round) {
    const auto inverse = inverted(turn);
    if (!inverse) return {};
    for (size_t r = 0; r < 3; ++r)
      for (size_t c = r; c < 3; ++c) {
        const double rc = turn.linear[r][c], cr = turn.linear[c][r];
        turn.linear[r][c] = (rc + inverse->linear[c][r]) / 2;
        if (r != c) turn.linear[c][r] = (cr + inverse->linear[r][c]) / 2;
      }
  }
  return turn;
}

Diagnosis diagnose(const DiagnosisSample& sample) {
  Trial trial(sample);
  tryChannels(trial);
  tryAxes(trial);
  tryNodes(trial, sample);
  tryRescaled(trial, sample);
  return trial.judged();
}

}  // namespace cloudbake
