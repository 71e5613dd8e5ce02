#include "pipeline/sources/volume.h"

#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/surface.h"
#include "io/volume/vdb.h"
#include "io/file/write_file.h"

namespace cloudbake {

void checkVolumeOptions(const Settings& settings) {
  const auto refuseIf = [](bool given, const std::string& option, const char* why) {
    if (given) throw UsageError("--" + option + why);
  };
  if (!isVdbFile(settings.input)) {
    constexpr const char* kOfVdb = " is an option of VDB files: leave it out";
    refuseIf(settings.volume.grid.has_value(), "grid", kOfVdb);
    refuseIf(settings.volume.iso.has_value(), "iso", kOfVdb);
    return;
  }
  constexpr const char* kOwnLattice = ": a VDB has voxels of its own, leave it out, or give --bake-voxels for the integration field";
  refuseIf(settings.voxels.has_value(), "voxels", kOwnLattice);
  refuseIf(settings.voxel_size.has_value(), "voxel-size", kOwnLattice);
  constexpr const char* kOfMeshes = " is for sculpts: a VDB has no mesh, leave it out";
  refuseIf(settings.repair.orient || settings.repair.fill || settings.repair_remesh, "repair", kOfMeshes);
  refuseIf(settings.remesh.has_value(), "remesh", kOfMeshes);
  refuseIf(settings.close != CloseChoice::kAuto, "close", kOfMeshes);
  refuseIf(settings.separate, "separate", kOfMeshes);
  refuseIf(settings.inspect, "inspect", kOfMeshes);
  refuseIf(settings.read.metres_per_unit || settings.read.up_axis, "units",
           " and --up are for sculpts: a VDB has a transform of its own, set it where the volume is made");
}

Scene readVolume(Settings& settings, BakeReport& report, Stopwatch& watch) {
  return namingFile(report.input, [&] {
    Scene scene;
    std::string bytes = readFileBytes(settings.input);
    report.info.input_hash = hashBytes(bytes);
    scene.level_set = decodeVdb(settings.input, std::move(bytes), settings.volume, report.warnings).level_set;
    settings.voxel_size = float(scene.level_set->frame.voxel_size);
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
