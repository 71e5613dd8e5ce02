#include "pipeline/lobes/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bake/lobe/directions.h"
#include "bake/mesh/mesh_topology.h"
#include "core/error.h"
#include "pipeline/lobes/target.h"

namespace cloudbake {

LobeShape defaultMeanShape(const SurfaceMesh& surface) {
  const DefaultShape shape = defaultShape(false);
  return {shape.exponent, shape.relative_bias * boundingBox(surface).longestSide()};
}

void requireUsableSize(const Box& box) {
  if (box.empty()) return;
  const float longest = box.longestSide();
  const std::string range = fmt::format("sizes from {:g} to {:g} can be baked", kSmallestShape, kLargestShape);
  if (longest > 0 && !(longest >= kSmallestShape && longest <= kLargestShape))
    throw InputError("", fmt::format("the shape is {:g} units long, but {}: scale it, or give another --units", longest, range));
  float farthest = 0;
  for (const Vec3& corner : {box.low, box.high})
    for (const float at : {corner.x, corner.y, corner.z}) farthest = std::fmax(farthest, std::fabs(at));
  if (!(farthest <= kLargestShape))
    throw InputError(
        "", fmt::format("a coordinate is {:g}, but they may be up to {:g}: move the shape to the origin", farthest, kLargestShape));
}

namespace {

// The lattice of a grown cloud's integration field: coarser than the surface's if that one is finer than the directions can show, and than
// the smallest sphere needs. docs/benchmarks.md has the errors of both. The field of a sculpt is what --voxels is for, and a volume has a
// lattice of its own.
std::optional<int> enoughVoxels(const Cloud& cloud, const FieldSettings& field, int rays) {
  constexpr double kVoxelsPerRootOfDirections = 20, kVoxelsPerRadius = 3;
  if (field.bake_voxels || cloud.spheres.empty()) return field.bake_voxels;
  const double longest = boundingBox(cloud.surface).longestSide();
  float radius = cloud.spheres.front().radius;
  for (const Sphere& sphere : cloud.spheres) radius = std::min(radius, sphere.radius);
  const double enough = std::ceil(std::max(kVoxelsPerRootOfDirections * std::sqrt(double(rays)), kVoxelsPerRadius * longest / radius));
  const double surface = field.voxel_size ? longest / *field.voxel_size : field.voxels;
  return enough < surface ? std::optional(int(enough)) : std::nullopt;
}

}  // namespace

BakeParameters parametersFor(const Cloud& cloud, const Settings& settings) {
  const LobeSettings& lobe = settings.lobe;
  const Box box = boundingBox(cloud.surface);
  const float longest = box.longestSide();
  BakeParameters parameters;
  parameters.bake = lobe.bake;
  if (!parameters.bake.ray_length) parameters.bake.ray_length = box.diagonal();

  const DefaultShape shape = defaultShape(lobe.fit);
  parameters.shape = {lobe.exponent.value_or(shape.exponent), lobe.bias.value_or(Length{shape.relative_bias, true}).resolve(longest)};
  const float extinction = kDefaultOpticalDepth / longest;
  const auto [low, high] =
      lobe.extinction_range.value_or(lobe.fit ? std::pair(extinction / 2, extinction * 2) : std::pair(extinction, extinction));
  parameters.extinction = low == high ? low : float(std::sqrt(double(low) * high));
  if (lobe.fit) parameters.extinction_low = low, parameters.extinction_high = high;

  parameters.bake_voxels = enoughVoxels(cloud, settings.field, parameters.bake.rays);
  return lobe.target_error ? keepingTarget(cloud, settings, parameters) : parameters;
}

FieldSettings fieldSettings(const FieldSettings& settings, const BakeParameters& parameters) {
  FieldSettings field = settings;
  field.bake_voxels = parameters.bake_voxels;
  return field;
}

AssetInfo describe(const Settings& settings, const BakeParameters& parameters) {
  const LobeSettings& lobe = settings.lobe;
  const BakeSettings& bake = parameters.bake;
  AssetInfo info;
  info.lobe = lobe.fit ? "fit" : "mean";
  info.shape = parameters.shape;
  info.extinction = parameters.extinction;
  info.extinction_low = parameters.extinction_low;
  info.extinction_high = parameters.extinction_high;
  if (lobe.fit) info.sun_arc = lobe.sun_arc;
  if (lobe.fit_to_volume) info.volume = lobe.volume.over({});
  info.method = bake.method == Method::kSweep ? "sweep" : "rays";
  info.sampler = samplerName(bake.sampler);
  if (bake.method == Method::kRays) {
    info.quadrature = quadratureName(bake.quadrature);
    info.steps = bake.steps;
  }
  info.rays = bake.rays;
  info.ray_length = *bake.ray_length;
  info.smooth = lobe.smooth;
  info.separate = settings.mesh.separate;
  info.wrapped = settings.mesh.close == CloseChoice::kWrap;
  info.harmonic_order = lobe.harmonic_order;
  info.seed = bake.seed;
  return info;
}

}  // namespace cloudbake
