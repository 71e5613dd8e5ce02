// The shadows that mesh clouds cast on other things: their fields of inside fractions, each swept once along the light.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/affine.h"
#include "core/keys.h"
#include "core/vec3.h"

namespace cloudbake {

/// The inside fractions of a cloud in its own space.
struct ShadowCaster {
  Vec3 origin;  ///< the centre of the first cell
  float cell_size = 1;
  std::array<int, 3> cells{};
  std::vector<uint8_t> fractions;  ///< 0 … 255, for 0 … 1; x fastest
};

/// The same field with cells that are so many times larger.
ShadowCaster coarserCaster(const ShadowCaster& caster, int factor);

/// How mesh clouds shadow each other: not at all, each by its own shadow, or all by one grid (shade_grid.h), which they also shadow other
/// things by.
enum class CloudShade : uint8_t { kNone, kEach, kGrid };

struct ShadowSettings {
  bool are_drawn = true;
  CloudShade cloud_shade = CloudShade::kEach;
  float strength = 1;              ///< of all shadows that clouds cast, 0 … 1
  float softness_degrees = 0.75F;  ///< half the angle over which a shadow's edge is spread, ≥ 0; the sun's disc has 0.27
};
/// Its keys in a scene file.
const Keys<ShadowSettings>& shadowKeys();

/// Where a shadow may be: beyond `from` along the light, inside a rectangle across it that grows with the way. World units.
struct ShadowReach {
  double from = INFINITY;                                                     ///< along the light, away from it
  std::array<double, 2> low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};  ///< of the rectangle at `from`
  std::array<double, 2> growth{0, 0};                                         ///< of each of its sides per unit of the way
  void add(const ShadowReach& other);
};

/// The shadow under one light.
class CloudShadow {
 public:
  /// σ per world unit; `to_light` has unit length; `to_world` can be inverted.
  CloudShadow(const ShadowCaster& caster, const Affine& to_world, float extinction, Vec3 to_light, const ShadowSettings& settings);

  /// The share of the light that comes to a point of the world: the mean of exp(−σ ℓ) over a square as wide as the softness is at the
  /// distance of the cloud. Within the heights of the cloud, the part of the way through it that lies before the point counts.
  float shareAt(Vec3 point) const;
  /// Outside of it shareAt is 1. `across` and `aside` are at right angles to each other and to the light that the shadow was made for.
  ShadowReach reach(Vec3 to_light, Vec3 across, Vec3 aside) const;

  /// Where the way of the light through a point of the world meets the plane of the shadow, and how far from the point, towards the light,
  /// it enters the heights of the cloud and leaves them.
  struct Way {
    double u = 0, v = 0, enters = 0, leaves = 0;
  };
  Way wayThrough(const std::array<double, 3>& point) const;
  /// The mean of what the whole cloud absorbs of the light over a rectangle of the plane around a place. Half of a side is at least half a
  /// cell.
  double absorbedOver(double u, double v, double half_u, double half_v) const;
  /// Of the box of the field in the world.
  std::array<std::array<double, 3>, 8> corners() const;

 private:
  double integralTo(double u, double v) const;

  Affine to_own_, to_world_;
  Vec3 origin_;
  std::array<int, 3> cells_;
  double towards_light_;  // cells along the axis per world unit towards the light
  float cell_size_;
  size_t axis_, across_, aside_;       // the axis that the light follows most, and the other two
  double slope_across_, slope_aside_;  // cells per cell along the axis
  double per_slice_;                   // world units of the way from one slice to the next
  double spread_;                      // cells by which an edge is spread per slice of distance
  bool light_is_above_;                // on the side of higher slices
  double low_ = 0, high_ = 0;          // slices between which there is cloud
  int left_ = 0, bottom_ = 0, width_ = 0, height_ = 0;
  std::vector<double> sums_;  // of what is absorbed in the cells of the plane before a row and a column
};

/// The shadows of many clouds under one light. Points ask only those that may reach them.
class CloudShadows {
 public:
  static constexpr size_t kNobody = std::numeric_limits<size_t>::max();
  CloudShadows() = default;
  /// owners[i] is whose shadow shadows[i] is.
  CloudShadows(std::vector<CloudShadow> shadows, std::vector<size_t> owners, Vec3 to_light);
  /// Whether there is a shadow that is not of `owner`.
  bool anyExceptOf(size_t owner) const;
  /// Multiplies the share of each point by what all shadows let through to it, in their order, but those of `owner`.
  void pass(std::span<const Vec3> points, std::span<float> shares, size_t owner = kNobody) const;

 private:
  struct Node {  // of a tree; the last node comes first to be asked
    ShadowReach reach;
    uint32_t first = 0, count = 0;  // of `order_`; no leaf if the count is 0
    std::array<uint32_t, 2> children{};
  };
  uint32_t build(std::span<const ShadowReach> reaches, uint32_t first, uint32_t count);
  void passTogether(std::span<const Vec3> points, std::span<float> shares, size_t owner) const;

  std::vector<CloudShadow> shadows_;
  std::vector<size_t> owners_;
  Vec3 to_light_, across_, aside_;
  std::vector<uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace cloudbake
