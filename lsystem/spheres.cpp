// The steps 1-8 of the L-system notes, section 7:
//   1. r = size (width/thickness)^pw (2/(gen+2))^pg growth lerp(rmin, rmax, u4)
//   2. r *= 1 - k smoothstep(base, y_max, y)          3. centre += (2 u5 - 1) jitter r, per axis
//   4. below the base: depth × squash                 5. above the ceiling: excess height × 0.3
//   6. y >= base + flat r                             7. remove hidden spheres: |ci-cj| + 0.95 ri <= rj, largest first
//      then keep at most `count` of them, the largest, and fit them into the domain
//   8. parts: union-find over |ci-cj| < ri + rj - 0.1 min(ri, rj); `connect` pulls parts in to an overlap of 0.25 min(ri, rj)
// Neighbours are found in a tree of boxes (lsystem/puff_tree.h).
#include "lsystem/spheres.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "core/portable_math.h"
#include "lsystem/domain.h"
#include "lsystem/keys.h"
#include "lsystem/puff_tree.h"

namespace cloudbake {

namespace {

void checkSettings(const TurtlePath& path, const SphereSettings& s) {
  const auto require = [&](bool holds, const char* message) {
    if (!holds) throw InputError(path.file, message);
  };
  require(!s.size || (*s.size > 0 && std::isfinite(*s.size)), "the spheres' size must be positive");
  require(s.leaf_size > 0 && std::isfinite(s.leaf_size), "leaf_size must be positive");
  require(std::isfinite(s.width_power) && std::isfinite(s.generation_power), "width_power and generation_power must be finite");
  require(s.radius_min > 0 && s.radius_max >= s.radius_min && std::isfinite(s.radius_max),
          "radius_min must be positive, and radius_max must not be smaller");
  require(s.top_falloff >= 0 && s.top_falloff <= 1, "top_falloff must be from 0 to 1");
  require(s.jitter >= 0 && std::isfinite(s.jitter), "jitter must be 0 or more");
  require(s.squash >= 0 && s.squash <= 1, "squash must be from 0 to 1");
  require(!s.count || *s.count > 0, "count must be 1 or more");
  require(!s.domain || (s.domain->x >= 0 && s.domain->y >= 0 && s.domain->z >= 0 && s.domain->x + s.domain->y + s.domain->z > 0 &&
                        std::isfinite(s.domain->x + s.domain->y + s.domain->z)),
          "domain must be three lengths [width, height, depth], where 0 means that the length follows from the others");
  require(!s.flat || s.base, "flat needs base: set base to the height of the flat bottom");
  require(s.squash == 1 || s.base, "squash needs base: set base to the height below which the cloud is squashed");
}

// --- Steps 1 to 6 ---

// The first factors of a point's radius: size, width and generation. An attribute a("pscale",r) replaces all three.
double plainRadius(const TurtlePath& path, const TurtlePoint& point, const SphereSettings& s) {
  if (const TurtleAttribute* pscale = findAttribute(path, point, "pscale")) return pscale->values[0];
  return s.size.value_or(path.step) * portablePow(point.width / path.thickness, s.width_power) *
         portablePow(2.0 / (point.gen + 2), s.generation_power);
}

double smoothStep(double low, double high, double x) {
  if (!(high > low)) return 0;
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

Puff shapePuff(const TurtlePoint& point, double radius, Span span, const SphereSettings& s) {
  // Further points of a module (sections of a segment) use further draws. Its start and the end of its first section share theirs.
  const uint64_t n = uint64_t(std::max(point.section, 1) - 1);
  Puff puff{point.position, radius * point.growth};
  puff.radius *= s.radius_min + (s.radius_max - s.radius_min) * drawUniform(point.key, DrawChannel::kRadius, n);
  puff.radius *= 1 - s.top_falloff * smoothStep(span.low, span.high, point.position.y);
  double* axes[3] = {&puff.center.x, &puff.center.y, &puff.center.z};
  for (uint64_t axis = 0; axis < 3; ++axis)
    *axes[axis] += (2 * drawUniform(point.key, DrawChannel::kJitter, 3 * n + axis) - 1) * s.jitter * puff.radius;

  double& y = puff.center.y;
  if (s.base && y < *s.base) y = *s.base + (y - *s.base) * s.squash;
  if (s.ceiling && y > *s.ceiling) y = *s.ceiling + (y - *s.ceiling) * 0.3;
  if (s.flat) y = std::max(y, *s.base + *s.flat * puff.radius);
  return puff;
}

std::vector<Puff> collectPuffs(const TurtlePath& path, const SphereSettings& s, Warnings& warnings, GrowthSummary& summary) {
  const bool points = s.emit != Emit::kLeaves, leaves = s.emit != Emit::kPoints;
  const uint64_t count = (points ? path.points.size() : 0) + (leaves ? path.leaves.size() : 0);
  if (count > s.max_spheres)
    throw InputError(path.file, std::to_string(count) + " spheres exceed the limit of " + std::to_string(s.max_spheres) +
                                    ": use fewer generations or segments, or raise max_spheres");
  Span span;
  const auto extend = [&](const TurtlePoint& point) {
    span = {std::min(span.low, point.position.y), std::max(span.high, point.position.y)};
  };
  if (points) std::for_each(path.points.begin(), path.points.end(), extend);
  if (leaves) std::for_each(path.leaves.begin(), path.leaves.end(), [&](const TurtleLeaf& leaf) { extend(leaf.point); });
  if (s.base) span.low = *s.base;

  std::vector<Puff> puffs;
  puffs.reserve(count);
  uint64_t without_radius = 0;
  const auto add = [&](const TurtlePoint& point, double radius) {
    const Puff puff = shapePuff(point, radius, span, s);
    if (!std::isfinite(float(puff.radius)) || !isFinite(toFloat(puff.center)))
      throw InputError(path.file, "a sphere's radius or centre is not a finite number: check widths, pscale and the powers");
    if (float(puff.radius) > 0)
      puffs.push_back(puff);
    else
      ++without_radius;
  };
  if (points)
    for (const TurtlePoint& point : path.points) add(point, plainRadius(path, point, s));
  if (leaves)
    for (const TurtleLeaf& leaf : path.leaves) add(leaf.point, s.leaf_size * leaf.scale);
  warnings.add(WarningKind::kGrammar, path.file + ": a sphere of radius 0 or less was left out", without_radius);
  summary.without_radius = without_radius;
  return puffs;
}

double distanceBetween(const Puff& a, const Puff& b) { return length(a.center - b.center); }

constexpr double kRounding = 1e-12;  // relative tolerance for comparisons with bounds

// --- Step 7 ---

// Indices, the largest sphere first. Spheres of equal size keep their order.
std::vector<uint32_t> bySize(const std::vector<Puff>& puffs) {
  std::vector<uint32_t> order(puffs.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return puffs[a].radius > puffs[b].radius; });
  return order;
}

std::vector<Puff> withoutHidden(const std::vector<Puff>& puffs) {
  const std::vector<uint32_t> order = bySize(puffs);
  PuffTree tree = makePuffTree(puffs);
  std::vector<bool> kept(puffs.size(), false);
  for (const uint32_t i : order) {
    const double depth = 0.95 * puffs[i].radius;
    const bool hidden = searchTree(
        tree, puffs[i].center, [&](double radius) { return radius * (1 + kRounding) - depth; },
        [&](uint32_t j) { return kept[j] && distanceBetween(puffs[i], puffs[j]) + depth <= puffs[j].radius; });
    if (hidden) continue;
    kept[i] = true;
    addToTree(tree, puffs[i], i);
  }
  std::vector<Puff> visible;
  for (size_t i = 0; i < puffs.size(); ++i)
    if (kept[i]) visible.push_back(puffs[i]);
  return visible;
}

std::vector<Puff> largest(const std::vector<Puff>& puffs, uint64_t count) {
  std::vector<uint32_t> order = bySize(puffs);
  order.resize(size_t(std::min<uint64_t>(count, order.size())));
  std::sort(order.begin(), order.end());
  std::vector<Puff> kept;
  for (const uint32_t i : order) kept.push_back(puffs[i]);
  return kept;
}

// --- Step 8 ---

uint32_t findRoot(std::vector<uint32_t>& parents, uint32_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

constexpr uint32_t kMixed = 0xFFFFFFFF;

// Joins sphere i with all spheres under a node that it overlaps. `uniform` holds a member of the part that all spheres of a node belong
// to, or kMixed. A node of the sphere's own part is skipped, so that dense clouds do not take longer.
void joinOverlapping(const PuffTree& tree, const std::vector<Puff>& puffs, uint32_t i, PuffNode node, std::vector<uint32_t>& parents,
                     std::vector<uint32_t>& uniform) {
  const double ri = puffs[i].radius, largest = tree.hulls[node.index].radius;
  const double reach = ri + largest - 0.1 * std::min(ri, largest);
  if (squaredDistance(tree.hulls[node.index], puffs[i].center) > reach * reach * (1 + kRounding)) return;
  uint32_t& common = uniform[node.index];
  if (common != kMixed && findRoot(parents, common) == findRoot(parents, i)) return;
  if (node.isLeaf()) {
    bool same = true;
    for (uint32_t slot = node.begin; slot < node.end; ++slot) {
      const uint32_t j = tree.order[slot];
      const double rj = puffs[j].radius;
      if (distanceBetween(puffs[i], puffs[j]) < ri + rj - 0.1 * std::min(ri, rj)) {
        const uint32_t a = findRoot(parents, i), b = findRoot(parents, j);
        parents[std::max(a, b)] = std::min(a, b);
      }
      same = same && findRoot(parents, j) == findRoot(parents, tree.order[node.begin]);
    }
    if (same) common = tree.order[node.begin];
    return;
  }
  for (const PuffNode child : {node.left(), node.right()}) joinOverlapping(tree, puffs, i, child, parents, uniform);
  const uint32_t left = uniform[node.left().index], right = uniform[node.right().index];
  if (left != kMixed && right != kMixed && findRoot(parents, left) == findRoot(parents, right)) common = left;
}

std::vector<int> partsOf(const std::vector<Puff>& puffs) {
  std::vector<uint32_t> parents(puffs.size());
  std::iota(parents.begin(), parents.end(), 0U);
  PuffTree tree = makePuffTree(puffs);
  for (uint32_t i = 0; i < puffs.size(); ++i) addToTree(tree, puffs[i], i);
  std::vector<uint32_t> uniform(tree.hulls.size(), kMixed);
  for (const uint32_t i : tree.order) joinOverlapping(tree, puffs, i, rootOf(tree), parents, uniform);

  // Number the parts in order of first appearance. The root is the smallest index of its part.
  std::vector<int> parts(puffs.size());
  int count = 0;
  for (uint32_t i = 0; i < puffs.size(); ++i) {
    const uint32_t root = findRoot(parents, i);
    parts[i] = root == i ? count++ : parts[root];
  }
  return parts;
}

int countParts(const std::vector<int>& parts) { return parts.empty() ? 0 : *std::max_element(parts.begin(), parts.end()) + 1; }

// The spheres joined so far, in the order of joining.
struct Joined {
  PuffTree tree;
  std::vector<uint32_t> ranks;  // 1, 2, … per sphere; 0 = not joined
  uint32_t count = 0, laid_out = 0;
};

void join(Joined& joined, const std::vector<Puff>& puffs, const std::vector<uint32_t>& part) {
  for (const uint32_t i : part) {
    joined.ranks[i] = ++joined.count;
    addToTree(joined.tree, puffs[i], i);
  }
  // Parts that were pulled have left the places that the tree was laid out for, so lay it out again from time to time.
  if (joined.count < 2 * joined.laid_out) return;
  joined.tree = makePuffTree(puffs);
  joined.laid_out = joined.count;
  for (uint32_t i = 0; i < puffs.size(); ++i)
    if (joined.ranks[i] > 0) addToTree(joined.tree, puffs[i], i);
}

// The pair of spheres with the smallest gap between one part and the joined spheres. Of equal gaps the first is taken, in the order of the
// part, then of joining.
struct Gap {
  double size = INFINITY;
  uint32_t from = 0, to = 0;
};

Gap nearestGap(const std::vector<Puff>& puffs, const std::vector<uint32_t>& part, const Joined& joined) {
  Gap best;
  for (const uint32_t i : part)
    searchTree(
        joined.tree, puffs[i].center,
        [&](double radius) { return best.size + puffs[i].radius + radius + kRounding * (std::fabs(best.size) + puffs[i].radius + radius); },
        [&](uint32_t j) {
          if (joined.ranks[j] == 0) return false;
          const double gap = distanceBetween(puffs[i], puffs[j]) - puffs[i].radius - puffs[j].radius;
          const bool earlier = gap == best.size && best.from == i && joined.ranks[j] < joined.ranks[best.to];
          if (gap < best.size || earlier) best = {gap, i, j};
          return false;
        });
  return best;
}

// Joins all parts to the one of largest volume, larger parts first. A part is moved as a whole along its smallest gap.
void connectParts(std::vector<Puff>& puffs, const std::vector<int>& parts, const std::string& file) {
  if (puffs.size() > 100'000)
    throw InputError(
        file, "connect joins at most 100000 spheres, not " + std::to_string(puffs.size()) + ": use fewer generations, or connect = false");
  std::vector<std::vector<uint32_t>> members(size_t(countParts(parts)));
  if (members.size() > 10'000)
    throw InputError(file, "connect joins at most 10000 parts, not " + std::to_string(members.size()) +
                               ": make the spheres larger, or set connect = false");
  std::vector<double> volumes(members.size(), 0);
  for (uint32_t i = 0; i < puffs.size(); ++i) {
    members[size_t(parts[i])].push_back(i);
    volumes[size_t(parts[i])] += puffs[i].radius * puffs[i].radius * puffs[i].radius;
  }
  std::vector<size_t> order(members.size());
  std::iota(order.begin(), order.end(), size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return volumes[a] > volumes[b]; });

  Joined joined{makePuffTree(puffs), std::vector<uint32_t>(puffs.size(), 0)};
  join(joined, puffs, members[order[0]]);
  for (size_t k = 1; k < order.size(); ++k) {
    const std::vector<uint32_t>& part = members[order[k]];
    const Gap gap = nearestGap(puffs, part, joined);
    const Puff &from = puffs[gap.from], &to = puffs[gap.to];
    const double distance = distanceBetween(from, to), wanted = from.radius + to.radius - 0.25 * std::min(from.radius, to.radius);
    const Double3 shift = distance > wanted ? (to.center - from.center) * ((distance - wanted) / distance) : Double3{};
    for (const uint32_t i : part) puffs[i].center = puffs[i].center + shift;
    join(joined, puffs, part);
  }
}

}  // namespace

std::vector<int> findParts(const std::vector<Sphere>& spheres) {
  std::vector<Puff> puffs;
  for (const Sphere& s : spheres) puffs.push_back({{s.center.x, s.center.y, s.center.z}, s.radius});
  return partsOf(puffs);
}

std::vector<Sphere> spheresFromPath(const TurtlePath& path, const SphereSettings& settings, Warnings& warnings, GrowthSummary* summary) {
  checkSettings(path, settings);
  GrowthSummary untold;
  GrowthSummary& told = summary != nullptr ? *summary : untold;
  told.points = path.points.size();
  told.leaves = path.leaves.size();
  const std::vector<Puff> emitted = collectPuffs(path, settings, warnings, told);
  std::vector<Puff> puffs = withoutHidden(emitted);
  told.hidden = emitted.size() - puffs.size();
  if (puffs.empty())
    throw InputError(
        path.file, "the L-system gives no sphere: let it reach F or H (points) or J, K, M (leaves) within its generations, and check emit");
  if (settings.count && *settings.count < puffs.size()) {
    told.over_count = puffs.size() - *settings.count;
    puffs = largest(puffs, *settings.count);
  }
  const Domain domain{settings.domain.value_or(Double3{}), settings.floor, settings.base == settings.floor ? settings.flat : std::nullopt};
  if (settings.domain) fitDomain(puffs, domain);

  const std::vector<int> parts = partsOf(puffs);
  told.parts = countParts(parts);
  if (told.parts > 1 && settings.connect.value_or(false)) {
    connectParts(puffs, parts, path.file);
    told.connected = true;
    if (settings.domain) shrinkIntoDomain(puffs, domain);
  } else if (told.parts > 1 && !settings.connect) {
    warnings.add(WarningKind::kGrammar,
                 path.file + ": the cloud is in " + std::to_string(told.parts) +
                     " parts: make the spheres larger, set connect = true, or set connect = false if this is intended");
  }
  std::vector<Sphere> spheres;
  spheres.reserve(puffs.size());
  for (const Puff& puff : puffs) spheres.push_back({toFloat(puff.center), float(puff.radius)});
  for (const Sphere& sphere : spheres)
    if (!isFinite(sphere.center) || !(sphere.radius > 0) || !std::isfinite(sphere.radius))
      throw InputError(path.file, "after fitting into the domain, a sphere is beyond the range of float32: choose sides nearer to 1");
  return spheres;
}

}  // namespace cloudbake
