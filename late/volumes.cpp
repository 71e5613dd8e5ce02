// All that needs OpenVDB, with the other peers of `measure`: libopenvdb takes longer to load than most bakes last.
#include "bake/field/coverage.h"
#include "bake/field/dense_field.h"
#include "bake/field/level_set.h"
#include "bake/mesh/surface.h"
#include "bake/truth/peers.h"
#include "bake/truth/surface_error.h"
#include "io/volume/vdb.h"

#define LIBRARY volumes
#define FUNCTIONS(FUNCTION)                                                                                                               \
  FUNCTION(LevelSet, levelSetFromSpheres, (std::span<const Sphere> spheres, const LevelSetSettings& settings, Warnings& warnings),        \
           (spheres, settings, warnings))                                                                                                 \
  FUNCTION(LevelSet, levelSetFromMesh, (const SurfaceMesh& mesh, const LevelSetSettings& settings, Warnings& warnings),                   \
           (mesh, settings, warnings))                                                                                                    \
  FUNCTION(LevelSet, levelSetFromOpenMesh, (const SurfaceMesh& mesh, const LevelSetSettings& settings, Warnings& warnings),               \
           (mesh, settings, warnings))                                                                                                    \
  FUNCTION(LevelSet, withoutDetail, (const LevelSet& level_set, double radius_voxels), (level_set, radius_voxels))                        \
  FUNCTION(double, insideVolume, (const LevelSet& level_set), (level_set))                                                                \
  FUNCTION(CoverageField, coverageFromLevelSet, (const LevelSet& level_set, std::span<const Vec3> points), (level_set, points))           \
  FUNCTION(DenseField, denseFromLevelSet, (const LevelSet& level_set), (level_set))                                                       \
  FUNCTION(SurfaceMesh, meshFromLevelSet, (const LevelSet& level_set, const SurfaceSettings& settings, Warnings& warnings),               \
           (level_set, settings, warnings))                                                                                               \
  FUNCTION(std::unique_ptr<const NearestSurface>, nearestSurface, (const SurfaceMesh& surface), (surface))                                \
  FUNCTION(std::vector<Lobe>, plainSphereRays,                                                                                            \
           (const BakePoints& points, const LevelSet& level_set, const BakeSettings& settings, Warnings& warnings),                       \
           (points, level_set, settings, warnings))                                                                                       \
  FUNCTION(std::vector<Lobe>, hddaSphereRays,                                                                                             \
           (const BakePoints& points, const LevelSet& level_set, const BakeSettings& settings, Warnings& warnings),                       \
           (points, level_set, settings, warnings))                                                                                       \
  FUNCTION(std::vector<Lobe>, referenceSphereRays,                                                                                        \
           (const BakePoints& points, const Reference& reference, const BakeSettings& settings, Warnings& warnings),                      \
           (points, reference, settings, warnings))                                                                                       \
  FUNCTION(std::vector<float>, hddaLengths,                                                                                               \
           (std::span<const Vec3> positions, std::span<const Vec3> directions, const LevelSet& level_set, double ray_length),             \
           (positions, directions, level_set, ray_length))                                                                                \
  FUNCTION(VdbVolume, decodeVdb, (const std::filesystem::path& file, std::string bytes, const VdbSettings& settings, Warnings& warnings), \
           (file, std::move(bytes), settings, warnings))                                                                                  \
  FUNCTION(std::string, encodeVdb, (const LevelSet& level_set), (level_set))

#include "late/library.h"
