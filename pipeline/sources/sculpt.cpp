#include "pipeline/sources/sculpt.h"

#include <algorithm>
#include <cmath>

#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/repair.h"
#include "bake/mesh/self_intersections.h"
#include "bake/mesh/shells.h"
#include "bake/mesh/surface.h"
#include "bake/truth/surface_error.h"
#include "core/error.h"
#include "core/memory_budget.h"
#include "core/vertex_normals.h"
#include "io/gltf/sculpt/part_per_primitive.h"
#include "io/gltf/sculpt/read.h"
#include "io/sculpt/read_mesh.h"
#include "pipeline/lobes/parameters.h"

namespace cloudbake {

namespace {

// Turns the normals of vertices whose triangles were all turned, if they now disagree with these triangles.
// `turned` marks triangles of the whole sculpt; those of this part begin at `first`.
void turnNormals(SculptPart& part, const std::vector<bool>& turned, size_t first) {
  if (part.normals.empty()) return;
  std::vector<uint8_t> met(part.positions.size(), 0);  // bit 0: has a turned triangle, bit 1: has one that was not turned
  for (size_t f = 0; f < part.triangles.size(); ++f)
    for (const uint32_t v : part.triangles[f]) met[v] |= turned[first + f] ? 1 : 2;
  const std::vector<Vec3> own = vertexNormals(part.positions, part.triangles);
  for (size_t v = 0; v < met.size(); ++v)
    if (met[v] == 1 && dot(own[v], part.normals[v]) < 0) part.normals[v] = -part.normals[v];
}

// Repairs the mesh, then returns its triangles to their parts: the file's own in their order, new ones to the part of their first corner.
void repairSculpt(Cloud& cloud, const MeshSettings& settings, BakeReport& report) {
  const std::vector<uint32_t> part_of = partsOfVertices(cloud.sculpt);
  SurfaceMesh mesh = cloud.surface;
  std::vector<bool> turned;
  report.repair = repairMesh(mesh, part_of, settings.repair, turned, report.warnings);
  std::vector<uint32_t> first_vertex;
  for (size_t first = 0, triangle = 0; SculptPart & part : cloud.sculpt.parts) {
    first_vertex.push_back(uint32_t(first));
    for (size_t f = 0; f < part.triangles.size(); ++f)
      if (turned[triangle + f]) std::swap(part.triangles[f][1], part.triangles[f][2]), part.repaired = true;
    turnNormals(part, turned, triangle);
    first += part.positions.size();
    triangle += part.triangles.size();
  }
  for (size_t f = turned.size(); f < mesh.triangles.size(); ++f) {
    const uint32_t index = part_of[mesh.triangles[f][0]];
    SculptPart& part = cloud.sculpt.parts[index];
    Triangle t = mesh.triangles[f];
    for (uint32_t& v : t) v -= first_vertex[index];
    if (part.isMirrored(t)) std::swap(t[1], t[2]);
    part.triangles.push_back(t);
    part.repaired = true;
  }
  cloud.surface = surfaceInScene(cloud.sculpt);
}

// A budget thins the mesh out, unless it is that of --refine, which keeps the sculpt's own vertices.
bool isThinned(const MeshSettings& settings) { return settings.vertices && !settings.refine; }

// Replaces the sculpt's mesh if there is a vertex budget or an edge length. The new mesh is one part in scene space.
void replaceMesh(Cloud& cloud, const MeshSettings& settings, BakeReport& report, const Stopwatch& watch) {
  const bool remesh = settings.remesh || settings.repair_remesh;
  if (!remesh && !(isThinned(settings) && *settings.vertices < cloud.surface.positions.size())) return;
  const SurfaceMesh old = cloud.surface;
  if (remesh) {
    const double edge = settings.remesh ? double(settings.remesh->resolve(boundingBox(old).longestSide())) : meanEdgeLength(old);
    const StageWork work = remeshWork(surfaceArea(old) / (std::sqrt(3.0) / 4 * edge * edge));
    requireMemory({work.what, work.bytes, settings.remesh ? "use a longer edge with --remesh" : "give a longer edge with --remesh"},
                  settings.memory_limit);
    watch.announce(work);
    cloud.surface = remeshed(old, edge);
  } else
    reduceVertices(cloud.surface, *settings.vertices, report.warnings);
  report.surface_error = nearestSurface(old)->errorOf(cloud.surface);
  cloud.surface.normals = vertexNormals(cloud.surface.positions, cloud.surface.triangles);
  const std::string name = cloud.sculpt.parts.front().name;
  report.warnings.add(WarningKind::kPartIgnored,
                      (settings.remesh ? "--remesh"
                       : remesh        ? "--repair remesh"
                                       : "--vertices") +
                          std::string(" makes one new mesh: parts, UVs and materials of the sculpt are not carried over"));
  cloud.sculpt = {{SculptPart{name, cloud.surface.positions, cloud.surface.normals, {}, cloud.surface.triangles, {}}}, nullptr};
}

// Reports defects that take longer to find than a bake takes, and that do no harm to it.
void inspect(const Cloud& cloud, BakeReport& report) {
  const auto place = [&](uint32_t triangle) { return ", first at " + placeInSculpt(cloud.sculpt, triangle, false); };
  if (const Defect pairs = findSelfIntersections(cloud.surface); pairs.count > 0)
    report.findings.add(WarningKind::kSelfIntersection, "two triangles cut or touch each other" + place(pairs.first), pairs.count);
  const SurfaceMesh welded = weldedByPosition(cloud.surface);
  const std::vector<Shell> shells = shellsOf(welded);
  const std::vector<bool> inner = innerShells(welded, shells);
  for (size_t i = 0; i < shells.size(); ++i)
    if (inner[i])
      report.findings.add(WarningKind::kInnerShell, std::string("a shell lies inside another: ") +
                                                        (shells[i].volume < 0 ? "a cavity" : "it adds nothing") +
                                                        place(shells[i].triangles.front()));
}

// Throws if the mesh was a sheet: once its rim is filled it has no volume, or so little that any lattice loses it.
void refuseSheet(const SurfaceMesh& filled) {
  constexpr double kThinnest = 1e-4;  // mean thickness, of the longest side: a hundredth of a voxel
  if (std::fabs(signedVolume(filled)) < kThinnest * surfaceArea(filled) * boundingBox(filled).longestSide() / 2)
    throw InputError("", "the mesh is a flat sheet that encloses nothing: give it thickness, or use --close wrap");
}

// What --repair and --refine change of a part belongs to one primitive of a glTF.
Sculpt readyForChanges(Sculpt sculpt, const MeshSettings& settings) {
  const bool is_repaired = settings.repair.orient || settings.repair.fill;
  if (!is_repaired && !settings.refine) return sculpt;
  auto taken_apart = withPartPerPrimitive(sculpt, [&](size_t part) { return is_repaired || sculpt.parts[part].fixed.empty(); });
  return taken_apart ? std::move(*taken_apart) : std::move(sculpt);
}

// Determines whether the cloud is closed, and what bounds its volume.
void closeCloud(Cloud& cloud, const MeshSettings& settings, const MeshDefects& defects, BakeReport& report) {
  cloud.closed = defects.unmatched_edges == 0;
  cloud.wrapped = settings.close == CloseChoice::kWrap;
  if (cloud.closed) return;
  if (settings.close == CloseChoice::kAuto) {
    uint64_t holes = 0;
    cloud.filled = closedByFilling(cloud.surface, holes);
    if (cloud.filled) {
      refuseSheet(*cloud.filled);
      report.volume_note = "bounded by the sculpt with " +
                           (holes > 0 ? std::to_string(holes) + " holes filled" : std::string("its triangles oriented alike"));
    }
  }
  if (settings.close == CloseChoice::kReject) {
    const bool open = defects.open_edges.count > 0;
    const Defect& edges = open ? defects.open_edges : defects.turned_edges.count > 0 ? defects.turned_edges : defects.non_manifold_edges;
    throw InputError("", "--close reject: the mesh bounds no volume, " + std::to_string(edges.count) +
                             (open                             ? " edges are open"
                              : defects.turned_edges.count > 0 ? " edges lie between triangles of opposite winding"
                                                               : " edges have more than two triangles") +
                             ", first at " + placeInSculpt(cloud.sculpt, edges.first, false) + ": close it, or use --repair " +
                             (open ? "orient,fill" : "orient") + " or --close auto");
  }
}

}  // namespace

std::string placeInSculpt(const Sculpt& sculpt, uint32_t index, bool is_vertex) {
  for (const SculptPart& part : sculpt.parts) {
    const size_t count = is_vertex ? part.positions.size() : part.triangles.size();
    if (index < count)
      return (is_vertex ? "vertex " : "triangle ") + std::to_string(index) + (part.name.empty() ? "" : " of '" + part.name + "'");
    index -= uint32_t(count);
  }
  return "an unknown place";
}

Cloud readSculpt(const Settings& settings, BakeReport& report, Stopwatch& watch) {
  const auto read = [&] {
    requireMemoryForFile(settings.source.input, settings.source.memory_limit);
    Sculpt sculpt;
    {
      const std::string bytes = settings.source.read.read_file(settings.source.input);  // is freed before the check takes its memory
      sculpt = readMesh(settings.source.input, bytes, settings.source.read, report.warnings);
      report.info.input_hash = sourceHash(sculpt, bytes);
    }
    return cloudOfSculpt(std::move(sculpt), settings.mesh, report, watch);
  };
  return namingFile(report.input, [&] { return inStage("reading this sculpt", "use one with fewer vertices", read); });
}

Cloud cloudOfSculpt(Sculpt sculpt, const MeshSettings& settings, BakeReport& report, Stopwatch& watch) {
  Cloud cloud;
  cloud.sculpt = readyForChanges(std::move(sculpt), settings);
  report.frame_note = cloud.sculpt.frame_note;
  cloud.surface = surfaceInScene(cloud.sculpt);
  requireUsableSize(boundingBox(cloud.surface));
  watch.lap(report.seconds, "read");
  MeshDefects defects = findDefects(cloud.surface);
  reportDefects(
      defects, [&](uint32_t index, bool is_vertex) { return placeInSculpt(cloud.sculpt, index, is_vertex); }, report.warnings);
  watch.lap(report.seconds, "check");
  if (settings.inspect) {
    inspect(cloud, report);
    watch.lap(report.seconds, "inspect");
  }
  if (settings.repair.orient || settings.repair.fill) {
    repairSculpt(cloud, settings, report);
    defects = findDefects(cloud.surface);
    watch.lap(report.seconds, "repair");
  }
  if (isThinned(settings) || settings.remesh || settings.repair_remesh) {
    replaceMesh(cloud, settings, report, watch);
    defects = findDefects(cloud.surface);
    watch.lap(report.seconds, "surface");
  }
  closeCloud(cloud, settings, defects, report);
  watch.lap(report.seconds, "check");
  return cloud;
}

void takePartsAnew(Cloud& cloud, const MeshSettings& settings, BakeReport& report) {
  cloud.surface = surfaceInScene(cloud.sculpt);
  cloud.filled.reset();
  closeCloud(cloud, settings, findDefects(cloud.surface), report);
}

std::vector<Cloud> separateObjects(const Cloud& cloud, const MeshSettings& settings, BakeReport& report) {
  std::vector<Cloud> objects;
  for (size_t i = 0; i < cloud.sculpt.parts.size(); ++i) {
    const SculptPart& part = cloud.sculpt.parts[i];
    if (i == 0 || part.object != cloud.sculpt.parts[i - 1].object) objects.emplace_back();
    objects.back().sculpt.parts.push_back(part);
  }
  for (Cloud& object : objects) takePartsAnew(object, settings, report);
  return objects;
}

}  // namespace cloudbake
