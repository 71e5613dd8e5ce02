// Parts of the target of a fit to the volume: depths along a view, and the phase function. volume_target.cpp and volume_lattice.cpp use
// them.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "bake/lobe/light_kernels.h"
#include "bake/lobe/volume_target.h"
#include "core/types.h"

namespace cloudbake {

/// Where the light is taken along a view: the nodes of Gauss's quadrature over the opacity, which is the mean over the σ of the fit. Every
/// depth is a length of cloud, in world units.
class DepthNodes {
 public:
  explicit DepthNodes(const VolumeTargetSettings& settings);
  size_t count() const { return parts_.size(); }
  size_t sigmas() const { return extinctions_.size(); }
  /// The length of cloud behind which nothing is seen at any σ.
  float enough() const { return depths_.back(); }

  /// The nodes of a view through `length` of cloud: count() depths, and count() × sigmas() weights, which are the exact parts of the
  /// opacity times `weight`. Returns false if there is no cloud.
  bool divide(float length, float weight, std::span<float> depths, std::span<float> weights) const;
  /// The same from a table: weights within 0.003 · `weight`, depths within a twentieth of themselves.
  bool divideQuickly(float length, float weight, std::span<float> depths, std::span<float> weights) const;

 private:
  // A part of each node's weight, from the end of the part before to `end`, and the node within it.
  struct Part {
    float node, end;
  };
  static std::vector<Part> gaussParts(int count);
  float opacity(float depth) const;
  float depthAt(float opacity) const;

  static constexpr size_t kEntries = 128;
  std::vector<float> extinctions_;
  std::vector<Part> parts_;
  std::array<float, kEntries> depths_{}, opacities_{};  // a table of F(τ) = mean over σ of 1 − exp(−σ_v τ)
  std::vector<float> divided_;                          // per entry's depth its nodes, then their weights
};

/// The value at a place between eight values, the lowest of which is low[0]; rows and planes are so many values apart.
inline float trilinear(const float* low, size_t row, size_t plane, float x, float y, float z) {
  const auto face = [&](const float* f) {
    const float first = f[0] + x * (f[1] - f[0]), second = f[row] + x * (f[row + 1] - f[row]);
    return first + y * (second - first);
  };
  const float near = face(low), far = face(low + plane);
  return near + z * (far - near);
}

/// Whether some view sees a point from outside, and whether there is cloud behind it.
struct SeenPoint {
  bool is_seen = false, has_cloud = false;
};
/// Calls add(v, |n·v|), which says whether view v looks into cloud, for every view with sees(v). If none does, calls it for the views from
/// the side of the normal, as if nothing were in front of the point. A point without a normal is seen equally from all sides.
template <class Sees, class Add>
SeenPoint addViews(std::span<const Vec3> views, Vec3 normal, const Sees& sees, const Add& add) {
  const bool has_normal = dot(normal, normal) > 0;
  bool has_cloud = false;
  const auto addThose = [&](const auto& is_chosen) {
    for (size_t v = 0; v < views.size(); ++v) {
      const float facing = has_normal ? dot(normal, views[v]) : -1;
      if (facing != 0 && is_chosen(v, facing)) has_cloud = add(v, std::fabs(facing)) || has_cloud;
    }
  };
  addThose([&](size_t v, float) { return sees(v); });
  const bool is_seen = has_cloud;
  if (!has_cloud) addThose([&](size_t, float facing) { return facing < 0; });
  return {is_seen, has_cloud};
}

/// With less cloud than this towards the eye a point is seen: its own cell is partly filled. World units.
inline float clearLength(const CoverageField& field) { return float(field.frame.voxel_size); }

inline Vec3 normalOf(const BakePoints& points, size_t point) { return points.normals.empty() ? Vec3{} : points.normals[point]; }

/// The phase function of Henyey and Greenstein times 4π.
float phaseOf(float asymmetry, float cosine);

/// S(σℓ) of all σ as sums of exponentials.
LightTerms lightTerms(std::span<const float> extinctions, const OctaveSettings& octaves);

}  // namespace cloudbake
