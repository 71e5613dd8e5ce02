// The shadow that a mesh cloud casts on other things: its field of inside fractions, swept once along the light.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/affine.h"
#include "core/vec3.h"

namespace cloudbake {

/// The inside fractions of a cloud in its own space.
struct ShadowCaster {
  Vec3 origin;  ///< the centre of the first cell
  float cell_size = 1;
  std::array<int, 3> cells{};
  std::vector<uint8_t> fractions;  ///< 0 … 255, for 0 … 1; x fastest
};

struct ShadowSettings {
  bool are_drawn = true;
  float strength = 1;              ///< of all shadows that clouds cast, 0 … 1
  float softness_degrees = 0.75F;  ///< half the angle over which a shadow's edge is spread, ≥ 0; the sun's disc has 0.27
};

/// The shadow under one light.
class CloudShadow {
 public:
  /// σ per world unit; `to_light` has unit length; `to_world` can be inverted.
  CloudShadow(const ShadowCaster& caster, const Affine& to_world, float extinction, Vec3 to_light, const ShadowSettings& settings);

  /// The share of the light that comes to a point of the world: the mean of exp(−σ ℓ) over a square as wide as the softness is at the
  /// distance of the cloud. Within the heights of the cloud, the part of the way through it that lies before the point counts.
  float shareAt(Vec3 point) const;

 private:
  double integralTo(double u, double v) const;

  Affine to_own_;
  Vec3 origin_;
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

}  // namespace cloudbake
