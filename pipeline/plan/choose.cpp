// With a price λ of an error, each cloud takes the way of the least cost + λ · area · change². That makes the cheapest plan of all that
// have the same sum of errors, and the error falls as λ grows, so that λ is found by bisection (H. Everett, "Generalized Lagrange
// multiplier method", 1963). Files and draws are shared by clouds: ways are left out for as long as all of it becomes cheaper.
#include "pipeline/plan/choose.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/portable_math.h"

namespace cloudbake {

namespace {

constexpr float kSmallest = 8;   // of the first step, pixels
constexpr double kFilled = 0.5;  // of the square of the longest side is covered by a cloud
// No cloud changes more than this many times as much as its picture may.
constexpr double kMostOfOneCloud = 3;

double squareOf(double x) { return x * x; }

struct Weights {
  double vertex = 1, draw = kVerticesPerDraw, byte = 1 / kBytesPerVertex;
  double of(const PlanCost& cost) const { return vertex * cost.vertices + draw * cost.draws + byte * cost.bytes; }
  // The mean counts too, because the worst picture alone does not show that others become cheaper.
  double of(const PlannedWays& plan) const { return (of(plan.cost) + of(plan.mean)) / 2; }
};

// The ways that may be used, by asset.
using Kept = std::vector<std::vector<bool>>;

class Chooser {
 public:
  Chooser(std::span<const std::vector<DrawnWay>> assets, std::span<const ViewCounts> views, double change, double picture_pixels,
          double correction)
      : assets_(assets), views_(views), change_(change) {
    for (size_t step = 0; step < kSizeSteps; ++step) areas_[step] = std::min(picture_pixels, kFilled * squareOf(double(sizeOfStep(step))));
    for (const std::vector<DrawnWay>& ways : assets)
      for (auto& errors = squares_.emplace_back(); const DrawnWay& way : ways) {
        auto& of_way = errors.emplace_back();
        for (size_t step = 0; step < kSizeSteps; ++step)
          of_way[step] = squareOf(correction * double(changeAt(way.changes, sizeOfStep(step))));
      }
  }

  // The cheapest plan with these ways. The finest kept way is drawn at all sizes above those of the others.
  PlannedWays withWays(const Kept& kept, const Weights& weights) const {
    constexpr double kLowest = -20, kHighest = 40;  // of ln λ
    constexpr int kHalvings = 40;
    double low = kLowest, high = kHighest;
    PlannedWays best = at(kept, weights, portableExp(high));
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = (low + high) / 2;
      PlannedWays plan = at(kept, weights, portableExp(middle));
      (plan.change <= change_ ? high : low) = middle;
      if (plan.change <= change_) best = std::move(plan);
    }
    return best;
  }

 private:
  using Steps = std::array<uint8_t, kSizeSteps>;  // the way of each

  // Larger clouds have no coarser ways.
  Steps stepsOf(size_t asset, const std::vector<bool>& kept, const Weights& weights, double price) const {
    const std::vector<DrawnWay>& ways = assets_[asset];
    const double most = squareOf(kMostOfOneCloud * change_);
    const size_t finest = size_t(std::find(kept.begin(), kept.end(), true) - kept.begin());
    Steps steps{};
    size_t coarsest = ways.size() - 1;
    for (size_t step = 0; step < kSizeSteps; ++step) {
      size_t chosen = finest;
      double least = std::numeric_limits<double>::infinity();
      for (size_t way = 0; way <= coarsest; ++way) {
        if (!kept[way] || (way != finest && (squares_[asset][way][step] > most || step + 1 == kSizeSteps))) continue;
        const double cost = weights.vertex * double(ways[way].vertices) + price * areas_[step] * squares_[asset][way][step];
        if (cost < least) least = cost, chosen = way;
      }
      steps[step] = uint8_t(chosen);
      coarsest = std::max(chosen, finest);
    }
    return steps;
  }

  PlannedWays at(const Kept& kept, const Weights& weights, double price) const {
    std::vector<Steps> steps;
    PlannedWays plan;
    for (size_t asset = 0; asset < assets_.size(); ++asset) {
      const Steps& own = steps.emplace_back(stepsOf(asset, kept[asset], weights, price));
      std::vector<int>& sizes = plan.switch_pixels.emplace_back(assets_[asset].size());
      for (size_t step = 0; step + 1 < kSizeSteps; ++step) sizes[own[step]] = int(sizeOfStep(step));
      sizes[own.back()] = kLargestSwitch;
    }
    std::vector<std::vector<bool>> used;
    for (size_t asset = 0; asset < assets_.size(); ++asset) used.emplace_back(assets_[asset].size())[steps[asset].back()] = true;
    for (const ViewCounts& view : views_) {
      double vertices = 0, draws = 0, squares = 0, area = 0;
      for (size_t asset = 0; asset < assets_.size(); ++asset) {
        std::vector<bool> seen(assets_[asset].size());
        for (size_t step = 0; step < kSizeSteps; ++step) {
          const uint32_t count = view[asset][step];
          if (count == 0) continue;
          const size_t way = steps[asset][step];
          vertices += count * double(assets_[asset][way].vertices);
          squares += count * areas_[step] * squares_[asset][way][step];
          area += count * areas_[step];
          if (!seen[way]) seen[way] = used[asset][way] = true, ++draws;
        }
      }
      plan.cost.vertices = std::max(plan.cost.vertices, vertices);
      plan.cost.draws = std::max(plan.cost.draws, draws);
      plan.mean.vertices += vertices / double(views_.size());
      plan.mean.draws += draws / double(views_.size());
      plan.changes.push_back(area > 0 ? std::sqrt(squares / area) : 0);
      plan.change = std::max(plan.change, plan.changes.back());
    }
    for (size_t asset = 0; asset < assets_.size(); ++asset)
      for (size_t way = 0; way < assets_[asset].size(); ++way)
        if (used[asset][way])
          plan.cost.bytes += double(assets_[asset][way].bytes);
        else
          plan.switch_pixels[asset][way] = 0;
    plan.mean.bytes = plan.cost.bytes;
    return plan;
  }

  std::span<const std::vector<DrawnWay>> assets_;
  std::span<const ViewCounts> views_;
  double change_;
  std::array<double, kSizeSteps> areas_{};                            // pixels that a cloud covers
  std::vector<std::vector<std::array<double, kSizeSteps>>> squares_;  // of changes, by asset, way and step
};

PlannedWays cheapest(const Chooser& chooser, std::span<const std::vector<DrawnWay>> assets, double change, const Weights& weights) {
  Kept kept;
  for (const std::vector<DrawnWay>& ways : assets) kept.emplace_back(ways.size(), true);
  PlannedWays best = chooser.withWays(kept, weights);
  for (;;) {
    std::optional<PlannedWays> better;
    Kept with_less;
    const auto consider = [&](size_t asset, std::vector<bool> ways) {
      const size_t finest = size_t(std::find(ways.begin(), ways.end(), true) - ways.begin());
      if (assets[asset][finest].is_picture) return;
      Kept less = kept;
      less[asset] = std::move(ways);
      PlannedWays plan = chooser.withWays(less, weights);
      if (plan.change > change || weights.of(plan) >= weights.of(better ? *better : best)) return;
      better = std::move(plan), with_less = std::move(less);
    };
    // Without a way, or with this way alone.
    for (size_t asset = 0; asset < assets.size(); ++asset) {
      const auto count = std::count(kept[asset].begin(), kept[asset].end(), true);
      for (size_t way = 0; way < assets[asset].size(); ++way) {
        if (!kept[asset][way] || count == 1) continue;
        std::vector<bool> without = kept[asset], alone(assets[asset].size());
        without[way] = false, alone[way] = true;
        consider(asset, std::move(without));
        if (count > 2) consider(asset, std::move(alone));
      }
    }
    if (!better) return best;
    best = std::move(*better), kept = std::move(with_less);
  }
}

}  // namespace

float sizeOfStep(size_t step) {
  constexpr float kQuarters[] = {1, 1.18920712F, 1.41421356F, 1.68179283F};  // powers of 2
  if (step + 1 == kSizeSteps) return std::numeric_limits<float>::infinity();
  return std::floor(kSmallest * kQuarters[step % 4] * float(1U << step / 4));
}

size_t stepOfSize(float pixels) {
  size_t step = 0;
  while (sizeOfStep(step) < pixels) ++step;
  return step;
}

std::vector<size_t> usedWays(std::span<const int> switch_pixels) {
  std::vector<size_t> used;
  for (size_t way = 0; way < switch_pixels.size(); ++way)
    if (switch_pixels[way] > 0) used.push_back(way);
  return used;
}

size_t wayAt(std::span<const int> switch_pixels, float pixels) {
  const std::vector<size_t> used = usedWays(switch_pixels);
  for (size_t i = used.size(); i-- > 1;)
    if (pixels <= float(switch_pixels[used[i]])) return used[i];
  return used.front();
}

PlanCost costOfFull(std::span<const std::vector<DrawnWay>> assets, std::span<const ViewCounts> views) {
  PlanCost cost;
  std::vector<bool> used(assets.size());
  for (const ViewCounts& view : views) {
    double vertices = 0, draws = 0;
    for (size_t asset = 0; asset < assets.size(); ++asset) {
      uint64_t count = 0;
      for (const uint32_t one : view[asset]) count += one;
      vertices += double(count) * double(assets[asset].front().vertices);
      draws += count > 0 ? 1 : 0;
      used[asset] = used[asset] || count > 0;
    }
    cost.vertices = std::max(cost.vertices, vertices);
    cost.draws = std::max(cost.draws, draws);
  }
  for (size_t asset = 0; asset < assets.size(); ++asset)
    if (used[asset]) cost.bytes += double(assets[asset].front().bytes);
  return cost;
}

PlannedWays chooseWays(std::span<const std::vector<DrawnWay>> assets, std::span<const ViewCounts> views, const PlanBudget& budget,
                       double picture_pixels, double correction) {
  constexpr int kRounds = 16;
  const Chooser chooser(assets, views, budget.change, picture_pixels, correction);
  Weights weights;
  PlannedWays plan = cheapest(chooser, assets, budget.change, weights);
  // What exceeds its limit counts more and more, until the limit holds.
  for (int round = 0; round < kRounds; ++round) {
    bool exceeds = false;
    const auto press = [&](const std::optional<double>& limit, double cost, double& weight) {
      if (limit && cost > *limit) weight *= 3, exceeds = true;
    };
    press(budget.vertices, plan.cost.vertices, weights.vertex);
    press(budget.bytes, plan.cost.bytes, weights.byte);
    press(budget.draws, plan.cost.draws, weights.draw);
    if (!exceeds) break;
    plan = cheapest(chooser, assets, budget.change, weights);
  }
  return plan;
}

}  // namespace cloudbake
