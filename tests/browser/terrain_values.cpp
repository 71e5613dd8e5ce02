// The functions of shaders/functions/layers/terrain.glsl. The C++ computes places in double and the GLSL in float, which rounds a place 500
// SC away by 3·10⁻⁵ SC. Bounds are several times that, for the roundings add up, times the slope of what is computed at the place:
//   heights   slopes of up to 10, in SC;  normals: the differences of such heights over at least 0.25 SC
//   hits      one step more or less where the height is about the tolerance: 0.4 · 0.0015 of the distance
//   shadows   16 times a height over the way, which is short at first
//   colours   of the normals and shadows
// Steps of a march depend on those before: where a ray that starts 10⁻³ SC higher or lower ends elsewhere in the C++ alone, the point is
// drawn anew.
#include <cmath>
#include <optional>

#include "preview/backdrop/noise.h"
#include "preview/backdrop/terrain.h"
#include "preview/shading_math.h"
#include "tests/browser/glsl_text.h"
#include "tests/browser/glsl_values.h"

namespace cloudbake {

namespace {

constexpr float kAround = 500;  // SC from the origin

// No two settings that could be mistaken for each other are equal.
const TerrainSettings& testedTerrain() {
  static const TerrainSettings settings = [] {
    TerrainSettings s;
    s.scale = 0.1F;
    s.origin = {3, -2, 5};
    s.seed = 11;
    s.ground.snow_low = 75, s.ground.snow_high = 105;
    s.ground.snow_side = {0.6F, 0, 0.8F};
    return s;
  }();
  return settings;
}

std::string terrainText(const TerrainSettings& terrain) {
  std::string members;
  visitTerrainKeys(terrain, [&](std::string_view table, const auto& keys, const auto& settings) {
    const std::string text = glslMembers(keys, settings);
    if (text.empty()) return;
    members += (members.empty() ? "" : ", ") + (table == "terrain" ? text : glslStruct(glslStructName(table), text));
  });
  return glslStruct("Terrain", members);
}

// A point of the world over the terrain, so many SC up.
Vec3 pointOver(Draws& draw, float low, float high) {
  const TerrainSettings& t = testedTerrain();
  const Vec3 own{draw.between(-kAround, kAround), draw.between(low, high), draw.between(-kAround, kAround)};
  return t.origin + own * t.scale;
}

// A point with a normal, on the ground.
Vec3 groundPoint(Draws& draw) {
  const TerrainSettings& t = testedTerrain();
  Vec3 p = pointOver(draw, 0, 0);
  p.y = float(terrainHeight(p.x, p.z, t.shape.march_octaves, t));
  return p;
}

// Whether values at a point agree with those 10⁻³ SC above and below; value(offset) is the value so far up, in the world.
template <typename Value>
bool isSteady(float tolerance, const Value& value) {
  const float offset = 1e-3F * testedTerrain().scale, here = value(0.0F);
  return std::abs(value(offset) - here) <= tolerance && std::abs(value(-offset) - here) <= tolerance;
}

// Draws points until one is steady.
template <typename Drawn>
Point steadyPoint(Draws& draw, const Drawn& drawn) {
  for (;;)
    if (const std::optional<Point> point = drawn(draw)) return *point;
}

Point noisePoint(Draws& draw) {
  const Vec2 p{draw.between(-1000, 1000), draw.between(-1000, 1000)};
  const NoiseSettings settings{uint32_t(draw.between(0, 4000)), draw.between(0, 1) < 0.5F ? 256 : 0};
  const Noise2 noise = valueNoise2(p, settings);
  return {{{p.x, p.y, float(settings.seed), float(settings.period)}}, {noise.value, noise.gradient.x, noise.gradient.y, 0}};
}

Point fbmPoint(Draws& draw) {
  const Vec2 p{draw.between(-50, 50), draw.between(-50, 50)};
  const auto seed = uint32_t(draw.between(0, 4000));
  return {{{p.x, p.y, float(seed), 0}}, {terrainFbm(p, seed, testedTerrain().fbm), 0, 0, 0}};
}

// In SC, with few and with all octaves.
Point heightPoint(Draws& draw) {
  const TerrainSettings& t = testedTerrain();
  const Vec3 p = pointOver(draw, 0, 0);
  const Vec2 offset{draw.between(-1, 1), draw.between(-1, 1)};
  const int octaves = int(draw.between(0, 17));
  const double height = terrainHeight(double(p.x) + offset.x, double(p.z) + offset.y, octaves, t) - t.origin.y;
  return {{texel(p, float(octaves)), {offset.x, offset.y, 0, 0}}, {float(height / t.scale), 0, 0, 0}};
}

Point normalPoint(Draws& draw) {
  const TerrainSettings& t = testedTerrain();
  const Vec3 p = pointOver(draw, 0, 0);
  const float step = t.scale * std::exp2(draw.between(-3, 1));
  return {{texel(p, step)}, texel(terrainNormal(p.x, p.z, step, t))};
}

std::optional<Point> hitPoint(Draws& draw) {
  const TerrainSettings& t = testedTerrain();
  const Ray ray{pointOver(draw, 100, 400), *normalized(draw.direction() - Vec3{0, 0.8F, 0})};
  const auto distance = [&](float offset) {
    const auto hit = marchTerrain({ray.origin + Vec3{0, offset, 0}, ray.direction}, t);
    return hit ? float(hit->distance / t.scale) : -1.0F;
  };
  if (!isSteady(0.02F, distance)) return std::nullopt;
  return Point{{texel(ray.origin), texel(ray.direction)}, {distance(0), 0, 0, 0}};
}

// Most points are in half shadow.
std::optional<Point> passPoint(Draws& draw) {
  const TerrainSettings& t = testedTerrain();
  const Vec3 point = groundPoint(draw) + Vec3{0, t.scale * draw.between(0, 3), 0};
  const Vec3 to_sun = *normalized(draw.direction() * Vec3{1, 0.3F, 1} + Vec3{0, 0.1F, 0});
  const auto share = [&](float offset) {
    const Vec3 moved = point + Vec3{0, offset, 0};
    float passed = 1;
    passTerrain({&moved, 1}, to_sun, t, {&passed, 1});
    return passed;
  };
  const float here = share(0);
  if (((here < 0.01F || here == 1) && draw.between(0, 1) > 0.05F) || !isSteady(0.01F, share)) return std::nullopt;
  return Point{{texel(point), texel(to_sun)}, {here, 0, 0, 0}};
}

Point materialPoint(Draws& draw) {
  const Vec3 p = groundPoint(draw), normal = *normalized(draw.direction() + Vec3{0, 1.5F, 0});
  const TerrainMaterial material = terrainMaterial(p, normal, testedTerrain());
  return {{texel(p), texel(normal)}, texel(material.albedo, material.snow)};
}

std::optional<Point> colorPoint(Draws& draw) {
  const TerrainSettings& t = testedTerrain();
  const Vec3 point = groundPoint(draw), view = *normalized(draw.direction() - Vec3{0, 0.5F, 0});
  const Vec3 to_sun = *normalized(draw.direction() + Vec3{0, 1, 0});
  const double distance = double(t.scale) * double(draw.between(200, 2000));
  const auto colorAt = [&](float offset) { return terrainColor({distance, point + Vec3{0, offset, 0}}, view, to_sun, t); };
  if (!isSteady(0.01F, [&](float offset) { return colorAt(offset).x; })) return std::nullopt;
  return Point{{texel(point, float(distance)), texel(view), texel(to_sun)}, texel(colorAt(0))};
}

Point fogPoint(Draws& draw) {
  const TerrainSettings& t = testedTerrain();
  const float distance = t.scale * draw.between(0, 4000);
  return {{{distance, 0, 0, 0}}, {terrainFog(distance, t), 0, 0, 0}};
}

Point skyPoint(Draws& draw) {
  const Vec3 p = pointOver(draw, 0, 1200), to_sun = draw.direction(), any = draw.direction();
  const Vec3 view = draw.between(0, 1) < 0.5F ? any : *normalized(to_sun + any * 0.2F);
  return {{texel(p), texel(view), texel(to_sun)}, texel(terrainSky(p, view, to_sun, testedTerrain()))};
}

}  // namespace

std::vector<Function> terrainFunctions() {
  const std::string settings = "Terrain tested() { return " + terrainText(testedTerrain()) + R"(; }
// As terrain_hit.frag and terrain_color.frag.
vec4 colorOf(vec3 point, float distance, vec3 view, vec3 to_sun, float step) {
  vec3 normal = terrainNormal(point.xz, step * distance, tested());
  float sun = dot(normal, to_sun) > 0.0 ? terrainShadow(point, to_sun, tested()) : 0.0;
  return vec4(terrainColor(point, distance, normal, sun, view, to_sun, tested()), 0.0);
})";
  const auto one = [](const std::string& call) { return "vec4(" + call + ", 0.0, 0.0, 0.0)"; };
  std::vector<Function> all{
      {"noise", "valueNoise2", "vec4(valueNoise2(p[0].xy, mixBits(uint(p[0].z)), int(p[0].w)), 0.0)",
       "vec4(valueNoise2(p[0].xy, mixBits(uint(p[0].z)), 128), 0.0)", 0, 0, noisePoint},
      {"terrain", "terrainFbm", one("terrainFbm(p[0].xy, uint(p[0].z), tested().fbm)"),
       one("terrainFbm(p[0].yx, uint(p[0].z), tested().fbm)"), 3e-5, 0, fbmPoint},
      {"terrain", "terrainHeight", one("terrainHeight(p[0].xz, p[1].xy, int(p[0].w), tested()) / tested().scale"),
       one("terrainHeight(p[0].xz, p[1].yx, int(p[0].w), tested()) / tested().scale"), 1e-3, 0, heightPoint},
      {"terrain", "terrainNormal", "vec4(terrainNormal(p[0].xz, p[0].w, tested()), 0.0)",
       "vec4(terrainNormal(p[0].xz, 1.2 * p[0].w, tested()), 0.0)", 3e-3, 0, normalPoint},
      {"terrain", "marchTerrain", one("max(-1.0, marchTerrain(p[0].xyz, p[1].xyz, tested()) / tested().scale)"),
       one("max(-1.0, marchTerrain(p[0].xyz, p[1].zyx, tested()) / tested().scale)"), 0.02, 1e-3,
       [](Draws& draw) { return steadyPoint(draw, hitPoint); }},
      {"terrain", "passTerrain", one("passTerrain(p[0].xyz, p[1].xyz, tested())"), one("passTerrain(p[0].zyx, p[1].zyx, tested())"), 0.02,
       0, [](Draws& draw) { return steadyPoint(draw, passPoint); }},
      {"terrain", "terrainMaterial", "terrainMaterial(p[0].xyz, p[1].xyz, tested())", "terrainMaterial(p[0].zyx, p[1].xyz, tested())", 2e-4,
       0, materialPoint},
      {"terrain", "terrainColor", "colorOf(p[0].xyz, p[0].w, p[1].xyz, p[2].xyz, 0.001)",
       "colorOf(p[0].xyz, p[0].w, p[1].xyz, p[2].zyx, 0.001)", 0.01, 0, [](Draws& draw) { return steadyPoint(draw, colorPoint); }},
      {"terrain", "terrainFog", one("terrainFog(p[0].x, tested())"), one("terrainFog(1.01 * p[0].x, tested())"), 1e-6, 0, fogPoint},
      {"terrain", "terrainSky", "vec4(terrainSky(p[0].xyz, p[1].xyz, p[2].xyz, tested()), 0.0)",
       "vec4(terrainSky(p[0].xyz, p[1].xyz, p[2].zyx, tested()), 0.0)", 5e-5, 0, skyPoint}};
  for (Function& f : all) {
    f.points = marchedPoints();
    if (f.file == "noise") continue;
    f.uses = {"noise", "shading"};
    f.prelude = settings;
  }
  return all;
}

}  // namespace cloudbake
