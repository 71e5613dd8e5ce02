// Fields of clouds: many copies of a few meshes, scattered in a box, which drift with the wind and wrap around in the box.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/affine.h"
#include "core/keys.h"
#include "core/types.h"

namespace cloudbake {

/// How clouds are scattered. The distance to the horizon is that from the middle of the box, in half boxes along x and z: it is 0 in the
/// middle, and 1 on the ellipse that touches the box's sides and beyond.
struct ScatterSettings {
  Vec3 low, high;              ///< the box of the clouds' origins, world units; low < high along x and z, low ≤ high along y
  uint32_t count = 100;        ///< places that are tried, in rows of a grid, ≥ 1
  float probability = 1;       ///< of a cloud at a place, 0 … 1
  float jitter = 1;            ///< 0: in the middle of its cell; 1: anywhere in it
  float turn_degrees = 180;    ///< about y, at most, to either side
  Vec2 size{1, 1};             ///< factor of the size, from … to
  float minimum_distance = 0;  ///< between the places of two clouds, world units; a place that is nearer to an earlier cloud stays empty
  Vec3 drift;                  ///< world units per second; 0 along an axis along which the box has no length
  float fade = 0.1F;           ///< clouds shrink to nothing in this share of the box before each side through which they drift; 0 … 0.5
  float horizon_scale = 1;     ///< factor of the size at the horizon, ≥ 0
  float horizon_lower = 0;     ///< world units by which clouds are lower at the horizon
  uint64_t seed = 1;
};
/// Its keys in a scene file, without those of the box.
const Keys<ScatterSettings>& fieldKeys();

/// A cloud of a field, where it is at time 0.
struct ScatteredCloud {
  Vec3 place;              ///< in the box
  float turn_degrees = 0;  ///< about y
  float size = 1;          ///< factor
  uint32_t mesh = 0;       ///< number of its weight
};

/// Scatters clouds. A mesh is taken with a probability of its weight's share of the sum. Weights are > 0. The clouds are the same on any
/// machine, and a cloud does not change with others, but that a place too near to an earlier cloud stays empty.
std::vector<ScatteredCloud> scatterClouds(const ScatterSettings& settings, std::span<const double> weights);

/// The least factor by which fade and horizon shrink a cloud, so that its place can always be inverted. Nobody sees such a cloud.
inline constexpr double kLeastShrink = 1e-3;

/// Where a cloud is at a time: its mesh after `base`, then its size, turn and place. It moves without a jump but for a wrap around, where
/// it is shrunk to kLeastShrink if the settings have a fade.
Affine placeAt(const ScatterSettings& settings, const ScatteredCloud& cloud, const Affine& base, double seconds);

/// A box that clouds never leave whose meshes are within a radius of their origins.
Box fieldBox(const ScatterSettings& settings, float radius);

/// Whether a field after so many seconds is what it was.
bool repeatsAfter(const ScatterSettings& settings, double seconds);

}  // namespace cloudbake
