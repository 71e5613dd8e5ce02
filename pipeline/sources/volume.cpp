#include "pipeline/sources/volume.h"

#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/surface.h"
#include "core/error.h"
#include "core/memory_budget.h"
#include "io/volume/vdb.h"
#include "pipeline/lobes/parameters.h"

namespace cloudbake {

Cloud readVolume(const Settings& settings, BakeReport& report, Stopwatch& watch) {
  const auto read = [&] {
    const std::filesystem::path& file = settings.source.input;
    Cloud cloud;
    requireMemoryForFile(file, settings.source.memory_limit);
    std::string bytes = settings.source.read.read_file(file);
    report.info.input_hash = hashBytes(bytes);
    VdbSettings read_as = settings.source.volume;
    read_as.up_axis = settings.source.read.up_axis.value_or(UpAxis::kY);
    VdbVolume volume = decodeVdb(file, std::move(bytes), read_as, report.warnings);
    cloud.level_set = std::move(volume.level_set);
    cloud.iso = volume.iso;
    cloud.voxel_size = float(cloud.level_set->frame.voxel_size);
    watch.lap(report.seconds, "read");
    cloud.surface = meshFromLevelSet(*cloud.level_set, {settings.mesh.vertices}, report.warnings);
    requireUsableSize(boundingBox(cloud.surface));
    cloud.closed = findDefects(cloud.surface).unmatched_edges == 0;
    cloud.sculpt = sculptOf(file.stem().string(), cloud.surface);
    watch.lap(report.seconds, "surface");
    return cloud;
  };
  return namingFile(report.input, [&] { return inStage("reading this volume", "resample it with larger voxels", read); });
}

}  // namespace cloudbake
