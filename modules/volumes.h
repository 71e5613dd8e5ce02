// All that needs OpenVDB, with the other peers of `measure`: libopenvdb takes longer to load than most bakes last.
#pragma once

#include "bake/field/coverage.h"
#include "bake/field/dense_field.h"
#include "bake/field/level_set.h"
#include "bake/mesh/surface.h"
#include "bake/truth/peers.h"
#include "bake/truth/surface_error.h"
#include "io/volume/vdb.h"

namespace cloudbake {

struct VolumesModule {
  const char* version;  ///< of cloudbake
  decltype(&cloudbake::levelSetFromSpheres) levelSetFromSpheres;
  decltype(&cloudbake::levelSetFromMesh) levelSetFromMesh;
  decltype(&cloudbake::levelSetFromOpenMesh) levelSetFromOpenMesh;
  decltype(&cloudbake::insideVolume) insideVolume;
  decltype(&cloudbake::coverageFromLevelSet) coverageFromLevelSet;
  decltype(&cloudbake::denseFromLevelSet) denseFromLevelSet;
  decltype(&cloudbake::meshFromLevelSet) meshFromLevelSet;
  decltype(&cloudbake::nearestSurface) nearestSurface;
  decltype(&cloudbake::plainSphereRays) plainSphereRays;
  decltype(&cloudbake::hddaSphereRays) hddaSphereRays;
  decltype(&cloudbake::embreeSphereRays) embreeSphereRays;
  decltype(&cloudbake::hddaLengths) hddaLengths;
  decltype(&cloudbake::decodeVdb) decodeVdb;
  decltype(&cloudbake::encodeVdb) encodeVdb;
};

}  // namespace cloudbake
