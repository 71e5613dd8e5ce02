// "On Mesh Cloud Rendering" (2019-06-30), after Sea of Thieves (SIGGRAPH 2018), its last step:
//   R = T_lobe(sun) · lerp(f, 1, n·l/2 + 1/2)      G = T_lobe(+Y)
//   C = lerp(ambient_ground, sun_color, R) + lerp(ambient_ground, ambient_sky, G)
// Soft edges: along a view ray the cloud fills intervals [a, b] between the surface's crossings, where the winding number
// is not 0. Each interval absorbs as a medium of extinction σ_v and shines in a colour that runs from C(a) to C(b),
//   ∫₀^τ e^{−x} (C(a) + (C(b) − C(a))·x/τ) dx = C(a)(1 − e^{−τ}) + (C(b) − C(a))·((1 − e^{−τ})/τ − e^{−τ}),   τ = σ_v (b − a),
// front to back: thick cloud shows C(a) alone, thin edges let the sky through. All of it happens in the mesh's own frame, centred and
// with the longest side 1. Embree finds the triangles; distances and barycentric coordinates are computed here, because the last
// bits of Embree's depend on the CPU.
#include "preview/render.h"

#include <embree3/rtcore.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <type_traits>

#include "core/lobe_lighting.h"
#include "core/vertex_normals.h"

namespace cloudbake {

namespace {

constexpr float kDefaultExtinctionTimesSize = 7;  // σ · longest side of an asset that records no σ

// Embree's handles, released when they leave scope.
struct ReleaseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseDevice>;
using Scene = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;

/// The two fields of a vertex, or of a point between vertices.
struct Shade {
  float sun = 0, sky = 0;  // R, G
};

/// The mesh as it is drawn: centred, longest side 1, lit.
struct LitMesh {
  std::vector<Vec3> positions;
  std::vector<Shade> shades;
  std::vector<Triangle> triangles;
  Vec3 center;
  float size = 1;             // world units per unit of the frame
  float view_extinction = 0;  // σ_v in the frame
  Device device;
  Scene scene;  // none where there are no triangles
};

/// One crossing of the surface.
struct Crossing {
  float t = 0;
  int sign = 0;  // +1 into the cloud, −1 out of it
  uint32_t triangle = 0;
  Shade shade;
};

std::vector<Shade> shadeVertices(const BakedMesh& mesh, const std::vector<Vec3>& normals, const LightSettings& light, float extinction) {
  const Vec3 to_sun = light.sky.to_sun;
  std::vector<Shade> shades(mesh.lobes.size());
  for (size_t i = 0; i < shades.size(); ++i) {
    const float half_lambert = dot(normals[i], to_sun) * 0.5F + 0.5F;
    shades[i].sun = lobeTransmittance(mesh.lobes[i], to_sun, mesh.info.shape, extinction) *
                    (light.half_lambert + (1 - light.half_lambert) * half_lambert);
    shades[i].sky = lobeTransmittance(mesh.lobes[i], {0, 1, 0}, mesh.info.shape, extinction);
  }
  return shades;
}

// Embree keeps its own copy of the vertices and indices.
void buildScene(LitMesh& lit) {
  lit.device.reset(rtcNewDevice("start_threads=0"));
  if (!lit.device) throw std::runtime_error("Embree cannot start on this machine");
  lit.scene.reset(rtcNewScene(lit.device.get()));
  rtcSetSceneFlags(lit.scene.get(), RTCSceneFlags(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  RTCGeometry geometry = rtcNewGeometry(lit.device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), lit.positions.size()));
  auto* indices = static_cast<uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), lit.triangles.size()));
  if (!vertices || !indices) {
    rtcReleaseGeometry(geometry);
    throw std::bad_alloc();
  }
  for (const Vec3& p : lit.positions) {
    *vertices++ = p.x;
    *vertices++ = p.y;
    *vertices++ = p.z;
  }
  for (const Triangle& triangle : lit.triangles) indices = std::copy(triangle.begin(), triangle.end(), indices);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(lit.scene.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(lit.scene.get());
}

LitMesh lightMesh(const BakedMesh& mesh, const LightSettings& light) {
  const SurfaceMesh& surface = mesh.surface;
  if (mesh.lobes.size() != surface.positions.size()) throw std::invalid_argument("renderLobe: the mesh needs one lobe per vertex");
  LitMesh lit;
  lit.triangles = surface.triangles;

  // The frame holds what is drawn: a vertex that no triangle uses does not count.
  Box box;
  for (const Triangle& triangle : surface.triangles)
    for (const uint32_t v : triangle) box.add(surface.positions[v]);
  lit.center = box.empty() ? Vec3{} : box.center();
  if (box.longestSide() > 0) lit.size = box.longestSide();
  for (const Vec3& p : surface.positions) lit.positions.push_back((p - lit.center) / lit.size);

  const float recorded = mesh.info.extinction > 0 ? mesh.info.extinction : kDefaultExtinctionTimesSize / lit.size;
  const float extinction = light.extinction.value_or(recorded);
  lit.view_extinction = light.view_extinction * extinction * lit.size;
  const bool has_normals = surface.normals.size() == surface.positions.size();
  lit.shades = shadeVertices(mesh, has_normals ? surface.normals : vertexNormals(lit.positions, lit.triangles), light, extinction);
  if (!lit.triangles.empty()) buildScene(lit);
  return lit;
}

/// Embree hands the context back to the filter, which notes the triangle and refuses the hit, so that the search goes on.
struct AllHits {
  RTCIntersectContext embree;
  std::vector<uint32_t>* triangles;
};

void noteHit(const RTCFilterFunctionNArguments* arguments) {
  const auto* hits = reinterpret_cast<const AllHits*>(arguments->context);
  hits->triangles->push_back(RTCHitN_primID(arguments->hit, arguments->N, 0));
  arguments->valid[0] = 0;
}

// Where the line of a ray meets the plane of a triangle (Möller and Trumbore 1997), in double. Nothing where they are parallel.
std::optional<Crossing> crossTriangle(const LitMesh& lit, uint32_t index, const Ray& ray) {
  const auto& [ia, ib, ic] = lit.triangles[index];
  const Vec3 a = lit.positions[ia], e = lit.positions[ib] - a, f = lit.positions[ic] - a, s = ray.origin - a, d = ray.direction;
  const auto triple = [](Vec3 u, Vec3 v, Vec3 w) {
    return double(u.x) * (double(v.y) * w.z - double(v.z) * w.y) + double(u.y) * (double(v.z) * w.x - double(v.x) * w.z) +
           double(u.z) * (double(v.x) * w.y - double(v.y) * w.x);
  };
  const double determinant = triple(e, d, f);  // > 0 where the triangle faces the ray's origin
  if (determinant == 0) return std::nullopt;
  const double u = std::clamp(triple(s, d, f) / determinant, 0.0, 1.0), v = std::clamp(triple(e, d, s) / determinant, 0.0, 1.0 - u);
  const double t = triple(e, s, f) / -determinant;
  if (!std::isfinite(t)) return std::nullopt;

  const Shade &p = lit.shades[ia], &q = lit.shades[ib], &r = lit.shades[ic];
  const float weight_q = float(u), weight_r = float(v), weight_p = 1 - weight_q - weight_r;
  return Crossing{float(t),
                  determinant > 0 ? 1 : -1,
                  index,
                  {weight_p * p.sun + weight_q * q.sun + weight_r * r.sun, weight_p * p.sky + weight_q * q.sky + weight_r * r.sky}};
}

bool shareCorner(const LitMesh& lit, uint32_t first, uint32_t second) {
  for (const uint32_t v : lit.triangles[first])
    for (const uint32_t w : lit.triangles[second])
      if (lit.positions[v] == lit.positions[w]) return true;
  return false;
}

// All crossings, near to far. A ray through an edge meets both its triangles: one crossing, known by place, sense and a shared corner.
void findCrossings(const LitMesh& lit, const Ray& ray, std::vector<uint32_t>& triangles, std::vector<Crossing>& crossings) {
  constexpr float kSamePlace = 1e-6F;  // in the frame, where the mesh has size 1
  triangles.clear();
  crossings.clear();
  if (!lit.scene) return;
  AllHits hits{};
  rtcInitIntersectContext(&hits.embree);
  hits.embree.filter = noteHit;
  hits.triangles = &triangles;
  RTCRayHit query{};
  query.ray.org_x = ray.origin.x, query.ray.org_y = ray.origin.y, query.ray.org_z = ray.origin.z;
  query.ray.dir_x = ray.direction.x, query.ray.dir_y = ray.direction.y, query.ray.dir_z = ray.direction.z;
  query.ray.tfar = INFINITY;
  query.ray.mask = 0xffffffffU;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(lit.scene.get(), &hits.embree, &query);

  for (const uint32_t triangle : triangles)
    if (const auto crossing = crossTriangle(lit, triangle, ray)) crossings.push_back(*crossing);
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
    if (a.t != b.t) return a.t < b.t;
    return a.sign != b.sign ? a.sign > b.sign : a.triangle < b.triangle;
  });
  size_t kept = 0;
  for (const Crossing& crossing : crossings) {
    bool repeated = false;
    for (size_t j = kept; j-- > 0 && crossing.t - crossings[j].t <= kSamePlace && !repeated;)
      repeated = crossings[j].sign == crossing.sign && shareCorner(lit, crossings[j].triangle, crossing.triangle);
    if (!repeated) crossings[kept++] = crossing;
  }
  crossings.resize(kept);
}

Vec3 mix(Vec3 a, Vec3 b, float t) { return a + (b - a) * t; }

Vec3 cloudColor(const Shade& shade, const SkyColors& colors) {
  return mix(colors.ambient_ground, colors.sun_color, shade.sun) + mix(colors.ambient_ground, colors.ambient_sky, shade.sky);
}

// The cloud's intervals over the sky, front to back.
Vec3 colorAlong(const LitMesh& lit, const Ray& ray, const std::vector<Crossing>& crossings, const LightSettings& light) {
  if (crossings.empty()) return skyColor(ray.direction, light.sky);
  const SkyColors& colors = light.sky.colors;
  int sum = 0;
  for (const Crossing& crossing : crossings) sum += crossing.sign;
  if (sum != 0 || !(lit.view_extinction > 0)) return cloudColor(crossings.front().shade, colors);

  Vec3 color;
  float through = 1;  // transmittance so far
  int winding = 0;
  const Crossing* entry = nullptr;
  for (const Crossing& crossing : crossings) {
    if (winding == 0) entry = &crossing;
    winding += crossing.sign;
    if (winding != 0) continue;
    const float depth = lit.view_extinction * (crossing.t - entry->t), passed = std::exp(-depth);
    const float later = depth > 1e-3F ? (1 - passed) / depth - passed : 0.5F * depth;
    const Vec3 near = cloudColor(entry->shade, colors), far = cloudColor(crossing.shade, colors);
    color += (near * (1 - passed) + (far - near) * later) * through;
    through *= passed;
  }
  return color + skyColor(ray.direction, light.sky) * through;
}

}  // namespace

LightSettings lightForSun(float azimuth_degrees, float elevation_degrees) {
  LightSettings light;
  light.sky.to_sun = directionFromAngles(azimuth_degrees, elevation_degrees);
  light.sky.colors = skyColorsForSun(light.sky.to_sun.y);
  return light;
}

Image renderLobe(const BakedMesh& mesh, const Camera& camera, const LightSettings& light) {
  const LitMesh lit = lightMesh(mesh, light);
  Camera local = camera;
  local.look_from = (camera.look_from - lit.center) / lit.size;
  local.look_at = (camera.look_at - lit.center) / lit.size;

  // The same n·n places in every pixel, each in its own row, column and stratum (Kensler, "Correlated Multi-Jittered
  // Sampling", Pixar 2013, its canonical arrangement).
  const int n = std::max(1, light.samples_per_side);
  std::vector<Vec2> places;
  for (int i = 0; i < n * n; ++i) {
    const float column = float(i % n), row = float(i / n);
    places.push_back({(column + (row + 0.5F) / float(n)) / float(n), (row + (column + 0.5F) / float(n)) / float(n)});
  }

  Image image = blankImage(camera.width, camera.height);
  tbb::parallel_for(tbb::blocked_range<int>(0, camera.height), [&](const tbb::blocked_range<int>& rows) {
    std::vector<uint32_t> triangles;
    std::vector<Crossing> crossings;
    for (int y = rows.begin(); y < rows.end(); ++y)
      for (int x = 0; x < camera.width; ++x) {
        Vec3 sum;
        for (const Vec2 place : places) {
          const Ray ray = cameraRay(local, float(x) + place.x, float(y) + place.y);
          findCrossings(lit, ray, triangles, crossings);
          sum += colorAlong(lit, ray, crossings, light);
        }
        image.at(x, y) = sum / float(n * n);
      }
  });
  return image;
}

// K. Narkowicz, "ACES Filmic Tone Mapping Curve" (2016): x(2.51x + 0.03)/(x(2.43x + 0.59) + 0.14), at most 1; then IEC 61966-2-1.
Image toneMap(const Image& image, float exposure) {
  const auto encode = [exposure](float value) {
    const float x = std::clamp(value * exposure, 0.0F, 1e6F);
    const float film = std::min(1.0F, x * (2.51F * x + 0.03F) / (x * (2.43F * x + 0.59F) + 0.14F));
    return film <= 0.0031308F ? 12.92F * film : 1.055F * std::pow(film, 1 / 2.4F) - 0.055F;
  };
  Image result = image;
  for (Vec3& p : result.pixels) p = {encode(p.x), encode(p.y), encode(p.z)};
  return result;
}

}  // namespace cloudbake
