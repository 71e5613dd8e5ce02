#include "app/volume.h"

#include "bake/mesh_topology.h"
#include "bake/surface.h"
#include "io/vdb.h"
#include "io/write_file.h"

namespace cloudbake {

void checkVolumeOptions(const Settings& settings) {
  if (!isVdbFile(settings.input)) {
    constexpr const char* kOfVdb = " is an option of VDB files: leave it out";
    if (settings.volume.grid) throw UsageError(std::string("--grid") + kOfVdb);
    if (settings.volume.iso) throw UsageError(std::string("--iso") + kOfVdb);
    return;
  }
  constexpr const char* kOwnLattice = ": a VDB has voxels of its own, leave it out, or give --bake-voxels for the integration field";
  if (settings.voxels) throw UsageError(std::string("--voxels") + kOwnLattice);
  if (settings.voxel_size) throw UsageError(std::string("--voxel-size") + kOwnLattice);
  constexpr const char* kOfMeshes = " is for sculpts: a VDB has no mesh, leave it out";
  if (settings.repair.orient || settings.repair.fill || settings.repair_remesh) throw UsageError(std::string("--repair") + kOfMeshes);
  if (settings.remesh) throw UsageError(std::string("--remesh") + kOfMeshes);
  if (settings.close != CloseChoice::kAuto) throw UsageError(std::string("--close") + kOfMeshes);
  if (settings.separate) throw UsageError(std::string("--separate") + kOfMeshes);
  if (settings.inspect) throw UsageError(std::string("--inspect") + kOfMeshes);
  if (settings.read.metres_per_unit || settings.read.up_axis)
    throw UsageError("--units and --up are for sculpts: a VDB has a transform of its own, set it where the volume is made");
}

Scene readVolume(Settings& settings, BakeReport& report, Stopwatch& watch) {
  return namingFile(report.input, [&] {
    Scene scene;
    scene.level_set = readVdb(settings.input, settings.volume, report.warnings).level_set;
    settings.voxel_size = float(scene.level_set->frame.voxel_size);
    report.info.input_hash = hashBytes(readFileBytes(settings.input));
    watch.lap(report, "read");
    scene.surface = meshFromLevelSet(*scene.level_set, {settings.vertices}, report.warnings);
    scene.closed = findDefects(scene.surface).unmatched_edges == 0;
    const std::string name = settings.input.stem().string();
    scene.sculpt.parts.push_back({name, scene.surface.positions, scene.surface.normals, {}, scene.surface.triangles, {}});
    watch.lap(report, "surface");
    return scene;
  });
}

}  // namespace cloudbake
