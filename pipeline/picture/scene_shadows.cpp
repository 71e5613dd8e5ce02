// "On Mesh Cloud Rendering" (2019-06-30), after Sea of Thieves: the transmittance of a cloud's own lobe times what opaque things let
// through. Here every thing lets some of the light through: the ground what its ridges clear, a mesh cloud exp(−σ ℓ) of its field, clouds
// of noise what an eye would see through them.
#include "pipeline/picture/scene_shadows.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "bake/mesh/mesh_topology.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/portable_math.h"
#include "pipeline/fields/fields.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

constexpr size_t kTogether = 1024;  // points whose shares are found side by side

// The shares of many points, by several threads.
std::vector<float> sharesAt(std::span<const Vec3> points, const LightPassage& passage) {
  std::vector<float> shares(points.size(), 1);
  const size_t blocks = (points.size() + kTogether - 1) / kTogether;
  parallelFor(blocks, [&](size_t block) {
    const size_t first = block * kTogether, count = std::min(kTogether, points.size() - first);
    passage(points.subspan(first, count), std::span(shares).subspan(first, count));
  });
  return shares;
}

// A ball around an instance and its field, which is a cell larger.
struct Ball {
  Vec3 center;
  float radius;
  explicit Ball(const Instance& instance) {
    constexpr float kCells = 1 + 4.0F / kCasterVoxels;
    const Box box = placedBox(instance);
    center = box.center(), radius = kCells * box.diagonal() / 2;
  }
};

// Which instances may shadow something that is drawn. Of the clouds of fields in a scene without other layers, these are the clouds whose
// ball, seen from the light, is before the ball of a cloud in the picture.
std::vector<size_t> castersOf(const SceneFile& scene, std::span<const Instance> instances, Vec3 to_light) {
  const bool has_layers = scene.terrain || !scene.slabs.empty() || !scene.distance_clouds.empty() || !scene.density_clouds.empty();
  const float spread = 2 * float(tanDegrees(scene.shadows.softness_degrees));  // more than the diagonal of a square
  std::vector<Ball> seen;
  for (const Instance& instance : instances)
    if (instance.is_seen) seen.emplace_back(instance);
  const auto mayShadow = [&](const Instance& instance) {
    if (!instance.scattered || has_layers) return true;
    const Ball ball(instance);
    return std::any_of(seen.begin(), seen.end(), [&](const Ball& other) {
      const Vec3 way = other.center - ball.center;
      const float both = ball.radius + other.radius, along = -dot(way, to_light);
      if (along < -both) return false;
      const float aside = both + spread * (along + both);
      return dot(way, way) - along * along <= aside * aside;
    });
  };
  std::vector<uint8_t> may(instances.size());
  parallelFor(instances.size(), [&](size_t i) { may[i] = instances[i].caster && mayShadow(instances[i]); });
  std::vector<size_t> casters;
  for (size_t i = 0; i < may.size(); ++i)
    if (may[i]) casters.push_back(i);
  return casters;
}

// Where the shadow of an instance in a grid is cast from: a cloud of a field is turned to the nearest of a few angles, as in the page of
// `view`, which makes one shadow per mesh and angle.
Affine shadingPlace(const Instance& instance) {
  if (!instance.scattered) return instance.to_world;
  constexpr float kTurn = 360.0F / 64;
  const float turn = instance.scattered->turn_degrees;
  Affine place = compose(placement({}, {0, std::floor(turn / kTurn + 0.5F) * kTurn - turn, 0}, {1, 1, 1}), instance.to_world);
  place.offset = instance.to_world.offset;
  return place;
}

// Shadows that are made side by side.
template <typename Make>
std::vector<CloudShadow> shadowsOf(size_t count, const Make& make) {
  std::vector<std::optional<CloudShadow>> made(count);
  parallelFor(count, [&](size_t k) { made[k].emplace(make(k)); });
  std::vector<CloudShadow> shadows;
  shadows.reserve(count);
  for (std::optional<CloudShadow>& shadow : made) shadows.push_back(std::move(*shadow)), shadow.reset();
  return shadows;
}

}  // namespace

std::optional<ShadeExtent> shadeExtent(std::span<const Instance> instances) {
  ShadeExtent extent;
  double sides = 0;
  size_t casting = 0;
  for (const Instance& instance : instances) {
    if (!instance.caster) continue;
    if (casting++ == 0 && instance.scattered) extent.wind = instance.scattered->wind;
    const Box drawn = instance.scattered ? instance.scattered->field : placedBox(instance);
    const float side = instance.scattered ? instance.scattered->longest_side : drawn.longestSide();
    sides += double(side);
    const float more = side * float(2 * kShadeCoarser) / kCasterVoxels;  // the cells of a caster reach beyond its mesh
    if (drawn.empty()) continue;
    extent.box.add(drawn.low - Vec3{more, more, more});
    extent.box.add(drawn.high + Vec3{more, more, more});
  }
  if (extent.box.empty()) return std::nullopt;
  extent.cloud_size = std::max(float(sides / double(casting)), 1e-30F);
  return extent;
}

std::optional<SceneShade> shadeOf(std::span<const Instance> instances, const LightSettings& light, const ShadowSettings& shadows,
                                  Vec3 to_light) {
  const std::optional<ShadeExtent> extent = shadeExtent(instances);
  if (!extent) return std::nullopt;
  SceneShade shade;
  std::map<const ShadowCaster*, ShadowCaster> coarse;
  std::vector<size_t> casting;
  for (size_t i = 0; i < instances.size(); ++i) {
    const ShadowCaster* const caster = instances[i].caster;
    shade.number.push_back(casting.size());
    if (!caster) continue;
    if (!coarse.contains(caster)) coarse[caster] = coarserCaster(*caster, kShadeCoarser);
    casting.push_back(i);
  }
  const std::vector<CloudShadow> all = shadowsOf(casting.size(), [&](size_t k) {
    const Instance& instance = instances[casting[k]];
    return CloudShadow(coarse.at(instance.caster), shadingPlace(instance), worldExtinction(instance, light), to_light, shadows);
  });
  const ShadeGridSettings settings{.cloud_size = extent->cloud_size, .wind = extent->wind.value_or(Vec3{})};
  shade.grid = ShadeGrid(shadeFrame(extent->box, to_light, settings), all, to_light);
  return shade;
}

ShadowCaster shadowCasterOf(const BakedMesh& mesh, int voxels, uint64_t memory_limit) {
  Cloud cloud;
  cloud.surface = mesh.surface;
  cloud.closed = findDefects(cloud.surface).unmatched_edges == 0;
  FieldSettings settings;
  settings.bake_voxels = voxels;
  settings.memory_limit = memory_limit;
  Warnings told_by_the_bake;
  const CoverageField field = buildField(cloud, settings, Method::kSweep, told_by_the_bake).coverage.value();
  ShadowCaster caster;
  caster.cells = field.cells;
  caster.cell_size = float(field.frame.voxel_size);
  caster.origin = field.frame.toWorld({float(field.first[0]), float(field.first[1]), float(field.first[2])});
  for (const float fraction : field.fractions) caster.fractions.push_back(uint8_t(std::lround(255 * fraction)));
  return caster;
}

std::optional<ShadowCaster> shadowCasterOf(const BakedMesh& mesh, Warnings& warnings) {
  try {
    return shadowCasterOf(mesh, kCasterVoxels);
  } catch (const MemoryError&) {
    throw;
  } catch (const InputError& error) {
    warnings.add(WarningKind::kFieldFallback, std::string("a cloud casts no shadow: ") + error.what());
    return std::nullopt;
  }
}

bool drawsShadows(const SceneFile& scene) {
  const size_t things = scene.clouds.size() + 2 * scene.fields.size() + (scene.terrain ? 1 : 0) + scene.slabs.size() +
                        scene.distance_clouds.size() + scene.density_clouds.size();
  return scene.shadows.are_drawn && scene.shadows.strength > 0 && things > 1 && !scene.compares_techniques;
}

SceneShadows::SceneShadows(const SceneFile& scene, std::span<const Instance> instances) : scene_(scene), instances_(instances) {
  if (!drawsShadows(scene)) return;
  const Vec3 to_light = keyLight(scene.light.sky).direction;
  if (scene.shadows.cloud_shade == CloudShade::kGrid)
    makeGrid(to_light);
  else
    makeShadows(to_light);

  const auto add = [&](Kind kind, size_t index, LightPassage passage) { others_.push_back({kind, index, std::move(passage)}); };
  if (scene.terrain)
    add(Kind::kTerrain, 0, [&terrain = *scene.terrain, to_light](std::span<const Vec3> points, std::span<float> shares) {
      passTerrain(points, to_light, terrain, shares);
    });
  // Clouds of noise let through the less the stronger shadows are.
  const auto addNoise = [&](Kind kind, const auto& all, const auto& pass) {
    for (size_t i = 0; i < all.size(); ++i)
      add(kind, i,
          [&settings = all[i], to_light, pass, strength = scene.shadows.strength](std::span<const Vec3> points, std::span<float> shares) {
            std::vector<float> own(points.size(), 1);
            pass(points, to_light, settings, own);
            for (size_t k = 0; k < own.size(); ++k) shares[k] *= lerp(1, own[k], strength);
          });
  };
  addNoise(Kind::kSlab, scene.slabs, passSlab);
  addNoise(Kind::kDistance, scene.distance_clouds, passDistanceClouds);
  addNoise(Kind::kDensity, scene.density_clouds, passDensityClouds);
}

void SceneShadows::makeShadows(Vec3 to_light) {
  std::vector<size_t> owners = castersOf(scene_, instances_, to_light);
  std::vector<CloudShadow> shadows = shadowsOf(owners.size(), [&](size_t k) {
    const Instance& instance = instances_[owners[k]];
    return CloudShadow(*instance.caster, instance.to_world, worldExtinction(instance, scene_.light), to_light, scene_.shadows);
  });
  meshes_ = CloudShadows(std::move(shadows), std::move(owners), to_light);
}

void SceneShadows::makeGrid(Vec3 to_light) {
  std::optional<SceneShade> shade = shadeOf(instances_, scene_.light, scene_.shadows, to_light);
  if (!shade) return;
  grid_ = std::move(shade->grid);
  others_of_.resize(instances_.size());
  parallelFor(instances_.size(), [&](size_t i) {
    if (instances_[i].is_seen && instances_[i].caster) others_of_[i] = grid_->pastOthers(shade->number[i]);
  });
}

LightPassage SceneShadows::pastMeshes(bool are_lit_meshes, size_t owner) const {
  if (are_lit_meshes && scene_.shadows.cloud_shade == CloudShade::kNone) return {};
  if (grid_) {
    const bool has_own = owner < others_of_.size() && others_of_[owner];
    const ShadeBlock& block = has_own ? *others_of_[owner] : grid_->pastAll();
    return [&block, &frame = grid_->frame()](std::span<const Vec3> points, std::span<float> shares) {
      for (size_t k = 0; k < points.size(); ++k) shares[k] *= block.shareAt(frame.place(points[k]));
    };
  }
  if (!meshes_.anyExceptOf(owner)) return {};
  return [this, owner](std::span<const Vec3> points, std::span<float> shares) { meshes_.pass(points, shares, owner); };
}

LightPassage SceneShadows::pastAll(bool with_meshes, bool with_others, Kind but, size_t index) const {
  const size_t owner = but == Kind::kMesh ? index : CloudShadows::kNobody;
  std::vector<const LightPassage*> those;
  for (const Thing& thing : others_)
    if (with_others && (thing.kind != but || thing.index != index)) those.push_back(&thing.passage);
  LightPassage meshes = with_meshes ? pastMeshes(but == Kind::kMesh && index != CloudShadows::kNobody, owner) : LightPassage{};
  if (!meshes && those.empty()) return {};
  return [meshes = std::move(meshes), those](std::span<const Vec3> points, std::span<float> shares) {
    if (meshes) meshes(points, shares);
    for (const LightPassage* one : those) (*one)(points, shares);
  };
}

LightPassage SceneShadows::past(Kind kind, size_t index) const { return pastAll(true, true, kind, index); }

Vec3 SceneShadows::skyShare() const {
  const SkyColors colors = lightColors(scene_.light.sky);
  return quotient(colors.ambient_sky, colors.ambient_sky + colors.sun_color);
}

MarchedShadow SceneShadows::onSamples() const { return {pastAll(true, false, Kind::kMesh, CloudShadows::kNobody), skyShare()}; }

std::vector<std::vector<float>> SceneShadows::sharesOfVertices() const {
  std::vector<std::vector<float>> shares(instances_.size());
  for (size_t i = 0; i < instances_.size(); ++i)
    if (const LightPassage passage = instances_[i].is_seen ? past(Kind::kMesh, i) : LightPassage{})
      shares[i] = sharesAt(worldPositions(instances_[i]), passage);
  return shares;
}

void SceneShadows::darken(std::span<Layer> layers, Kind kind, size_t index, const Camera& camera) const {
  const bool is_marched = kind == Kind::kDistance || kind == Kind::kDensity;
  const MarchedShadow shadow{pastAll(!is_marched, true, kind, index), skyShare()};
  if (!shadow.passage) return;
  const CameraRays rays(camera);
  for (Layer& layer : layers) {
    const std::vector<Vec2> places = pixelPlaces(layer.samples_per_side);
    parallelFor(layer.height, [&](int y) {
      std::vector<LayerPixel*> pixels;
      std::vector<Vec3> points;
      for (int x = 0; x < layer.width; ++x)
        for (int i = 0; i < layer.samples(); ++i) {
          LayerPixel& pixel = layer.at(x, y, i);
          if (!(pixel.opacity > 0)) continue;
          const Ray ray = rays.at(float(x) + places[size_t(i)].x, float(camera.first_row + y) + places[size_t(i)].y);
          pixels.push_back(&pixel);
          points.push_back(ray.origin + ray.direction * pixel.distance);
        }
      std::vector<float> shares(points.size(), 1);
      shadow.passage(points, shares);
      for (size_t i = 0; i < pixels.size(); ++i) pixels[i]->color = pixels[i]->color * shadow.factor(shares[i]);
    });
  }
}

}  // namespace cloudbake
