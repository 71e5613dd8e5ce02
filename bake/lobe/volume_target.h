// The light that a vertex shows when the volume behind it is rendered: the light that reaches the eye through the vertex comes from inside,
// through about one mean free path of cloud. Lobes and harmonics are fitted to this by --fit-to volume (docs/lobe_math.md).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "bake/lobe/sliced_field.h"
#include "core/types.h"

namespace cloudbake {

struct VolumeTargetSettings {
  std::vector<float> extinctions;  ///< σ towards the light, per world unit, > 0; one or more
  VolumeLight light;
  double ray_length = 0;  ///< L, world units
  int views = 32;         ///< directions of view over the sphere, even
  int depths = 6;         ///< samples of the light along a view, ≥ 1
  /// Whether ℓ may be interpolated on a lattice if that is less work. R is then off by about 0.01 (docs/lobe_math.md).
  bool may_interpolate = false;
};

struct VolumeTarget {
  std::vector<float> radiance;  ///< R: #points × #σ × 2 #axes, row by row, towards both senses of every axis
  uint64_t unseen = 0;          ///< points that no view sees from outside
};

/// R(x, l) = Σ_v w C(x, v, l) / Σ_v w over the views v that see x from outside, with w = |n·v| (1 − exp(−τ_v(∞))) and
/// C(x, v, l) = ∫ σ_v exp(−τ_v(t)) p(v·l) S(σ ℓ(x + t v, l)) dt / (1 − exp(−τ_v(∞))).
/// If no view sees x, those from the side of its normal count as if nothing were in front of it. If there is no cloud behind x either, R is
/// S(σ ℓ(x, l)). Points without a normal are seen equally from all sides. The result is the same for any number of threads and any CPU.
VolumeTarget volumeTarget(const BakePoints& points, std::span<const Vec3> axes, const SweepField& field,
                          const VolumeTargetSettings& settings);

struct LengthLattice;
/// The same for many points in blocks: the lattice, if one is worth it for so many points, is made once. It refers to axes and field.
class VolumeTargets {
 public:
  VolumeTargets(size_t points, std::span<const Vec3> axes, const SweepField& field, VolumeTargetSettings settings);
  ~VolumeTargets();
  VolumeTarget at(const BakePoints& points) const;

 private:
  std::span<const Vec3> axes_;
  const SweepField& field_;
  VolumeTargetSettings settings_;
  std::vector<Vec3> view_axes_;
  std::unique_ptr<const LengthLattice> lattice_;
};

/// S(σℓ) of lengths in world units: the light that arrives after all scatterings.
std::vector<float> scatteredLight(std::span<const float> lengths, float extinction, const OctaveSettings& octaves);

}  // namespace cloudbake
