// "On Mesh Cloud Rendering" (2019-06-30), after Sea of Thieves (SIGGRAPH 2018), its fields per vertex:
//   R = T(sun) · lerp(f, 1, n·l/2 + 1/2)      G = T(+Y)
// with the half-Lambert factor of its project maajor/Mesh-Cloud-Rendering. A transform M moves the thickness o·d as a vector, and normals
// by the inverse transpose. RayScene finds the triangles; distances and barycentric coordinates are computed here, because the last bits of
// Embree's depend on the CPU. There are other shades for comparison: exact transmittance, and Lambert's surface,
//   R = exp(−σ ℓ_sun), G = exp(−σ ℓ_sky)      R = max(0, n·l), G = ½ + ½ n.y
#include "preview/mesh_clouds/lit_mesh.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "core/harmonics.h"
#include "core/lobe_lighting.h"
#include "core/lobe_packing.h"
#include "core/parallel.h"
#include "core/vertex_normals.h"
#include "preview/camera.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

// No bit changes if the transform does not turn or scale.
bool isTranslation(const Affine& m) { return m.linear == Affine{}.linear; }

// The frame of a mesh that spans a box.
LitMesh frameOf(const Box& box) {
  LitMesh lit;
  lit.center = box.empty() ? Vec3{} : box.center();
  if (box.longestSide() > 0) lit.size = box.longestSide();
  return lit;
}

// Normals in the world: given ones by the inverse transpose, missing ones from the placed triangles.
std::vector<Vec3> worldNormals(const Instance& instance, std::span<const Vec3> placed, std::span<const Triangle> triangles) {
  const SurfaceMesh& surface = instance.mesh->surface;
  if (surface.normals.size() != surface.positions.size()) return vertexNormals(placed, triangles);
  if (isTranslation(instance.to_world)) return surface.normals;
  const Affine inverse = inverted(instance.to_world).value();
  Affine transposed;
  for (size_t r = 0; r < 3; ++r)
    for (size_t c = 0; c < 3; ++c) transposed.linear[r][c] = inverse.linear[c][r];
  std::vector<Vec3> normals;
  for (const Vec3& n : surface.normals) normals.push_back(normalized(transformVector(transposed, n)).value_or(Vec3{}));
  return normals;
}

// A mirror reverses the triangles: this reverses them back.
std::vector<Triangle> worldTriangles(const Instance& instance) {
  std::vector<Triangle> triangles = instance.mesh->surface.triangles;
  if (determinant(instance.to_world) < 0)
    for (Triangle& t : triangles) std::swap(t[1], t[2]);
  return triangles;
}

LobeShape worldShape(const Instance& instance) {
  const LobeShape& own = instance.mesh->info.shape;
  return {own.exponent, own.bias * unitScale(instance.to_world)};
}

void checkInstance(const Instance& instance) {
  const BakedMesh& mesh = *instance.mesh;
  if (mesh.lobes.size() != mesh.surface.positions.size()) throw std::invalid_argument("placeMeshes: a mesh needs one lobe per vertex");
  if (!mesh.harmonics.empty() && mesh.harmonics.size() != mesh.lobes.size() * harmonicCount(mesh.info.harmonic_order))
    throw std::invalid_argument("placeMeshes: harmonics are of another number of vertices");
  if (!mesh.colors.empty() && mesh.colors.size() != mesh.lobes.size())
    throw std::invalid_argument("placeMeshes: not one colour per vertex");
  if (!instance.sun_shares.empty() && instance.sun_shares.size() != mesh.lobes.size())
    throw std::invalid_argument("placeMeshes: not one share of the sun per vertex");
  if (!inverted(instance.to_world)) throw std::invalid_argument("placeMeshes: a transform cannot be inverted");
}

// T at a placed mesh's vertices, from their harmonics or from their lobes.
class VertexTransmittance {
 public:
  VertexTransmittance(const Instance& instance, const LightSettings& light)
      : mesh_(*instance.mesh),
        to_world_(instance.to_world),
        to_own_(*inverted(instance.to_world)),
        extinction_(worldExtinction(instance, light)),
        shape_(worldShape(instance)),
        coefficients_(light.lobes_only || mesh_.lobes.empty() ? 0 : mesh_.harmonics.size() / mesh_.lobes.size()) {}

  float towards(size_t vertex, Vec3 to_light) const {
    if (coefficients_ == 0) return lobeTransmittance(transformedLobe(mesh_.lobes[vertex], to_world_), to_light, shape_, extinction_);
    const auto own = std::span(mesh_.harmonics).subspan(vertex * coefficients_, coefficients_);
    return placedTransmittance(own, to_light, to_own_, mesh_.info.extinction, extinction_);
  }

 private:
  const BakedMesh& mesh_;
  const Affine& to_world_;
  const Affine to_own_;
  float extinction_;
  LobeShape shape_;
  size_t coefficients_;  // per vertex; 0: lobes
};

// The light of all lamps at each vertex, by its lobe.
std::vector<Vec3> lightOfLamps(const Instance& instance, std::span<const Vec3> normals, const LightSettings& light) {
  const LobeShape shape = worldShape(instance);
  const float extinction = worldExtinction(instance, light);
  std::vector<Vec3> sums(instance.mesh->lobes.size());
  parallelFor(sums.size(), [&](size_t i) {
    const Lobe lobe = transformedLobe(instance.mesh->lobes[i], instance.to_world);
    const Vec3 place = transformPoint(instance.to_world, instance.mesh->surface.positions[i]);
    for (const Lamp& lamp : light.lamps) sums[i] += lampLight(lamp, lobe, place, normals[i], light.half_lambert, shape, extinction);
  });
  return sums;
}

// Where an instance is in a mesh of several.
struct InstancePlace {
  const Instance* instance;
  size_t first_vertex, first_triangle;
};

// Places one instance in the frame of `lit`, which has room for it, and lights it.
void placeInstance(const InstancePlace& place, const LightSettings& light, LitMesh& lit) {
  const Instance& instance = *place.instance;
  const BakedMesh& mesh = *instance.mesh;
  const auto positions = std::span(lit.positions).subspan(place.first_vertex, mesh.surface.positions.size());
  const auto shades = std::span(lit.shades).subspan(place.first_vertex, positions.size());
  for (size_t i = 0; i < positions.size(); ++i) positions[i] = lit.toFrame(transformPoint(instance.to_world, mesh.surface.positions[i]));

  const std::vector<Triangle> triangles = worldTriangles(instance);
  const auto first = uint32_t(place.first_vertex);
  for (size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    lit.triangles[place.first_triangle + t] = {a + first, b + first, c + first};
  }
  if (light.shown == ShownLight::kOwnRedGreen || light.shown == ShownLight::kOwnBlue) {
    const std::vector<Vec3> own = ownColors(mesh);
    for (size_t i = 0; i < own.size(); ++i)
      shades[i] = light.shown == ShownLight::kOwnRedGreen ? Shade{own[i].x, own[i].y} : Shade{own[i].z, 0};
    return;
  }
  const auto normals = worldNormals(instance, positions, triangles);
  if (light.shown != ShownLight::kSunAndSky) {
    const std::vector<Vec3> lamps = lightOfLamps(instance, normals, light);
    for (size_t i = 0; i < lamps.size(); ++i)
      shades[i] = light.shown == ShownLight::kLampsRedGreen ? Shade{lamps[i].x, lamps[i].y} : Shade{lamps[i].z, 0};
    return;
  }
  const VertexTransmittance transmittance(instance, light);
  const Vec3 to_light = keyLight(light.sky).direction;
  const float gain = mesh.info.volume ? light.volume_gain : 1;
  for (size_t i = 0; i < mesh.lobes.size(); ++i) {
    const float share = instance.sun_shares.empty() ? 1 : instance.sun_shares[i];
    const float sun = std::min(gain * transmittance.towards(i, to_light), 1.0F);
    shades[i] = {sun * surfaceFactor(normals[i], to_light, light.half_lambert) * share,
                 transmittance.towards(i, {0, 1, 0}) * surfaceFactor(normals[i], {0, 1, 0}, light.half_lambert_sky)};
  }
}

// Where the line of a ray meets the plane of a triangle (Möller and Trumbore 1997), in double. None if they are parallel.
std::optional<Crossing> crossTriangle(const LitMesh& lit, uint32_t index, const Ray& ray) {
  const auto& [ia, ib, ic] = lit.triangles[index];
  const Vec3 a = lit.positions[ia], e = lit.positions[ib] - a, f = lit.positions[ic] - a, s = ray.origin - a, d = ray.direction;
  const auto triple = [](Vec3 u, Vec3 v, Vec3 w) {
    return double(u.x) * (double(v.y) * w.z - double(v.z) * w.y) + double(u.y) * (double(v.z) * w.x - double(v.x) * w.z) +
           double(u.z) * (double(v.x) * w.y - double(v.y) * w.x);
  };
  const double determinant = triple(e, d, f);  // > 0 if the triangle faces the ray's origin
  if (determinant == 0) return std::nullopt;
  const double u = std::clamp(triple(s, d, f) / determinant, 0.0, 1.0), v = std::clamp(triple(e, d, s) / determinant, 0.0, 1.0 - u);
  const double t = triple(e, s, f) / -determinant;
  if (!std::isfinite(t)) return std::nullopt;

  const Shade &p = lit.shades[ia], &q = lit.shades[ib], &r = lit.shades[ic];
  const float weight_q = float(u), weight_r = float(v), weight_p = 1 - weight_q - weight_r;
  Crossing crossing{float(t),
                    determinant > 0 ? 1 : -1,
                    index,
                    {weight_p * p.sun + weight_q * q.sun + weight_r * r.sun, weight_p * p.sky + weight_q * q.sky + weight_r * r.sky}};
  if (!lit.colors.empty()) crossing.color = lit.colors[ia] * weight_p + lit.colors[ib] * weight_q + lit.colors[ic] * weight_r;
  return crossing;
}

bool isBefore(const Crossing& a, const Crossing& b) {
  if (a.t != b.t) return a.t < b.t;
  return a.sign != b.sign ? a.sign > b.sign : a.triangle < b.triangle;
}

// Calls visit(triangle) for every triangle that the ray meets, in no particular order.
template <typename Visit>
void visitTriangles(const LitMesh& lit, const Ray& ray, const Visit& visit) {
  if (lit.rays) lit.rays->forHits(ray, [&](const RayHit& hit) { visit(hit.triangle); });
}

// `forMet` calls what it is given with every triangle that the ray meets.
template <typename ForMet>
void findCrossings(const LitMesh& lit, const Ray& ray, std::vector<Crossing>& crossings, const ForMet& forMet) {
  crossings.clear();
  forMet([&](uint32_t triangle) {
    if (const auto crossing = crossTriangle(lit, triangle, ray)) crossings.push_back(*crossing);
  });
  std::sort(crossings.begin(), crossings.end(), isBefore);
}

}  // namespace

LightSettings lightForSun(float azimuth_degrees, float elevation_degrees) {
  LightSettings light;
  light.sky.to_sun = directionFromAngles(azimuth_degrees, elevation_degrees);
  light.sky.colors = skyColorsForSun(light.sky.to_sun.y);
  return light;
}

std::vector<Vec3> ownColors(const BakedMesh& mesh) {
  return mesh.colors.empty() ? std::vector<Vec3>(mesh.surface.positions.size(), {1, 1, 1}) : mesh.colors;
}

bool haveOwnColors(std::span<const Instance> instances, const LightSettings& light) {
  return light.own_colors && std::ranges::any_of(instances, [](const Instance& one) { return one.is_seen && !one.mesh->colors.empty(); });
}

Lobe transformedLobe(const Lobe& lobe, const Affine& to_world) {
  if (isTranslation(to_world)) return lobe;
  return mappedLobe(lobe, to_world);
}

float unitScale(const Affine& to_world) {
  if (isTranslation(to_world)) return 1;
  // Divide by the largest entry first, because the determinant of a small scale is outside the range of float.
  double largest = 0;
  for (const auto& row : to_world.linear)
    for (const double entry : row) largest = std::max(largest, std::abs(entry));
  Affine scaled = to_world;
  for (auto& row : scaled.linear)
    for (double& entry : row) entry /= largest;
  return float(largest) * std::cbrt(float(std::abs(determinant(scaled))));
}

float worldExtinction(const Instance& instance, const LightSettings& light) {
  if (light.extinction) return *light.extinction;
  float own = instance.mesh->info.extinction;
  if (!(own > 0)) {
    const float size = drawnBox(instance.mesh->surface).longestSide();
    own = kDefaultExtinctionTimesSize / (size > 0 ? size : 1);
  }
  return own / unitScale(instance.to_world);
}

Box drawnBox(const SurfaceMesh& surface, const Affine& to_world) {
  std::vector<uint8_t> is_drawn(surface.positions.size());
  for (const Triangle& triangle : surface.triangles)
    for (const uint32_t v : triangle) is_drawn[v] = 1;
  Box box;
  for (size_t v = 0; v < is_drawn.size(); ++v)
    if (is_drawn[v]) box.add(transformPoint(to_world, surface.positions[v]));
  return box;
}

Box placedBox(const Instance& instance) {
  if (!instance.scattered && !instance.whole) return drawnBox(instance.mesh->surface, instance.to_world);
  const Box& own = instance.scattered ? instance.scattered->own : *instance.whole;
  Box box;
  for (int i = 0; i < 8 && !own.empty(); ++i) box.add(transformPoint(instance.to_world, own.corner(i)));
  return box;
}

float placedTransmittance(std::span<const float> coefficients, Vec3 to_light, const Affine& to_own, float own, float extinction) {
  const Vec3 back = transformVector(to_own, to_light);
  const float stretch = length(back);
  if (!(stretch > 0) || !(own > 0)) return harmonicTransmittance(coefficients, to_light);
  const float transmittance = harmonicTransmittance(coefficients, back / stretch), power = extinction / (own * stretch);
  return std::abs(power - 1) < 1e-5F ? transmittance : std::pow(transmittance, power);
}

std::vector<Vec3> worldPositions(const Instance& instance) {
  std::vector<Vec3> positions;
  for (const Vec3& p : instance.mesh->surface.positions) positions.push_back(transformPoint(instance.to_world, p));
  return positions;
}

PlacedMesh placedMesh(const Instance& instance, const LightSettings& light) {
  checkInstance(instance);
  PlacedMesh placed{worldPositions(instance), {}, {}, worldTriangles(instance), worldShape(instance), worldExtinction(instance, light)};
  placed.normals = worldNormals(instance, placed.positions, placed.triangles);
  for (const Lobe& lobe : instance.mesh->lobes) placed.lobes.push_back(transformedLobe(lobe, instance.to_world));
  return placed;
}

LitMesh placeMeshes(std::span<const Instance> instances, const LightSettings& light) {
  Box box;
  for (const Instance& instance : instances) {
    if (!instance.is_seen) continue;
    checkInstance(instance);
    const Box drawn = placedBox(instance);
    if (drawn.empty()) continue;
    box.add(drawn.low);
    box.add(drawn.high);
  }
  LitMesh lit = frameOf(box);
  std::vector<InstancePlace> places;
  size_t vertices = 0, triangles = 0;
  for (const Instance& instance : instances) {
    if (!instance.is_seen || instance.mesh->impostor) continue;
    places.push_back({&instance, vertices, triangles});
    vertices += instance.mesh->surface.positions.size(), triangles += instance.mesh->surface.triangles.size();
  }
  lit.positions.resize(vertices), lit.shades.resize(vertices), lit.triangles.resize(triangles);
  parallelFor(places.size(), [&](size_t i) { placeInstance(places[i], light, lit); });
  return lit;
}

LitMesh lightMeshes(std::span<const Instance> instances, const LightSettings& light) {
  LitMesh lit = placeMeshes(instances, light);
  if (haveOwnColors(instances, light))
    for (const Instance& instance : instances)
      if (instance.is_seen && !instance.mesh->impostor) std::ranges::copy(ownColors(*instance.mesh), std::back_inserter(lit.colors));
  return lit;
}

LitMesh shadedMesh(const BakedMesh& mesh, std::span<const Shade> shades) {
  if (shades.size() != mesh.surface.positions.size()) throw std::invalid_argument("shadedMesh: a mesh needs one shade per vertex");
  LitMesh lit = frameOf(drawnBox(mesh.surface));
  for (const Vec3& p : mesh.surface.positions) lit.positions.push_back(lit.toFrame(p));
  lit.shades.assign(shades.begin(), shades.end());
  lit.triangles = mesh.surface.triangles;
  return lit;
}

void prepareForRays(LitMesh& lit, RaysToCome rays) {
  if (!lit.triangles.empty()) lit.rays = std::make_shared<const RayScene>(lit.positions, lit.triangles, rays);
}

std::vector<Shade> transmittanceShades(std::span<const float> to_sun, std::span<const float> to_sky, float extinction) {
  if (to_sun.size() != to_sky.size()) throw std::invalid_argument("transmittanceShades: as many lengths to the sun as to the sky");
  std::vector<Shade> shades(to_sun.size());
  for (size_t v = 0; v < shades.size(); ++v) shades[v] = {std::exp(-extinction * to_sun[v]), std::exp(-extinction * to_sky[v])};
  return shades;
}

std::vector<Shade> lambertShades(const SurfaceMesh& surface, Vec3 to_sun) {
  const bool given = surface.normals.size() == surface.positions.size();
  const std::vector<Vec3> normals = given ? surface.normals : vertexNormals(surface.positions, surface.triangles);
  std::vector<Shade> shades;
  for (const Vec3& n : normals) shades.push_back({std::max(0.0F, dot(n, to_sun)), 0.5F + 0.5F * n.y});
  return shades;
}

void findCrossings(const LitMesh& lit, const Ray& ray, std::vector<Crossing>& crossings) {
  findCrossings(lit, ray, crossings, [&](const auto& visit) { visitTriangles(lit, ray, visit); });
}

void findCrossings(const LitMesh& lit, const Ray& ray, std::span<const uint32_t> met, std::vector<Crossing>& crossings) {
  findCrossings(lit, ray, crossings, [&](const auto& visit) { std::for_each(met.begin(), met.end(), visit); });
}

std::optional<Crossing> nearestCrossing(const LitMesh& lit, const Ray& ray) {
  std::optional<Crossing> nearest;
  visitTriangles(lit, ray, [&](uint32_t triangle) {
    const auto crossing = crossTriangle(lit, triangle, ray);
    if (crossing && (!nearest || isBefore(*crossing, *nearest))) nearest = crossing;
  });
  return nearest;
}

Vec3 cloudColor(const Shade& shade, const SkyColors& colors) {
  return lerp(colors.ambient_ground, colors.sun_color, shade.sun) + lerp(colors.ambient_ground, colors.ambient_sky, shade.sky);
}

// --- Keys ---

const Keys<LightSettings>& lightKeys() {
  using S = LightSettings;
  static const Keys<S> keys{
      {"half_lambert", &S::half_lambert, 0, 1, "f of the factor lerp(f, 1, n·l/2 + 1/2) of the sun's term; 1: the lobe alone"},
      {"half_lambert_sky", &S::half_lambert_sky, 0, 1,
       "the same for the sky's term, with the direction up; 0.5 in maajor/Mesh-Cloud-Rendering"},
      {"volume_gain", &S::volume_gain, 0, 10, "factor of the sun's term of clouds that were fitted to a volume, up to all of the light"},
      {"own_colors", &S::own_colors, 0, 1, "clouds have the base colours of their sculpts: materials, textures and vertex colours",
       KeyUse::kScript},
      {"lobes_only", &S::lobes_only, 0, 1, "clouds are lit by their lobes even where an asset has harmonics", KeyUse::kScript,
       "'Light by' chooses it"},
      {"extinction", &S::extinction, 1e-9, 1e9, "σ of all mesh clouds per world unit, in place of their own", KeyUse::kScript,
       "'Density' multiplies σ"},
  };
  return keys;
}

}  // namespace cloudbake
