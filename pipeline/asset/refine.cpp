// The loop of adaptive finite elements: estimate, mark, refine. The estimate of an edge is taken at its middle, where the lobe that an
// engine blends is compared with a lobe baked there; an edge has the weight of its triangles' areas. In every round the worst edges that
// together have half of the whole error are split (W. Dörfler, "A convergent adaptive algorithm for Poisson's equation", SIAM J. Numer.
// Anal. 1996). The middles of split edges are vertices of the next round, so every point is baked once.
#include "pipeline/asset/refine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "bake/lobe/directions.h"
#include "bake/mesh/refine_mesh.h"
#include "core/distinct_positions.h"
#include "core/error.h"
#include "core/lobe_lighting.h"
#include "core/parallel.h"
#include "core/surface_points.h"
#include "pipeline/fields/fields.h"
#include "pipeline/lobes/lobes.h"
#include "pipeline/lobes/parameters.h"
#include "pipeline/sources/sculpt.h"

namespace cloudbake {

namespace {

constexpr int kLights = 128, kVolumeLights = 64;
constexpr double kMarkedShare = 0.5;  // of the whole error, in one round
constexpr double kAutoShare = 0.1;    // that blending may add to the error of own lobes
constexpr double kLeastProgress = 0.95;
constexpr int kStandstill = 4;           // rounds without this progress
constexpr double kMostTurn = 2.0 / 255;  // radians: what a picture of 8 bits hardly shows
constexpr int kTurnRounds = 8;

// The sculpt while it is refined: all parts as one mesh in scene space, and what they were.
struct Refinement {
  const Sculpt& sculpt;
  SurfaceMesh mesh;
  std::vector<uint32_t> part_of;                   // vertex → part
  std::vector<Vec3> local{};                       // positions in the part's own space
  std::vector<std::array<uint32_t, 2>> parents{};  // of the new vertices

  explicit Refinement(const Cloud& cloud) : sculpt(cloud.sculpt), mesh(cloud.surface), part_of(partsOfVertices(sculpt)) {
    for (const SculptPart& part : sculpt.parts) local.insert(local.end(), part.positions.begin(), part.positions.end());
  }
  // A sum is the same in either order.
  Vec3 localMiddle(uint32_t a, uint32_t b) const { return 0.5F * (local[a] + local[b]); }
  std::optional<Vec3> middleOf(uint32_t a, uint32_t b) const {
    const SculptPart& part = sculpt.parts[part_of[a]];
    if (!part.fixed.empty()) return std::nullopt;
    return transformPoint(part.to_scene, localMiddle(a, b));
  }
  void split(const EdgeTable& table, const std::vector<bool>& marked) {
    for (const auto& pair : splitEdges(mesh, table, marked)) {
      parents.push_back(pair);
      part_of.push_back(part_of[pair[0]]);
      local.push_back(localMiddle(pair[0], pair[1]));
    }
  }
};

// Bakes points, each position once.
class PointBaker {
 public:
  PointBaker(const Cloud& cloud, const Settings& settings)
      : lobe_(settings.lobe), parameters_(parametersFor(cloud, settings)), is_auto_(*settings.mesh.refine == 0) {
    Warnings not_told;  // the bake reports them
    field_ = buildField(cloud, fieldSettings(settings.field, parameters_), parameters_.bake.method, not_told);
    const bool volume = lobe_.fit_to_volume;
    lights_ = fitLights(lobe_.fit ? lobe_.sun_arc : std::nullopt, volume, volume ? kVolumeLights : kLights);
    directions_ = bothSenses(lights_.axes);
    if (lights_.weights.empty()) lights_.weights.assign(directions_.size(), 1);
  }

  uint32_t add(Vec3 position, Vec3 normal) {
    const uint32_t index = places_.add(position);
    if (index == normals_.size()) normals_.push_back(normal);
    return index;
  }
  Vec3 normalBetween(uint32_t a, uint32_t b) const { return directionBetween(normals_[a], normals_[b]); }
  // Bakes what was added since the last call. The first call decides k and b, if they are searched.
  void bake() {
    const auto first = ptrdiff_t(lobes_.size());
    SurfaceMesh points{{places_.positions.begin() + first, places_.positions.end()}, {normals_.begin() + first, normals_.end()}, {}};
    if (points.positions.empty()) return;
    for (Vec3& normal : points.normals) normal = normalized(normal).value_or(normal);
    Warnings not_told;
    const ShapedLobes baked = lobesAt(points, field_, lobe_, parameters_, not_told);
    lobes_.insert(lobes_.end(), baked.lobes.begin(), baked.lobes.end());
    parameters_.shape = baked.shape;
    lobe_.fit_exponent = lobe_.fit_bias = false;
    if (!is_auto_) return;
    const std::vector<float> light = lightAt({points.positions, points.normals}, lights_.axes, field_, lobe_, parameters_);
    light_.insert(light_.end(), light.begin(), light.end());
  }

  // Means of squared differences of T at the middle of an edge, over the lights.
  struct Errors {
    double blending = 0;          // of the blended lobe against the own
    double blended = 0, own = 0;  // of either against what it is to show; 0 unless the target is auto
  };
  Errors errorsAt(uint32_t low, uint32_t high, uint32_t middle) const {
    const Lobe blend = blendedLobe({{low, high, high}, {0.5F, 0.5F, 0}}, lobes_);
    Errors sum;
    double weights = 0;
    for (size_t i = 0; i < directions_.size(); ++i) {
      const auto shown = [&](const Lobe& lobe) {
        return double(lobeTransmittance(lobe, directions_[i], parameters_.shape, parameters_.extinction));
      };
      const double weight = lights_.weights[i], blended = shown(blend), own = shown(lobes_[middle]);
      sum.blending += weight * (blended - own) * (blended - own);
      weights += weight;
      if (!is_auto_) continue;
      const double truth = light_[middle * directions_.size() + i];
      sum.blended += weight * (blended - truth) * (blended - truth);
      sum.own += weight * (own - truth) * (own - truth);
    }
    return {sum.blending / weights, sum.blended / weights, sum.own / weights};
  }

 private:
  LobeSettings lobe_;
  BakeParameters parameters_;
  bool is_auto_;
  IntegrationField field_;
  LightSet lights_;
  std::vector<Vec3> directions_;
  DistinctPositions places_;
  std::vector<Vec3> normals_;  // as blended, not of unit length
  std::vector<Lobe> lobes_;
  std::vector<float> light_;  // #points × #directions
};

// The errors of a mesh.
struct Estimate {
  std::vector<double> excess;  // per edge, with its weight: what a split may win; 0 if it cannot be split
  double blending = 0;         // rms of T, over all edges
  double sum = 0;              // of the excess, negative where blending does better than own lobes
  double allowed = 0;          // for this sum
};

Estimate estimated(const Refinement& now, const EdgeTable& table, PointBaker& baker, double target) {
  for (size_t v = 0; v < now.mesh.positions.size(); ++v) baker.add(now.mesh.positions[v], now.mesh.normals[v]);
  std::vector<std::array<uint32_t, 3>> points;  // of each edge: its ends and its middle
  for (const SplittableEdge& edge : table.edges) {
    const uint32_t low = baker.add(edge.ends[0], {}), high = baker.add(edge.ends[1], {});
    points.push_back({low, high, baker.add(edge.middle, baker.normalBetween(low, high))});
  }
  baker.bake();
  std::vector<PointBaker::Errors> errors(table.edges.size());
  parallelFor(errors.size(), [&](size_t i) { errors[i] = baker.errorsAt(points[i][0], points[i][1], points[i][2]); });

  Estimate estimate{std::vector<double>(table.edges.size())};
  double all_area = 0, area = 0, own = 0, blending = 0;
  for (size_t e = 0; e < errors.size(); ++e) {
    const double weight = table.edges[e].area, excess = target > 0 ? errors[e].blending : errors[e].blended - errors[e].own;
    all_area += weight;
    blending += weight * errors[e].blending;
    if (!table.edges[e].can_split) continue;
    estimate.excess[e] = std::max(0.0, weight * excess);
    estimate.sum += weight * excess;
    own += weight * errors[e].own;
    area += weight;
  }
  estimate.blending = all_area > 0 ? std::sqrt(blending / all_area) : 0;
  estimate.allowed = target > 0 ? target * target * area : ((1 + kAutoShare) * (1 + kAutoShare) - 1) * own;
  return estimate;
}

// By how many radians an engine turns the normal in the middle of an edge otherwise than it did before the edge was split off, if that is
// more than a picture shows. It blends normals of unit length, which on the sculpt's own edges were shorter in the middle than at the ends.
std::vector<double> turnsOfNormals(const Refinement& now, const EdgeTable& table) {
  std::vector<double> turns(table.edges.size());
  for (size_t f = 0; f < table.of_triangle.size(); ++f)
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t edge = table.of_triangle[f][i], a = now.mesh.triangles[f][i], b = now.mesh.triangles[f][(i + 1) % 3];
      if (edge == EdgeTable::kNone || !table.edges[edge].can_split || now.sculpt.parts[now.part_of[a]].normals.empty()) continue;
      const Vec3 from = now.mesh.normals[a], to = now.mesh.normals[b];
      const auto before = normalized(from + to), units = normalized(normalized(from).value_or(from) + normalized(to).value_or(to));
      const double turn = before && units ? angleDegrees(*before, *units) * (kPi / 180) : 0;
      if (turn > kMostTurn) turns[edge] = std::max(turns[edge], turn);
    }
  return turns;
}

// The worst edges that together have a share of the whole excess, with the longest edges that their triangles need, within the budget.
std::vector<bool> markedEdges(const Refinement& now, const EdgeTable& table, const std::vector<double>& excess, double share,
                              size_t budget) {
  std::vector<uint32_t> worst;
  for (uint32_t e = 0; e < table.edges.size(); ++e)
    if (excess[e] > 0) worst.push_back(e);
  std::sort(worst.begin(), worst.end(), [&](uint32_t a, uint32_t b) { return std::pair(-excess[a], a) < std::pair(-excess[b], b); });
  double left = 0;
  for (const uint32_t e : worst) left += share * excess[e];
  size_t count = 0;
  while (count < worst.size() && left > 0) left -= excess[worst[count++]];

  const auto markFirst = [&](size_t first) {
    std::vector<bool> marked(table.edges.size(), false);
    for (size_t i = 0; i < first; ++i) marked[worst[i]] = true;
    markLongest(table, marked);
    return marked;
  };
  const auto fits = [&](size_t first) { return now.mesh.positions.size() + verticesToAdd(now.mesh, table, markFirst(first)) <= budget; };
  if (fits(count)) return markFirst(count);
  size_t fit = 0;  // `fit` of them fit, `count` do not
  while (count - fit > 1) {
    const size_t half = (fit + count) / 2;
    (fits(half) ? fit : count) = half;
  }
  return markFirst(fit);
}

template <class Value, class Middle>
void appendMiddles(std::vector<Value>& values, const SculptPart& part, const Middle& middle) {
  if (values.empty()) return;
  for (const auto& [a, b] : part.midpoints) values.push_back(middle(values[a], values[b]));
}

// Extends a part by its midpoints, whose numbers are known.
void extendPart(SculptPart& part) {
  const auto uv = [](Vec2 a, Vec2 b) { return Vec2{0.5F * (a.x + b.x), 0.5F * (a.y + b.y)}; };
  appendMiddles(part.positions, part, [](Vec3 a, Vec3 b) { return 0.5F * (a + b); });
  appendMiddles(part.uvs, part, uv);
  for (std::vector<Vec2>& set : part.more_uvs) appendMiddles(set, part, uv);
  appendMiddles(part.colors, part, [](std::array<float, 4> a, std::array<float, 4> b) {
    for (size_t i = 0; i < 4; ++i) a[i] = 0.5F * (a[i] + b[i]);
    return a;
  });
  appendMiddles(part.normals, part, directionBetween);
  if (part.normals.empty()) return;
  for (Vec3& normal : std::span(part.normals).last(part.midpoints.size())) normal = normalized(normal).value_or(normal);
}

// Gives the parts their new vertices and triangles. A part's new vertices come after its others.
void returnToParts(const Refinement& now, Sculpt& sculpt) {
  std::vector<uint32_t> index(now.part_of.size());  // in the part
  std::vector<uint32_t> count(sculpt.parts.size(), 0);
  for (size_t v = 0; v < index.size(); ++v) index[v] = count[now.part_of[v]]++;
  const size_t old = index.size() - now.parents.size();
  for (size_t i = 0; i < now.parents.size(); ++i)
    sculpt.parts[now.part_of[old + i]].midpoints.push_back({index[now.parents[i][0]], index[now.parents[i][1]]});
  for (SculptPart& part : sculpt.parts)
    if (!part.midpoints.empty()) part.triangles.clear(), extendPart(part);
  for (const Triangle& t : now.mesh.triangles) {
    SculptPart& part = sculpt.parts[now.part_of[t[0]]];
    if (part.midpoints.empty()) continue;
    Triangle own{index[t[0]], index[t[1]], index[t[2]]};
    if (part.isMirrored(own)) std::swap(own[1], own[2]);
    part.triangles.push_back(own);
  }
}

void countFixedParts(const Sculpt& sculpt, Warnings& warnings) {
  for (const SculptPart& part : sculpt.parts)
    if (!part.fixed.empty())
      warnings.add(WarningKind::kPartNotRefined, "'" + part.name + "' " + part.fixed + ": --refine leaves it as it is");
}

}  // namespace

void refineCloud(Cloud& cloud, const Settings& settings, BakeReport& report, Stopwatch& watch) {
  if (!settings.mesh.refine) return;
  const double target = *settings.mesh.refine;
  const size_t budget = settings.mesh.vertices.value_or(kMostRefinedVertices);
  countFixedParts(cloud.sculpt, report.warnings);
  PointBaker baker = namingFile(report.input, [&] { return PointBaker(cloud, settings); });
  Refinement now(cloud);
  RefineSummary& summary = report.refine.emplace();
  summary.vertices_before = now.mesh.positions.size();
  double least = INFINITY;
  for (int stood_still = 0, turned = 0;;) {
    const EdgeTable table = edgesOf(now.mesh, [&](uint32_t a, uint32_t b) { return now.middleOf(a, b); });
    const Estimate estimate = estimated(now, table, baker, target);
    summary.blending_after = estimate.blending;
    if (now.parents.empty()) summary.blending_before = estimate.blending;
    const bool is_enough = estimate.sum <= estimate.allowed;
    const std::vector<bool> marked = is_enough ? markedEdges(now, table, turnsOfNormals(now, table), 1, budget)
                                               : markedEdges(now, table, estimate.excess, kMarkedShare, budget);
    const bool full = std::find(marked.begin(), marked.end(), true) == marked.end();
    if (is_enough && (full || turned++ == kTurnRounds)) break;
    stood_still = !is_enough && estimate.sum > kLeastProgress * least ? stood_still + 1 : 0;
    least = std::min(least, estimate.sum);
    if (full || stood_still == kStandstill) {
      report.warnings.add(WarningKind::kRefineTarget,
                          fmt::format("--refine did not reach its target: blending adds {:.3g} to the rms of T with {} vertices; ",
                                      estimate.blending, now.mesh.positions.size()) +
                              (full ? "allow more --vertices" : "the lobes vary too much between neighbouring points: use more --rays"));
      break;
    }
    now.split(table, marked);
  }
  summary.vertices_after = now.mesh.positions.size();
  if (!now.parents.empty()) {
    returnToParts(now, cloud.sculpt);
    takePartsAnew(cloud, settings.mesh, report);
  }
  watch.lap(report.seconds, "refine");
}

}  // namespace cloudbake
