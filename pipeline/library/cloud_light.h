// The exact light at the vertices of one cloud, for one sun after the other, and lobes that are baked anew for other lights.
#pragma once

#include <filesystem>
#include <vector>

#include "bake/lobe/sweep.h"
#include "pipeline/library/cloudbake.h"
#include "pipeline/lobes/lobes.h"

namespace cloudbake {

class CloudLight {
 public:
  /// Reads a sculpt or an asset and builds its integration field. The options are those of a bake: its voxels, and how the file is read.
  /// Throws as bake does.
  CloudLight(const std::filesystem::path& file, const Options& options);
  size_t vertexCount() const { return cloud_.surface.positions.size(); }
  /// The lengths of cloud from every vertex towards a light, world units: T = exp(−σ · length); not below 0. The vertices are in the order
  /// of the file, part after part; `to_light` is a unit vector.
  std::vector<float> lengths(Vec3 to_light) const;

  struct Lobes {
    std::vector<Lobe> lobes;
    LobeShape shape;
    float extinction;
    std::vector<FitError> fit;  ///< as in BakedLobes
  };
  /// The lobes of a bake with these options on the field that is there, so that they do not change its voxels.
  Lobes lobes(const Options& options) const;

 private:
  CloudLight(const SourceSettings& source, const Settings& settings);

  SourceSettings source_;
  Cloud cloud_;
  IntegrationField field_;
  SweptPoints swept_;
};

}  // namespace cloudbake
