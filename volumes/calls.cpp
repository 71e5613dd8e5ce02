// Stands for the functions of the table in programs that start without OpenVDB: each call goes to libcloudbake_volumes.so.
#include <dlfcn.h>

#include <string>

#include "core/error.h"
#include "volumes/volume_functions.h"

namespace cloudbake {

namespace {

constexpr const char* kLibrary = "libcloudbake_volumes.so";

const VolumeFunctions& load() {
  const auto fail = [](const std::string& why) -> const VolumeFunctions& {
    throw IoError(kLibrary, "cannot be used: " + why + "; install cloudbake as a whole");
  };
  // It is never closed: level sets that it made live as long as they like. RUNPATH says where it is.
  void* library = ::dlopen(kLibrary, RTLD_NOW | RTLD_LOCAL);
  if (!library) return fail(::dlerror());
  const auto* functions = static_cast<const VolumeFunctions*>(::dlsym(library, "cloudbakeVolumeFunctions"));
  if (!functions) return fail(::dlerror());
  if (std::string(functions->version) != CLOUDBAKE_VERSION) return fail(std::string("it is of version ") + functions->version);
  return *functions;
}

const VolumeFunctions& volumes() {
  static const VolumeFunctions& functions = load();
  return functions;
}

}  // namespace

LevelSet levelSetFromSpheres(std::span<const Sphere> spheres, const LevelSetSettings& settings, Warnings& warnings) {
  return volumes().levelSetFromSpheres(spheres, settings, warnings);
}
LevelSet levelSetFromMesh(const SurfaceMesh& mesh, const LevelSetSettings& settings, Warnings& warnings) {
  return volumes().levelSetFromMesh(mesh, settings, warnings);
}
LevelSet levelSetFromOpenMesh(const SurfaceMesh& mesh, const LevelSetSettings& settings, Warnings& warnings) {
  return volumes().levelSetFromOpenMesh(mesh, settings, warnings);
}
double insideVolume(const LevelSet& level_set) { return volumes().insideVolume(level_set); }
CoverageField coverageFromLevelSet(const LevelSet& level_set, std::span<const Vec3> points) {
  return volumes().coverageFromLevelSet(level_set, points);
}
DenseField denseFromLevelSet(const LevelSet& level_set) { return volumes().denseFromLevelSet(level_set); }
SurfaceMesh meshFromLevelSet(const LevelSet& level_set, const SurfaceSettings& settings, Warnings& warnings) {
  return volumes().meshFromLevelSet(level_set, settings, warnings);
}
SurfaceError surfaceError(const SurfaceMesh& now, const SurfaceMesh& old) { return volumes().surfaceError(now, old); }
std::vector<Lobe> plainSphereRays(const BakePoints& points, const LevelSet& level_set, const BakeSettings& settings, Warnings& warnings) {
  return volumes().plainSphereRays(points, level_set, settings, warnings);
}
std::vector<Lobe> hddaSphereRays(const BakePoints& points, const LevelSet& level_set, const BakeSettings& settings, Warnings& warnings) {
  return volumes().hddaSphereRays(points, level_set, settings, warnings);
}
std::vector<Lobe> embreeSphereRays(const BakePoints& points, const Reference& reference, const BakeSettings& settings, Warnings& warnings) {
  return volumes().embreeSphereRays(points, reference, settings, warnings);
}
std::vector<float> hddaLengths(std::span<const Vec3> positions, std::span<const Vec3> directions, const LevelSet& level_set,
                               double ray_length) {
  return volumes().hddaLengths(positions, directions, level_set, ray_length);
}
VdbVolume decodeVdb(const std::filesystem::path& file, std::string bytes, const VdbSettings& settings, Warnings& warnings) {
  return volumes().decodeVdb(file, std::move(bytes), settings, warnings);
}
std::string encodeVdb(const LevelSet& level_set) { return volumes().encodeVdb(level_set); }

}  // namespace cloudbake
