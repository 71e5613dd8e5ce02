// Least squares fit of the lobe formula (core/lobe_lighting.h) to exp(−σℓ), per vertex, over directions j and extinctions i:
//
//   E(o, d) = Σᵢ Σⱼ wⱼ rᵢⱼ²,   rᵢⱼ = Tᵢⱼ − exp(−σᵢ ℓⱼ),   Tᵢⱼ = exp(−σᵢ sⱼ),   sⱼ = max(0, hⱼ^k d + b),   hⱼ = max(0, lⱼ·o/2 + 1/2)
//
// by Levenberg–Marquardt (Levenberg 1944, Marquardt 1963) with the damping of H. B. Nielsen, "Damping Parameter in Marquardt's
// Method", IMM-REP-1999-05: (H + μI) x = −g, H = Σ w ∇T∇Tᵀ, g = Σ w r∇T. The parameters are two angles u, v on the tangent plane of o
// and w = log d. All are without unit, so μI needs no scaling. With ∇Tᵢⱼ = −σᵢ Tᵢⱼ ∇sⱼ and, where s > 0,
//
//   ∂s/∂u = k/2 · h^(k−1) d · l·t_u,   ∂s/∂v likewise,   ∂s/∂w = h^k d,
//
// the sum over i reduces to two numbers per direction: pull = w Σᵢ −σᵢTr and stiffness = w Σᵢ σᵢ²T². Internally all lengths are optical
// depths at the first σ.
#include "bake/lobe/fit_lobe.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "bake/lobe/fit_kernels.h"
#include "core/exp_log.h"
#include "core/parallel.h"
#include "core/portable_math.h"

namespace cloudbake {

namespace {

constexpr size_t kLanes = 8, kVerticesPerTask = 64;
constexpr double kLeastGain = 1e-3;    // relative reduction of the error, per step
constexpr double kLeastError = 1e-12;  // mean square of T: an rms of a millionth is as good as 0
constexpr double kLongestStep = 1;     // radians, or log d
constexpr double kFirstDamping = 1e-2;
constexpr float kLeastExponent = 0.5F, kMostExponent = 12, kLastStep = 0.125F;  // k
constexpr float kLeastBias = -1, kMostBias = 1, kBiasStep = 0.08F;              // b, optical depths

using Row = std::vector<float>;

// Data shared by all vertices, in rows of whole lanes. Padding in the last lanes has weight 0.
struct Lights {
  FitLights rows() const { return {x.data(), y.data(), z.data(), weight.data(), count}; }
  size_t directions = 0, count = 0;
  Row x, y, z, weight;
  Row extinctions;  // relative to the first
  float unit = 1;   // the first σ: a length in world units × unit is an optical depth
  LobeShape shape;  // bias as an optical depth
};

// One vertex: its lengths in a row of whole lanes, #σ × count targets, and a buffer for evaluations.
struct Vertex {
  Row lengths, targets, scratch;
};

Lights makeLights(const FitSamples& samples, const FitSettings& settings) {
  const auto& [directions, lengths, weights, targets] = samples;
  Lights lights;
  lights.unit = settings.extinctions[0];
  lights.shape = {settings.shape.exponent, settings.shape.bias * lights.unit};
  for (const float extinction : settings.extinctions) lights.extinctions.push_back(extinction / lights.unit);

  // Weights that sum to 1 over all directions and extinctions
  double sum = 0;
  for (size_t j = 0; j < directions.size(); ++j) sum += weights.empty() ? 1 : weights[j];
  const double scale = sum > 0 ? 1 / (sum * double(settings.extinctions.size())) : 0;

  lights.directions = directions.size();
  lights.count = (directions.size() + kLanes - 1) / kLanes * kLanes;
  for (Row* row : {&lights.x, &lights.y, &lights.z, &lights.weight}) row->resize(lights.count);
  for (size_t j = 0; j < directions.size(); ++j) {
    lights.x[j] = directions[j].x, lights.y[j] = directions[j].y, lights.z[j] = directions[j].z;
    lights.weight[j] = float(scale * (weights.empty() ? 1 : weights[j]));
  }
  return lights;
}

Vertex makeVertex(const Lights& lights) {
  return {Row(lights.count), Row(lights.extinctions.size() * lights.count), Row((4 + lights.extinctions.size()) * lights.count)};
}

// The samples of one vertex: N lengths, or #σ × N targets.
struct Sampled {
  std::span<const float> lengths, targets;
};

void setTargets(const Lights& lights, const Sampled& row, Vertex& v) {
  if (row.targets.empty()) {
    std::copy(row.lengths.begin(), row.lengths.end(), v.lengths.begin());
    transmittanceRows(v.lengths.data(), lights.count, lights.unit, lights.extinctions, v.targets.data());
    return;
  }
  for (size_t i = 0; i < lights.extinctions.size(); ++i)
    std::copy_n(row.targets.begin() + ptrdiff_t(i * lights.directions), lights.directions, v.targets.begin() + ptrdiff_t(i * lights.count));
}

// E, g and H for a lobe whose density is an optical depth.
FitSums evaluate(const Lights& lights, const Lobe& lobe, Vertex& vertex) {
  const auto [tangent, bitangent] = frameAround(lobe.direction);
  return sumFit(lights.rows(), {lobe.direction, tangent, bitangent, lights.shape.exponent, lights.shape.bias, lobe.thickness},
                lights.extinctions, vertex.targets.data(), vertex.scratch.data());
}

struct Step {
  double u = 0, v = 0, w = 0;  // x
  double promised = 0;         // how much the linear model reduces E: −2gᵀx − xᵀHx
};

// Solves (H + μI) x = −g by LDLᵀ and shortens x to kLongestStep. H has no negative eigenvalue, so μ > 0 keeps the pivots positive.
Step dampedStep(const FitSums& n, double damping) {
  const auto& [uu, uv, uw, vv, vw, ww] = n.hessian;
  const auto& [gu, gv, gw] = n.gradient;
  const double p0 = uu + damping, l1 = uv / p0, l2 = uw / p0;
  const double p1 = vv + damping - l1 * uv, l3 = (vw - l2 * uv) / p1, p2 = ww + damping - l2 * uw - l3 * l3 * p1;
  const double y1 = l1 * gu - gv, y2 = l2 * gu - gw - l3 * y1;
  Step x;
  x.w = y2 / p2, x.v = y1 / p1 - l3 * x.w, x.u = -gu / p0 - l1 * x.v - l2 * x.w;

  // xᵀHx = −gᵀx − μ xᵀx holds for the whole step; for a fraction c of it, xᵀHx is c² times that
  const double squares = x.u * x.u + x.v * x.v + x.w * x.w, slope = gu * x.u + gv * x.v + gw * x.w;
  const double c = std::min(1.0, kLongestStep / std::sqrt(squares));
  return {c * x.u, c * x.v, c * x.w, -2 * c * slope + c * c * (slope + damping * squares)};
}

Lobe moved(const Lobe& lobe, const Step& step) {
  const auto [tangent, bitangent] = frameAround(lobe.direction);
  const auto direction = normalized(lobe.direction + float(step.u) * tangent + float(step.v) * bitangent);
  return {direction.value_or(lobe.direction), lobe.thickness * expMinus(-float(step.w))};
}

struct Evaluated {
  Lobe lobe;
  FitSums sums;
};

// Descends until a step gains or promises too little.
Evaluated descend(const Lights& lights, const Evaluated& start, int iterations, Vertex& v) {
  auto [lobe, here] = start;
  double damping = kFirstDamping * std::max({here.hessian[0], here.hessian[3], here.hessian[5]}), growth = 2;
  for (int i = 0; i < iterations && here.error > kLeastError && damping > 0; ++i) {
    const Step step = dampedStep(here, damping);
    const double least = kLeastGain * here.error;
    const Lobe next = moved(lobe, step);
    const FitSums there = evaluate(lights, next, v);
    const double gain = here.error - there.error;
    if (gain > 0) {
      lobe = next, here = there;
      const double surprise = 2 * gain / step.promised - 1;
      damping *= std::max(1.0 / 3, 1 - surprise * surprise * surprise), growth = 2;
    } else {
      damping *= growth, growth *= 2;
    }
    if (!(std::max(gain, step.promised) > least)) break;
  }
  return {lobe, here};
}

// The optical depth of the longest way to a light, or of the way that would give the least light.
float longestDepth(const Lights& lights, const Sampled& row, const Vertex& v) {
  float longest = 0, least = 1;
  for (size_t j = 0; j < lights.directions; ++j) {
    if (!(lights.weight[j] > 0)) continue;
    if (row.targets.empty()) longest = std::max(longest, row.lengths[j]);
    least = std::min(least, v.targets[j]);
  }
  return std::min(row.targets.empty() ? longest * lights.unit : minusLog(std::max(least, 1e-37F)), 87.0F);
}

// Another start, from the targets alone, which is near the fit even if the mean lobe is undefined. It points away from the light, along
// Σ w (T̄ − T) l, and its density makes the mean of s over the half sphere around o the longest depth; the mean of h^k there is about
// 2/(k+1).
Lobe shadedLobe(const Lights& lights, float longest, Vec3 fallback, const Vertex& v) {
  double mean = 0, sum = 0, x = 0, y = 0, z = 0;
  for (size_t j = 0; j < lights.directions; ++j) mean += double(lights.weight[j]) * v.targets[j], sum += lights.weight[j];
  mean /= sum;
  for (size_t j = 0; j < lights.directions; ++j) {
    const double weight = lights.weight[j] * (mean - v.targets[j]);
    x += weight * lights.x[j], y += weight * lights.y[j], z += weight * lights.z[j];
  }
  const Vec3 direction = normalized({float(x), float(y), float(z)}).value_or(fallback);
  return {direction, longest * 0.5F * (1 + lights.shape.exponent)};
}

// A lobe as it is stored, and its error.
struct Fitted {
  Lobe lobe;
  double error = 0;
};

Fitted fitVertex(const Lights& lights, const Lobe& start, const Sampled& row, int iterations, Vertex& v) {
  setTargets(lights, row, v);
  const auto evaluated = [&](const Lobe& lobe) { return Evaluated{lobe, evaluate(lights, lobe, v)}; };
  const Evaluated mean = evaluated({start.direction, start.thickness * lights.unit}),
                  shaded = evaluated(shadedLobe(lights, longestDepth(lights, row, v), start.direction, v));
  const Evaluated best = descend(lights, mean.sums.error <= shaded.sums.error ? mean : shaded, iterations, v);

  // Compare the errors with d as it is stored, in world units
  const Lobe stored{best.lobe.direction, best.lobe.thickness / lights.unit};
  const float thickness = stored.thickness * lights.unit;
  const double error = thickness == best.lobe.thickness ? best.sums.error : evaluate(lights, {stored.direction, thickness}, v).error;
  return error < mean.sums.error ? Fitted{stored, error} : Fitted{start, mean.sums.error};
}

Sampled rowOf(const FitSamples& samples, size_t vertex, size_t sigmas) {
  const size_t directions = samples.directions.size();
  if (samples.targets.empty()) return {samples.lengths.subspan(vertex * directions, directions), {}};
  return {{}, samples.targets.subspan(vertex * sigmas * directions, sigmas * directions)};
}

// Calls use(v, fitted) for every vertex, from several threads.
template <class Use>
void fitEach(std::span<const Lobe> starts, const FitSamples& samples, const FitSettings& settings, const Use& use) {
  const Lights lights = makeLights(samples, settings);
  parallelBlocks(starts.size(), kVerticesPerTask, [&](size_t begin, size_t end) {
    Vertex vertex = makeVertex(lights);
    for (size_t v = begin; v < end; ++v)
      use(v, fitVertex(lights, starts[v], rowOf(samples, v, lights.extinctions.size()), settings.iterations, vertex));
  });
}

// Replaces the starts by the fitted lobes and returns the sum of their errors.
double refit(std::vector<Lobe>& lobes, const FitSamples& samples, const FitSettings& settings) {
  std::vector<double> errors(lobes.size());
  fitEach(lobes, samples, settings, [&](size_t v, const Fitted& fitted) { lobes[v] = fitted.lobe, errors[v] = fitted.error; });
  return std::accumulate(errors.begin(), errors.end(), 0.0);
}

}  // namespace

double lobeError(const Lobe& lobe, const FitSamples& samples, const FitSettings& settings) {
  const Lights lights = makeLights(samples, settings);
  Vertex v = makeVertex(lights);
  setTargets(lights, {samples.lengths, samples.targets}, v);
  return evaluate(lights, {lobe.direction, lobe.thickness * lights.unit}, v).error;
}

std::vector<Lobe> fitLobes(std::span<const Lobe> starts, const FitSamples& samples, const FitSettings& settings) {
  std::vector<Lobe> lobes(starts.size());
  const LoopProgress::Counted counted;
  fitEach(starts, samples, settings, [&](size_t v, const Fitted& fitted) { lobes[v] = fitted.lobe; });
  return lobes;
}

LobeShape fitShape(std::span<const Lobe> starts, const FitSamples& samples, const FitSettings& settings, const ShapeSearch& search) {
  // The vertices used for the search
  const size_t count = std::min(starts.size(), search.vertices);
  std::vector<Lobe> lobes;
  std::vector<float> lengths, targets;
  for (size_t i = 0; i < count; ++i) {
    const size_t v = i * starts.size() / count;
    const Sampled row = rowOf(samples, v, settings.extinctions.size());
    lobes.push_back(starts[v]);
    lengths.insert(lengths.end(), row.lengths.begin(), row.lengths.end());
    targets.insert(targets.end(), row.targets.begin(), row.targets.end());
  }
  const FitSamples judged{samples.directions, lengths, samples.weights, targets};

  // Compass search: move to the best neighbour, or else halve the step. Two neighbours are diagonal, because a smaller k can compensate for
  // a smaller b. Each candidate starts from the lobes of the centre.
  const auto depth = float(1 / std::sqrt(double(settings.extinctions.front()) * settings.extinctions.back()));
  FitSettings best = settings;
  double least = refit(lobes, judged, best);
  for (float step = search.first_step; step >= kLastStep;) {
    const FitSettings center = best;
    const std::vector<Lobe> center_lobes = lobes;
    for (const auto& [side_k, side_b] : {Vec2{-1, 0}, Vec2{1, 0}, Vec2{0, -1}, Vec2{0, 1}, Vec2{-1, -1}, Vec2{1, 1}}) {
      FitSettings next = center;
      next.shape.exponent += side_k * step;
      next.shape.bias += side_b * step * kBiasStep * depth;
      const auto& [k, b] = next.shape;
      const bool may_move_k = search.exponent && k >= kLeastExponent && k <= kMostExponent;
      const bool may_move_b = search.bias && b >= kLeastBias * depth && b <= kMostBias * depth;
      if ((side_k != 0 && !may_move_k) || (side_b != 0 && !may_move_b)) continue;
      std::vector<Lobe> fitted = center_lobes;
      if (const double error = refit(fitted, judged, next); error < least) least = error, best = next, lobes = fitted;
    }
    if (best.shape.exponent == center.shape.exponent && best.shape.bias == center.shape.bias) step /= 2;
  }
  return best.shape;
}

std::vector<float> extinctionSteps(float low, float high) {
  int intervals = 0;
  for (float reach = low; reach < high; reach *= 2) ++intervals;
  std::vector<float> steps{low};
  for (int i = 1; i < intervals; ++i) steps.push_back(low * portablePow(high / low, float(i) / float(intervals)));
  if (intervals > 0) steps.push_back(high);
  return steps;
}

}  // namespace cloudbake
