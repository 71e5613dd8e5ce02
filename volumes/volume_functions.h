// All that needs OpenVDB, with the other peers of `measure`, as a table. libopenvdb takes most of the time of a start, so it is loaded with
// libcloudbake_volumes.so, which is opened at the first call of one of these functions (volumes/calls.cpp). Libraries and programs that are
// linked with the real functions, such as the tests, do not need the table.
#pragma once

#include "bake/field/coverage.h"
#include "bake/field/dense_field.h"
#include "bake/field/level_set.h"
#include "bake/mesh/surface.h"
#include "bake/truth/peers.h"
#include "bake/truth/surface_error.h"
#include "io/volume/vdb.h"

namespace cloudbake {

struct VolumeFunctions {
  const char* version;  ///< of cloudbake, because a table of another version has other functions
  decltype(&cloudbake::levelSetFromSpheres) levelSetFromSpheres;
  decltype(&cloudbake::levelSetFromMesh) levelSetFromMesh;
  decltype(&cloudbake::levelSetFromOpenMesh) levelSetFromOpenMesh;
  decltype(&cloudbake::insideVolume) insideVolume;
  decltype(&cloudbake::coverageFromLevelSet) coverageFromLevelSet;
  decltype(&cloudbake::denseFromLevelSet) denseFromLevelSet;
  decltype(&cloudbake::meshFromLevelSet) meshFromLevelSet;
  decltype(&cloudbake::surfaceError) surfaceError;
  decltype(&cloudbake::plainSphereRays) plainSphereRays;
  decltype(&cloudbake::hddaSphereRays) hddaSphereRays;
  decltype(&cloudbake::embreeSphereRays) embreeSphereRays;
  decltype(&cloudbake::hddaLengths) hddaLengths;
  decltype(&cloudbake::decodeVdb) decodeVdb;
  decltype(&cloudbake::encodeVdb) encodeVdb;
};

}  // namespace cloudbake
