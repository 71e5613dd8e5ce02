#include "modules/open_module.h"
#include "modules/volumes.h"

namespace cloudbake {

namespace {

const VolumesModule& volumes() {
  static const VolumesModule& module = openModule<VolumesModule>("libcloudbake_volumes.so");
  return module;
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
std::unique_ptr<const NearestSurface> nearestSurface(const SurfaceMesh& surface) { return volumes().nearestSurface(surface); }
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
