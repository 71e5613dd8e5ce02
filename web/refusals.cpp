// What the module cannot do: the functions of the rooms that need OpenVDB, CGAL, Embree, Draco, meshoptimizer or another process. Each
// refuses, with the way out.
#include "web/refusals.h"
#include "bake/field/coverage.h"
#include "bake/field/dense_field.h"
#include "bake/field/level_set.h"
#include "bake/lobe/sphere_rays.h"
#include "bake/mesh/repair.h"
#include "bake/mesh/self_intersections.h"
#include "bake/mesh/surface.h"
#include "bake/truth/reference.h"
#include "bake/truth/surface_error.h"
#include "core/error.h"
#include "io/gltf/asset/pack.h"
#include "io/gltf/unpack/unpack.h"
#include "io/sculpt/child_reader.h"
#include "io/sculpt/delaunay_polygon.h"
#include "io/volume/lattice.h"
#include "io/volume/vdb.h"
#include "pipeline/asset/levels.h"

namespace cloudbake {

namespace {

// `what` has the program as its subject: "… closes an open sculpt".
[[noreturn]] void refuse(const std::string& what) {
  has_refused = true;
  throw InputError("", "only the program `cloudbake` " + what + ": use it for this");
}

constexpr const char *kLevelSet = "has --method rays and --field levelset", *kExact = "has --target-error",
                     *kMesh = "has --vertices, --remesh and --repair", *kClosing = "closes an open sculpt, and this one is open";

}  // namespace

LevelSet levelSetFromSpheres(std::span<const Sphere>, const LevelSetSettings&, Warnings&) { refuse("grows a mesh"); }
LevelSet levelSetFromMesh(const SurfaceMesh&, const LevelSetSettings&, Warnings&) { refuse(kLevelSet); }
LevelSet levelSetFromOpenMesh(const SurfaceMesh&, const LevelSetSettings&, Warnings&) { refuse(kClosing); }
double insideVolume(const LevelSet&) { refuse(kClosing); }
LevelSet withoutDetail(const LevelSet&, double) { refuse(kLevelSet); }
CoverageField coverageFromLevelSet(const LevelSet&, std::span<const Vec3>) { refuse(kLevelSet); }
DenseField denseFromLevelSet(const LevelSet&) { refuse(kLevelSet); }
std::vector<Lobe> bakeSphereRays(const BakePoints&, const DenseField&, const BakeSettings&, Warnings&) { refuse(kLevelSet); }
std::vector<float> marchedLengths(std::span<const Vec3>, std::span<const Vec3>, const DenseField&, const BakeSettings&) {
  refuse(kLevelSet);
}
SurfaceMesh meshFromLevelSet(const LevelSet&, const SurfaceSettings&, Warnings&) { refuse("grows a mesh"); }
VdbVolume decodeVdb(const std::filesystem::path&, std::string, const VdbSettings&, Warnings&) { refuse("reads a VDB"); }

// The rules of options let them pass, so that these functions can say what they need.
bool hasCgal() { return true; }
std::optional<SurfaceMesh> closedByFilling(const SurfaceMesh&, uint64_t&) { return std::nullopt; }
Wrap wrapClosed(const SurfaceMesh&, double) { refuse(kClosing); }
SurfaceMesh remeshed(const SurfaceMesh&, double) { refuse(kMesh); }
RepairSummary repairMesh(SurfaceMesh&, std::span<const uint32_t>, const RepairSettings&, std::vector<bool>&, Warnings&) { refuse(kMesh); }
Defect findSelfIntersections(const SurfaceMesh&) { refuse("has --inspect"); }
void reduceVertices(SurfaceMesh&, size_t, Warnings&) { refuse(kMesh); }
std::vector<uint32_t> orderedForCodec(std::span<const uint32_t>, size_t, std::vector<uint32_t>&) { refuse("has --pack-as meshopt"); }
std::string compressedVertices(std::string_view, size_t, size_t) { refuse("has --pack-as meshopt"); }
std::string filteredNormals(std::span<const float>) { refuse("has --pack-as meshopt"); }
std::string compressedTriangles(std::span<const uint32_t>, size_t) { refuse("has --pack-as meshopt"); }
std::unique_ptr<const NearestSurface> nearestSurface(const SurfaceMesh&) { refuse(kMesh); }
std::vector<LevelAsset> makeLevels(const Cloud&, std::span<const Lobe>, std::span<const float>, const Settings&, BakeReport&, Stopwatch&) {
  refuse("has --lods");
}

std::unique_ptr<Reference> meshReference(const SurfaceMesh&) { refuse(kExact); }
std::unique_ptr<Reference> sphereReference(std::span<const Sphere>) { refuse(kExact); }
std::unique_ptr<Reference> marchReference(DenseField) { refuse(kExact); }
Truth trueLobes(const Reference&, std::span<const Vec3>, std::span<const Vec3>, double) { refuse(kExact); }

void unpackMeshopt(Unpacking&, const std::string& extension) { refuse("unpacks " + extension); }
void unpackDraco(Unpacking&) { refuse(std::string("unpacks ") + kDraco); }
Sculpt readWithAssimp(const std::filesystem::path& file, const std::string&, const std::string& extension, const ReadSettings&, Warnings&) {
  if (isSculptFile(file)) refuse("reads this ." + extension);
  throw InputError("", (extension.empty() ? "the file has no extension" : "the module does not read a ." + extension) +
                           ": export the sculpt as glTF, OBJ, PLY, STL or OFF, or try the program `cloudbake`");
}
Sculpt readInChild(const std::filesystem::path& file, const std::string& bytes, const std::string& extension, const ReadSettings& settings,
                   Warnings& warnings, const ChildLimits&) {
  return readWithAssimp(file, bytes, extension, settings, warnings);
}

std::vector<LatticeFile> encodeLattice(const HarmonicLattice&, const std::string&) { refuse("has --lattice"); }
bool hasDelaunayPolygon() { return true; }
std::optional<std::vector<std::array<size_t, 3>>> delaunayPolygon(std::span<const std::array<double, 2>>) {
  refuse("cuts polygons of so many corners into triangles");
}

}  // namespace cloudbake
