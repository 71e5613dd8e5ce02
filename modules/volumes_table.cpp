#include "modules/volumes.h"

extern "C" __attribute__((visibility("default"))) const cloudbake::VolumesModule cloudbakeModule{
    CLOUDBAKE_VERSION,
    cloudbake::levelSetFromSpheres,
    cloudbake::levelSetFromMesh,
    cloudbake::levelSetFromOpenMesh,
    cloudbake::insideVolume,
    cloudbake::coverageFromLevelSet,
    cloudbake::denseFromLevelSet,
    cloudbake::meshFromLevelSet,
    cloudbake::nearestSurface,
    cloudbake::plainSphereRays,
    cloudbake::hddaSphereRays,
    cloudbake::embreeSphereRays,
    cloudbake::hddaLengths,
    cloudbake::decodeVdb,
    cloudbake::encodeVdb,
};
