// Volumes as OpenVDB itself makes and writes them, and what is read from them.
#pragma once

#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <string>

#include "bake/field/level_set.h"
#include "bake/mesh/surface.h"
#include "core/level_set_type.h"
#include "io/file/write_file.h"
#include "io/volume/vdb.h"
#include "tests/io/io_helpers.h"

namespace cloudbake {

inline openvdb::FloatGrid::Ptr ballGrid(double radius, Vec3 center, double voxel_size, double band = 3) {
  openvdb::initialize();
  auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(float(radius), {center.x, center.y, center.z}, float(voxel_size),
                                                                       float(band));
  grid->setName("ball");
  return grid;
}

/// As many tools write: by openvdb::io::File, compressed, with the places of the grids; or as a stream, without.
inline std::filesystem::path writeVdb(const TestFolder& folder, const openvdb::GridPtrVec& grids) {
  std::filesystem::path file = folder.path / "a.vdb";
  openvdb::io::File out(file.string());
  out.write(grids);
  return file;
}
inline std::string streamedVdb(const openvdb::GridPtrVec& grids) {
  std::ostringstream out;
  openvdb::io::Stream(out).write(grids);
  return out.str();
}

inline VdbVolume readVdb(const std::filesystem::path& file, const VdbSettings& settings = {}, Warnings warnings = {}) {
  return decodeVdb(file, readFileBytes(file), settings, warnings);
}
inline Warnings warningsOfVdb(const std::filesystem::path& file, const VdbSettings& settings = {}) {
  Warnings warnings;
  decodeVdb(file, readFileBytes(file), settings, warnings);
  return warnings;
}

inline SurfaceMesh surfaceOf(const LevelSet& level_set) {
  Warnings warnings;
  return meshFromLevelSet(level_set, {}, warnings);
}

}  // namespace cloudbake
