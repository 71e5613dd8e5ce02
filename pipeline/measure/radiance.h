// The judge of lobes that are fitted to a volume: the light that a march through the volume shows behind each vertex. It shares no code
// with the target of the fit (bake/lobe/volume_target.h).
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/figures.h"
#include "core/types.h"
#include "pipeline/lobes/lobes.h"

namespace cloudbake {

/// The light that the eye sees through vertices, over all views that see them from outside. A view counts by the area that it sees times
/// the opacity.
struct VolumeTruth {
  std::vector<size_t> seen;         ///< of the points, those that a view sees and that have cloud behind them
  std::vector<double> weights;      ///< #seen: the sum of the weights of their views
  std::vector<float> mean, square;  ///< #seen × #lights: the weighted mean over the views of the radiance C and of C²
  size_t views = 0;                 ///< pairs of a point and a view
};

struct VolumeTruthSettings {
  VolumeLight light;
  int views = 96;   ///< directions of view over the sphere
  int steps = 128;  ///< of a march, per longest side of the cloud
};

/// The truth for lights from unit directions, for each extinction, σ towards the light per world unit. One march per cell of the field and
/// light, which serves all extinctions, and one per pair of a point and a view.
std::vector<VolumeTruth> marchVolume(const BakePoints& points, const CoverageField& field, std::span<const Vec3> to_lights,
                                     std::span<const float> extinctions, const VolumeTruthSettings& settings);

/// The error of a shading, which gives the light of seen[i] from direction j. No shading that does not know the view comes below `limit`.
RadianceError compareRadiance(const VolumeTruth& truth, size_t lights, const std::function<double(size_t i, size_t j)>& shading);

/// The errors of all shadings of a cloud against its volume, at one σ.
struct RadianceFigures {
  double extinction = 0;
  size_t vertices = 0, pairs = 0, suns = 0;
  std::vector<std::pair<std::string, RadianceError>> shadings;
};

/// For every σ of a fit to a volume: the published lobe, exp(−σℓ) at the vertices, lobes fitted to that, `baked` (fitted to the volume),
/// and spherical harmonics of it, all under suns above the horizon or on the arc of the fit.
std::vector<RadianceFigures> measureRadiance(const Cloud& cloud, const IntegrationField& field, const BakedLobes& baked,
                                             const Settings& settings, const BakeParameters& parameters);

}  // namespace cloudbake
