// The target of a fit to the volume from a coarse lattice. For many points this takes far less time than a sweep to every sample of them,
// and the light inside a cloud is smooth: it changes over about a mean free path.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "bake/lobe/volume_target.h"
#include "core/types.h"

namespace cloudbake {

/// ℓ towards all lights and along all views, at places that are half an optical depth of the largest σ apart, or a cell if that is more.
struct LengthLattice {
  std::array<int, 3> counts{};     ///< places per axis
  float spacing = 1;               ///< cells of the field
  Vec3 first;                      ///< the lowest place, cells of the field
  size_t lights = 0, stride = 0;   ///< values of a place, and the distance to those of the next one: whole lanes
  std::vector<float> to_lights;    ///< #places × stride, world units, x fastest
  std::vector<float> along_views;  ///< #views × #places
  size_t places() const { return size_t(counts[0]) * size_t(counts[1]) * size_t(counts[2]); }
};

/// The lattice for so many samples, or nothing if it has more places than that or would fill the memory. Views and lights are both senses
/// of their axes.
std::optional<LengthLattice> lengthLattice(const SweepField& field, std::span<const Vec3> view_axes, std::span<const Vec3> light_axes,
                                           const VolumeTargetSettings& settings, size_t samples);

/// R of points from the lattice: #points × #σ × #lights. `along_views` holds ℓ of every view, each #points long.
struct LatticeTarget {
  std::vector<float> radiance;
  std::vector<char> is_seen, has_cloud;  ///< per point. Without cloud there is no R.
};
LatticeTarget latticeTarget(const BakePoints& points, std::span<const float> along_views, std::span<const Vec3> views,
                            std::span<const Vec3> lights, const CoverageField& field, const LengthLattice& lattice,
                            const VolumeTargetSettings& settings);

}  // namespace cloudbake
