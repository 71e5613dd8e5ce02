#include "pipeline/library/cloud_light.h"

#include <algorithm>

#include "bake/mesh/mesh_topology.h"
#include "pipeline/asset/asset.h"
#include "pipeline/options/resolve.h"

namespace cloudbake {

namespace {

Cloud cloudOf(const Settings& settings) {
  BakeReport not_told;
  Stopwatch watch;
  return readCloud(settings, not_told, watch);
}

IntegrationField fieldOf(const Cloud& cloud, const Settings& settings) {
  Warnings not_told;  // the bake reports them
  return namingFile(settings.source.input.string(), [&] { return buildField(cloud, settings.field, Method::kSweep, not_told); });
}

}  // namespace

CloudLight::CloudLight(const std::filesystem::path& file, const Options& options)
    : CloudLight(sourceOfFile(file), resolve(sourceOfFile(file), givenBy(options, kBake))) {}

CloudLight::CloudLight(const SourceSettings& source, const Settings& settings)
    : source_(source),
      cloud_(cloudOf(settings)),
      field_(fieldOf(cloud_, settings)),
      swept_(cloud_.surface.positions, *field_.coverage, boundingBox(cloud_.surface).diagonal()) {}

// The sharpened field overshoots, so that a grazing length may come out negative by up to a voxel.
std::vector<float> CloudLight::lengths(Vec3 to_light) const {
  std::vector<float> lengths = swept_.lengths(to_light);
  for (float& length : lengths) length = std::max(length, 0.0F);
  return lengths;
}

CloudLight::Lobes CloudLight::lobes(const Options& options) const {
  const Settings settings = resolve(source_, givenBy(options, kBake));
  const BakeParameters parameters = parametersFor(cloud_, settings);
  Warnings not_told;
  Stopwatch watch;
  StageSeconds seconds;
  BakedLobes baked = bakeLobes(cloud_, field_, settings.lobe, parameters, not_told, watch, seconds);
  return {std::move(baked.lobes), baked.shape, parameters.extinction, std::move(baked.fit)};
}

}  // namespace cloudbake
