#include "pipeline/asset/levels.h"

#include <algorithm>
#include <cmath>

#include "bake/lobe/sweep.h"
#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/simplify.h"
#include "bake/truth/surface_error.h"
#include "core/error.h"
#include "core/lobe_lighting.h"
#include "core/parallel.h"
#include "core/portable_math.h"
#include "core/surface_points.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/decode.h"
#include "io/gltf/asset/write.h"
#include "io/gltf/impostor/impostor_file.h"
#include "io/gltf/sculpt/part_per_primitive.h"
#include "io/gltf/sculpt/reduce_sculpt.h"
#include "preview/compare/popping.h"

namespace cloudbake {

namespace {

constexpr size_t kComparedPoints = 10000;
constexpr int kComparedLights = 64;

// What counts as the light of a vertex for the simplification: o (1 − e^−σd), the direction to the bulk, as long as the bulk is opaque.
// The weight makes a difference of 1 in it as bad as this share of the longest side. docs/converting_sculpts.md has the figures.
constexpr float kLightWeight = 0.04F;

std::vector<Vec3> weighedLight(std::span<const Lobe> lobes, float extinction) {
  std::vector<Vec3> light;
  for (const Lobe& lobe : lobes) light.push_back(lobe.direction * (kLightWeight * (1 - portableExp(-extinction * lobe.thickness))));
  return light;
}

// The vertices of parts that something moves.
std::vector<bool> heldVertices(const Sculpt& sculpt, Warnings& warnings) {
  std::vector<bool> held;
  for (size_t i = 0; i < sculpt.parts.size(); ++i) {
    const bool deformed = isDeformed(sculpt, i);
    held.insert(held.end(), sculpt.parts[i].positions.size(), deformed);
    if (deformed)
      warnings.add(WarningKind::kPartKept,
                   "'" + sculpt.parts[i].name + "' is moved by joints or morph targets: its levels of detail are the part itself");
  }
  return held;
}

// The surface with vertices that only repeat others left out, as they are in a file that gives every triangle corners of its own.
SurfaceMesh withoutRepeats(const Cloud& cloud) {
  const std::vector<uint32_t> first = firstAlike(cloud.sculpt);
  SurfaceMesh mesh = cloud.surface;
  for (Triangle& t : mesh.triangles)
    for (uint32_t& v : t) v = first[v];
  return mesh;
}

// The triangles of the surface as own triangles of the parts; none for a part that is held.
std::vector<std::vector<Triangle>> trianglesPerPart(const Sculpt& sculpt, const std::vector<Triangle>& triangles,
                                                    const std::vector<bool>& held) {
  const std::vector<uint32_t> part_of = partsOfVertices(sculpt);
  std::vector<uint32_t> first_vertex{0};
  for (const SculptPart& part : sculpt.parts) first_vertex.push_back(first_vertex.back() + uint32_t(part.positions.size()));
  std::vector<std::vector<Triangle>> per_part(sculpt.parts.size());
  for (Triangle t : triangles) {
    if (held[t[0]]) continue;
    const uint32_t part = part_of[t[0]];
    for (uint32_t& v : t) v -= first_vertex[part];
    if (sculpt.parts[part].isMirrored(t)) std::swap(t[1], t[2]);
    per_part[part].push_back(t);
  }
  return per_part;
}

// What a level keeps of the sculpt, and the same as one mesh.
struct Level {
  Sculpt sculpt;
  std::vector<std::vector<Lobe>> lobes_per_part;
};

Level levelOf(const Cloud& cloud, const std::vector<std::vector<Triangle>>& per_part, const BakedMesh& full, BakedMesh& mesh) {
  Level level{withTriangles(cloud.sculpt, per_part), {}};
  mesh.surface = surfaceInScene(level.sculpt);
  mesh.info = full.info;
  const size_t per_vertex = full.lobes.empty() ? 0 : full.harmonics.size() / full.lobes.size();
  for (size_t i = 0, first = 0; i < per_part.size(); ++i) {
    const size_t count = cloud.sculpt.parts[i].positions.size();
    std::vector<Lobe>& own = level.lobes_per_part.emplace_back();
    const auto keep = [&](size_t v) {
      own.push_back(full.lobes[first + v]);
      const auto row = std::span(full.harmonics).subspan((first + v) * per_vertex, per_vertex);
      mesh.harmonics.insert(mesh.harmonics.end(), row.begin(), row.end());
    };
    if (per_part[i].empty())
      for (size_t v = 0; v < count; ++v) keep(v);
    else
      for (const uint32_t v : usedVertices(per_part[i])) keep(v);
    mesh.lobes.insert(mesh.lobes.end(), own.begin(), own.end());
    first += count;
  }
  return level;
}

// A cloud with its lobes.
struct BakedCloud {
  Cloud cloud;
  std::vector<Lobe> lobes;
  std::vector<float> harmonics;
};

// A level takes triangles from each primitive, so that primitives that share a part are taken apart. Nothing if none do.
std::optional<BakedCloud> perPrimitive(const Cloud& cloud, std::span<const Lobe> lobes, std::span<const float> harmonics) {
  std::vector<PartSource> sources;
  auto taken_apart = withPartPerPrimitive(
      cloud.sculpt, [&](size_t part) { return !isDeformed(cloud.sculpt, part); }, &sources);
  if (!taken_apart) return std::nullopt;
  BakedCloud own;
  own.cloud.sculpt = std::move(*taken_apart);
  own.cloud.surface = surfaceInScene(own.cloud.sculpt);
  std::vector<size_t> first_vertex{0};
  for (const SculptPart& part : cloud.sculpt.parts) first_vertex.push_back(first_vertex.back() + part.positions.size());
  const size_t per_vertex = lobes.empty() ? 0 : harmonics.size() / lobes.size();
  for (const PartSource& source : sources)
    for (const uint32_t v : source.vertices) {
      const size_t vertex = first_vertex[source.part] + v;
      own.lobes.push_back(lobes[vertex]);
      const auto row = harmonics.subspan(vertex * per_vertex, per_vertex);
      own.harmonics.insert(own.harmonics.end(), row.begin(), row.end());
    }
  return own;
}

// What all levels are compared with, made once.
class FullCloud {
 public:
  explicit FullCloud(BakedMesh full)
      : full_(std::move(full)),
        surface_(nearestSurface(full_.surface)),
        points_(spreadOverSurface(full_.surface, kComparedPoints)),
        popping_(full_) {
    for (const SurfacePoint& point : points_) positions_.push_back(valueAt(point, full_.surface.positions));
    transmittances_.resize(points_.size() * lights_.size());
    parallelFor(points_.size(), [&](size_t i) {
      const Lobe lobe = blendedLobe(points_[i], full_.lobes);
      for (size_t j = 0; j < lights_.size(); ++j)
        transmittances_[i * lights_.size() + j] = lobeTransmittance(lobe, lights_[j], full_.info.shape, full_.info.extinction);
    });
  }

  const BakedMesh& mesh() const { return full_; }
  const Popping& popping() const { return popping_; }

  LevelFigures figuresOf(const BakedMesh& level) const {
    const auto level_surface = nearestSurface(level.surface);
    LevelFigures figures;
    figures.vertices = level.surface.positions.size();
    figures.triangles = level.surface.triangles.size();
    figures.switch_pixels = level.info.switch_pixels;
    figures.distance = distanceTo(level.surface, *level_surface);
    figures.transmittance_rms = transmittanceRms(level.lobes, level_surface->nearestTo(positions_));
    return figures;
  }

 private:
  // The larger of both ways, as shares of the full surface's longest side.
  SurfaceError distanceTo(const SurfaceMesh& level, const NearestSurface& level_surface) const {
    const SurfaceError there = surface_->errorOf(level), back = level_surface.errorOf(full_.surface);
    const double scale = double(boundingBox(level).longestSide()) / double(boundingBox(full_.surface).longestSide());
    return {std::max(there.rms, scale * back.rms), std::max(there.largest, scale * back.largest)};
  }

  // `nearest`: to points_, on the level.
  double transmittanceRms(std::span<const Lobe> level_lobes, const std::vector<SurfacePoint>& nearest) const {
    std::vector<double> squares(points_.size());
    parallelFor(points_.size(), [&](size_t i) {
      const Lobe lobe = blendedLobe(nearest[i], level_lobes);
      for (size_t j = 0; j < lights_.size(); ++j) {
        const double difference =
            transmittances_[i * lights_.size() + j] - lobeTransmittance(lobe, lights_[j], full_.info.shape, full_.info.extinction);
        squares[i] += difference * difference;
      }
    });
    double sum = 0;
    for (const double square : squares) sum += square;
    return std::sqrt(sum / double(std::max<size_t>(1, points_.size() * lights_.size())));
  }

  BakedMesh full_;
  std::unique_ptr<const NearestSurface> surface_;
  std::vector<SurfacePoint> points_;
  std::vector<Vec3> positions_;
  const std::vector<Vec3> lights_ = bothSenses(sweepAxes(kComparedLights));
  std::vector<float> transmittances_;  // of points_ under each light
  Popping popping_;
};

// Levels of `counts` vertices.
std::vector<LevelAsset> levelsOf(const Cloud& cloud, std::span<const Lobe> lobes, std::span<const float> harmonics,
                                 const std::vector<size_t>& counts, const Settings& settings, BakeReport& report) {
  const std::vector<bool> held = heldVertices(cloud.sculpt, report.warnings);
  std::vector<std::vector<Triangle>> all_triangles;
  std::optional<FullCloud> full_cloud;
  // Simplification takes one thread, and does not wait for the other.
  parallelFor(2, [&](int job) {
    if (job == 0)
      all_triangles = simplified(withoutRepeats(cloud), weighedLight(lobes, report.info.extinction), held, counts);
    else
      full_cloud.emplace(BakedMesh{cloud.surface, {lobes.begin(), lobes.end()}, report.info, {harmonics.begin(), harmonics.end()}});
  });
  std::vector<LevelAsset> assets(counts.size());
  std::vector<LevelFigures> figures(counts.size());
  parallelFor(counts.size(), [&](size_t i) {
    BakedMesh mesh;
    const Level level = levelOf(cloud, trianglesPerPart(cloud.sculpt, all_triangles[i], held), full_cloud->mesh(), mesh);
    mesh.info.level = int(i + 1);
    std::vector<SizeChange> changes = full_cloud->popping().changesBy(mesh);
    mesh.info.switch_pixels = switchPixels(changes);
    Warnings told;  // the full asset has them too
    assets[i] = {levelFile(settings.output.file, i + 1),
                 encodeGlb(level.sculpt, level.lobes_per_part, mesh.info, settings.output.gltf, told, mesh.harmonics), std::move(changes)};
    figures[i] = full_cloud->figuresOf(mesh);
    figures[i].file = assets[i].file.string();
  });
  for (size_t i = 0; i < counts.size(); ++i)
    if (figures[i].vertices > counts[i])
      report.warnings.add(WarningKind::kVertexBudget, "level " + std::to_string(i + 1) + " has " + std::to_string(figures[i].vertices) +
                                                          " vertices, not " + std::to_string(counts[i]) +
                                                          ", because fewer would tear seams or borders, or ruin the shape");
  std::ranges::move(figures, std::back_inserter(report.levels));
  return assets;
}

}  // namespace

std::vector<std::filesystem::path> staleLevels(const std::filesystem::path& output, size_t levels) {
  std::vector<std::filesystem::path> stale;
  for (size_t level = levels + 1; level <= kMostLevels; ++level) try {
      const std::filesystem::path file = levelFile(output, level);
      if (const std::string bytes = readFileBytes(file); isBakedAsset(file, bytes) || isImpostor(bytes)) stale.push_back(file);
    } catch (const Error&) {  // most often there is none
    }
  return stale;
}

std::filesystem::path levelFile(const std::filesystem::path& output, size_t level) {
  std::filesystem::path file = output;
  return file.replace_filename(output.stem().string() + "_lod" + std::to_string(level) + output.extension().string());
}

std::vector<LevelAsset> makeLevels(const Cloud& cloud, std::span<const Lobe> lobes, std::span<const float> harmonics,
                                   const Settings& settings, BakeReport& report, Stopwatch& watch) {
  const size_t full = lobes.size();
  std::vector<size_t> counts;
  for (const LevelSize& size : settings.mesh.levels) counts.push_back(std::max<size_t>(4, size.vertices(full)));
  if (counts.front() >= full) throw InputError("", "--lods: the asset has " + std::to_string(full) + " vertices; give fewer than these");
  const auto own = perPrimitive(cloud, lobes, harmonics);
  std::vector<LevelAsset> assets = own ? levelsOf(own->cloud, own->lobes, own->harmonics, counts, settings, report)
                                       : levelsOf(cloud, lobes, harmonics, counts, settings, report);
  watch.lap(report.seconds, "levels");
  return assets;
}

}  // namespace cloudbake
