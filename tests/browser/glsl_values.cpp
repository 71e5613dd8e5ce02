// What the functions of shaders/functions/ must give: for each function the values of the C++ that it stands for, at many points.
//   glsl_values FOLDER
// Prints the functions as JSON, and writes the floats of the I-th into FOLDER: what goes in, I.inputs, and what must come out, I.expected.
// tests/browser/glsl.mjs evaluates the same in a browser.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/harmonics.h"
#include "core/impostor.h"
#include "core/lobe_lighting.h"
#include "core/lobe_packing.h"
#include "core/parallel.h"
#include "preview/backdrop/glsl_structs.h"
#include "preview/backdrop/noise.h"
#include "preview/lamp.h"
#include "preview/mesh_clouds/lit_mesh.h"
#include "preview/mesh_clouds/post.h"
#include "preview/mesh_clouds/render.h"
#include "preview/mesh_clouds/shade_grid.h"
#include "preview/mesh_clouds/shadow_frame.h"
#include "preview/shading_math.h"
#include "tests/browser/glsl_values.h"

namespace {

using namespace cloudbake;

Lobe lobeOf(Draws& draw) { return {draw.direction(), draw.between(0, 3)}; }

std::vector<Function> lobeFunctions() {
  const auto transmittance = [](Draws& draw) {
    const Lobe lobe = lobeOf(draw);
    const Vec3 light = draw.direction();
    const LobeShape shape{std::floor(draw.between(2, 6)), draw.between(-0.2F, 0.2F)};
    const float extinction = draw.between(0, 4);
    return Point{{texel(lobe.direction, lobe.thickness), texel(light, extinction), {shape.exponent, shape.bias, 0, 0}},
                 {lobeTransmittance(lobe, light, shape, extinction), lobeThickness(lobe, light, shape), 0, 0}};
  };
  const auto placed = [](Draws& draw) {
    const Lobe lobe = lobeOf(draw);
    Affine to_world;
    for (auto& row : to_world.linear)
      for (double& entry : row) entry = draw.between(-2, 2);
    const Lobe world = mappedLobe(lobe, to_world);
    Point point{{{lobe.direction.x, lobe.direction.y, lobe.direction.z, lobe.thickness}}, texel(world.direction, world.thickness)};
    for (size_t column = 0; column < 3; ++column)
      point.inputs.push_back({float(to_world.linear[0][column]), float(to_world.linear[1][column]), float(to_world.linear[2][column]), 0});
    return point;
  };
  const auto packed = [](Draws& draw) {
    const LobeUvs stored{{draw.between(-1, 1), draw.between(-1, 1)}, {draw.between(-1, 1), draw.between(0, 1)}};
    const float density_max = draw.between(0.1F, 30);
    const LobeUvs lobe = dequantisedLobe(stored, density_max);
    return Point{{{stored.first.x, stored.first.y, stored.second.x, stored.second.y}, {density_max, 0, 0, 0}},
                 {lobe.first.x, lobe.first.y, lobe.second.x, lobe.second.y}};
  };
  const std::string lobe = "lobeInWorld(unpackLobe(p[0].xy, p[0].zw, 0.0), mat3(p[1].xyz, p[2].xyz, p[3].xyz))";
  const std::string both = "vec4(lobeTransmittance(p[0], p[1].xyz, p[2].xy, p[1].w), lobeThickness(p[0], p[1].xyz, p[2].xy), 0.0, 0.0)";
  return {{"lobe", "lobeTransmittance", both,
           "vec4(lobeTransmittance(p[0], p[1].xyz, p[2].xy, 1.01 * p[1].w), lobeThickness(p[0], p[1].xyz, p[2].xy), 0.0, 0.0)", 2e-6, 4e-6,
           transmittance},
          {"lobe", "lobeInWorld", lobe, "lobeInWorld(unpackLobe(p[0].zw, p[0].xy, 0.0), mat3(p[1].xyz, p[2].xyz, p[3].xyz))", 3e-6, 1e-6,
           placed},
          {"lobe", "unpackLobe of flipped sets", "unpackLobe(vec2(p[0].x, 1.0 - p[0].y), vec2(p[0].z, 1.0 - p[0].w), 1.0)",
           "unpackLobe(vec2(p[0].x, 1.0 - p[0].y), vec2(p[0].z, 1.0 - p[0].w), 0.0)", 3e-7, 0,
           [](Draws& draw) {
             const Texel values{draw.between(-1, 1), draw.between(-1, 1), draw.between(-1, 1), draw.between(0, 3)};
             return Point{{values}, values};
           }},
          {"lobe", "decodeLobe of packed sets", "decodeLobe(p[0].xy, p[0].zw, 0.0, p[1].x)", "decodeLobe(p[0].yx, p[0].zw, 0.0, p[1].x)",
           2e-6, 4e-6, packed}};
}

// Frames, their places and their texels.
std::vector<Function> impostorFunctions() {
  // Of half of the points the eye looks along an axis or nearly so, or from a fold of the map.
  const auto eyeOf = [](Draws& draw) {
    Vec3 eye = draw.direction();
    const float kind = draw.between(0, 1);
    if (kind < 0.1F) eye = {0, eye.y < 0 ? -1.0F : 1.0F, 0};
    if (kind > 0.1F && kind < 0.3F) eye = *normalized(Vec3{eye.x * 0.02F, eye.y < 0 ? -1.0F : 1.0F, eye.z * 0.02F});
    return kind > 0.5F ? draw.direction() : eye;
  };
  const auto viewsOf = [](Draws& draw) { return int(draw.between(2, 17)); };
  const auto directions = [=](Draws& draw) {
    const int views = viewsOf(draw), i = int(draw.between(0, float(views))), j = int(draw.between(0, float(views)));
    return Point{{{float(i), float(j), float(views), 0}}, texel(frameDirection(i, j, views))};
  };
  // The direction of the mean of frames: weights of frames may change places where one of them is 0.
  const auto frames = [=](Draws& draw) {
    const int views = viewsOf(draw);
    const Vec3 eye = eyeOf(draw);
    Vec3 mean;
    float squares = 0;
    for (const FrameWeight& frame : framesAround(eye, views)) {
      mean += frameDirection(frame.i, frame.j, views) * frame.weight;
      squares += frame.weight * frame.weight;
    }
    return Point{{texel(eye, float(views))}, texel(mean, squares)};
  };
  const auto axes = [=](Draws& draw) {
    const Vec3 eye = eyeOf(draw), place{draw.between(-1, 1), draw.between(-1, 1), draw.between(-1, 1)};
    const FrameAxes own = frameAxes(eye);
    Vec3 ray = draw.direction();
    if (dot(ray, eye) > -0.2F) ray = ray * 0.3F - eye;
    const float height = draw.between(-1, 1), t = (height - dot(place, own.to_eye)) / dot(ray, own.to_eye);
    return Point{{texel(eye), texel(place, height), texel(ray)},
                 {0.5F + 0.5F * dot(place, own.right), 0.5F - 0.5F * dot(place, own.up), t, 0}};
  };
  const auto lobes = [=](Draws& draw) {
    const Vec3 eye = eyeOf(draw);
    const FrameAxes own = frameAxes(eye);
    const Vec2 encoded = encodedDirection(draw.direction(), own);
    const float root = draw.between(0, 1), thickest = draw.between(0.5F, 3);
    return Point{{texel(eye, thickest), {encoded.x, encoded.y, root, 0}},
                 texel(*normalized(decodedDirection(encoded, own)), root * root * thickest)};
  };
  const std::string prelude = R"(
vec4 meanOfFrames(vec3 to_eye, float views) {
  vec4 cell = impostorCell(to_eye, views);
  vec3 weights = impostorWeights(cell, views);
  vec3 mean = impostorDirection(cell.xy + impostorFirst(cell, views), views) * weights.x
    + impostorDirection(cell.xy + impostorSecond(cell, views), views) * weights.y
    + impostorDirection(cell.xy + impostorThird(cell, views), views) * weights.z;
  return vec4(mean, dot(weights, weights));
}
)";
  const auto places = [](const std::string& eye) {
    return "vec4(impostorPlace(p[1].xyz, impostorRight(" + eye + "), " + eye + "), impostorReach(p[1].xyz, p[2].xyz, " + eye +
           ", p[1].w), 0.0)";
  };
  const auto lobe = [](const std::string& values) {
    return "impostorMean(2.0 * impostorLobe(" + values + ", impostorRight(p[0].xyz), p[0].xyz, p[0].w), 2.0)";
  };
  std::vector<Function> functions{
      {"impostor", "impostorDirection", "vec4(impostorDirection(p[0].xy, p[0].z), 0.0)",
       "vec4(impostorDirection(p[0].xy, p[0].z + 1.0), 0.0)", 1e-6, 0, directions},
      {"impostor",
       "impostorCell, its three frames and impostorWeights",
       "meanOfFrames(p[0].xyz, p[0].w)",
       "meanOfFrames(p[0].zyx, p[0].w)",
       2e-5,
       0,
       frames,
       {},
       prelude},
      {"impostor", "impostorRight, impostorPlace and impostorReach", places("p[0].xyz"), places("p[0].yxz"), 4e-6, 1e-5, axes},
      {"impostor", "impostorLobe and impostorMean", lobe("p[1].xyz"), lobe("p[1].yxz"), 2e-6, 2e-6, lobes},
      {"impostor", "impostorInAtlas and impostorLevel",
       "vec4(impostorInAtlas(p[0].xy, floor(p[1].xy), p[1].z, p[1].w), impostorLevel(p[0].z, p[0].w), impostorHeight(p[0].x))",
       "vec4(impostorInAtlas(p[0].yx, floor(p[1].xy), p[1].z, p[1].w), impostorLevel(p[0].z, p[0].w), impostorHeight(p[0].x))", 2e-6, 2e-6,
       [](Draws& draw) {
         const Vec2 at{draw.between(-0.1F, 1.1F), draw.between(-0.1F, 1.1F)};
         const float texels = std::exp2(draw.between(-3, 8)), last = std::floor(draw.between(0, 6)), pixels = draw.between(4, 128);
         const float views = std::floor(draw.between(2, 17)), i = draw.between(0, views), j = draw.between(0, views);
         const auto inAtlas = [&](float a, float frame) {
           return (std::floor(frame) + std::clamp(a, 0.5F / pixels, 1 - 0.5F / pixels)) / views;
         };
         return Point{{{at.x, at.y, texels, last}, {i, j, views, pixels}},
                      {inAtlas(at.x, i), inAtlas(at.y, j), std::clamp(std::log2(texels), 0.0F, last), 1 - 2 * at.x}};
       }}};
  for (Function& f : functions) f.uses = {"lobe"};
  return functions;
}

// Sixteen coefficients of a mesh that is turned and stretched.
std::vector<Function> harmonicFunctions() {
  const auto through = [](Draws& draw) {
    std::array<float, kMaxHarmonics> coefficients{};
    for (float& c : coefficients) c = draw.between(-0.2F, 0.2F);
    coefficients[0] = draw.between(1, 2);
    const Vec3 light = draw.direction();
    const float own = draw.between(0.5F, 2), extinction = draw.between(0.5F, 2);
    Affine to_own;
    for (size_t i = 0; i < 3; ++i) to_own.linear[i][i] = double(draw.between(0.5F, 2));
    Point point{{}, {placedTransmittance(coefficients, light, to_own, own, extinction), 0, 0, 0}};
    for (size_t i = 0; i < kMaxHarmonics; i += 4)
      point.inputs.push_back({coefficients[i], coefficients[i + 1], coefficients[i + 2], coefficients[i + 3]});
    point.inputs.push_back(texel(light, own));
    point.inputs.push_back({float(to_own.linear[0][0]), float(to_own.linear[1][1]), float(to_own.linear[2][2]), extinction});
    return point;
  };
  const auto call = [](const std::string& direction) {
    return "vec4(placedHarmonicTransmittance(mat4(p[0], p[1], p[2], p[3]), " + direction +
           ", mat3(p[5].x, 0.0, 0.0, 0.0, p[5].y, 0.0, 0.0, 0.0, p[5].z), p[4].w, p[5].w), 0.0, 0.0, 0.0)";
  };
  return {{"harmonics", "placedHarmonicTransmittance", call("p[4].xyz"), call("p[4].yxz"), 4e-6, 4e-6, through}};
}

std::vector<Function> lightFunctions() {
  return {
      {"light", "cloudColor", "vec4(cloudColor(p[0].x, p[0].y, p[1].xyz, p[2].xyz, p[3].xyz), 0.0)",
       "vec4(cloudColor(p[0].y, p[0].x, p[1].xyz, p[2].xyz, p[3].xyz), 0.0)", 5e-7, 0,
       [](Draws& draw) {
         const Shade shade{draw.between(0, 1), draw.between(0, 1)};
         SkyColors colors;
         colors.sun_color = draw.color(), colors.ambient_sky = draw.color(), colors.ambient_ground = draw.color();
         return Point{{{shade.sun, shade.sky, 0, 0}, texel(colors.sun_color), texel(colors.ambient_sky), texel(colors.ambient_ground)},
                      texel(cloudColor(shade, colors))};
       }},
      {"light", "phaseFactor", "vec4(phaseFactor(p[0].xyz, p[1].xyz, p[0].w, p[1].w, p[2].x))",
       "vec4(phaseFactor(-p[0].xyz, p[1].xyz, p[0].w, p[1].w, p[2].x))", 1e-6, 4e-6, [](Draws& draw) {
         const Vec3 view = draw.direction(), sun = draw.direction();
         const PhaseSettings phase{draw.between(0.1F, 1), draw.between(0.2F, 0.9F), draw.between(1, 8)};
         const float factor = phaseFactor(view, sun, phase);
         return Point{{texel(view, phase.share), texel(sun, phase.asymmetry), {phase.limit, 0, 0, 0}}, {factor, factor, factor, factor}};
       }}};
}

std::vector<Function> lampFunctions() {
  const auto lit = [](Draws& draw) {
    const Vec3 place{draw.between(-2, 2), draw.between(-2, 2), draw.between(-2, 2)};
    const float outer = draw.between(-0.9F, 0.5F), range = draw.between(0, 1) < 0.5F ? 0 : draw.between(1, 6);
    const bool is_spot = draw.between(0, 1) < 0.5F;
    const Lamp lamp{{draw.between(-2, 2), draw.between(-2, 2), draw.between(-2, 2)},
                    draw.color(),
                    range,
                    draw.between(0.1F, 1.5F),
                    draw.direction(),
                    is_spot ? Vec2{outer + 0.4F, outer} : Vec2{-1, -1}};
    const Lobe lobe = lobeOf(draw);
    const Vec3 normal = draw.direction();
    const LobeShape shape{std::floor(draw.between(2, 6)), draw.between(-0.2F, 0.2F)};
    const float half_lambert = draw.between(0, 1), extinction = draw.between(0, 4);
    return Point{{texel(lamp.place, lamp.range), texel(lamp.color, lamp.radius), texel(lamp.axis, half_lambert),
                  texel(lobe.direction, lobe.thickness), texel(place, extinction), texel(normal, 0),
                  Texel{lamp.cone.x, lamp.cone.y, shape.exponent, shape.bias}},
                 texel(lampLight(lamp, lobe, place, normal, half_lambert, shape, extinction))};
  };
  const auto call = [](const std::string& lamp, const std::string& lobe) {
    return "vec4(lampLight(" + lamp + ", " + lobe + ", p[4].xyz, p[5].xyz, p[2].w, p[6].zw, p[4].w), 0.0)";
  };
  const std::string prelude = R"(
Lamp lampOf(vec4 place, vec4 color, vec4 axis, vec2 cone) {
  Lamp lamp;
  lamp.place = place.xyz;
  lamp.color = color.xyz;
  lamp.range = place.w;
  lamp.radius = color.w;
  lamp.axis = axis.xyz;
  lamp.cone = cone;
  return lamp;
}
)";
  const auto falloff = [](Draws& draw) {
    const float away = draw.between(0, 5), range = draw.between(0, 1) < 0.3F ? 0 : draw.between(0.5F, 6), radius = draw.between(0.05F, 1);
    const Vec3 to_lamp = draw.direction(), axis = draw.direction();
    const float outer = draw.between(-1.2F, 0.8F);
    const Vec2 cone{outer + draw.between(0.2F, 0.5F), outer};
    return Point{{{away, range, radius, 0}, texel(to_lamp, cone.x), texel(axis, cone.y)},
                 {lampFalloff(away, range, radius), lampCone(to_lamp, axis, cone), 0, 0}};
  };
  return {{"lamp",
           "lampFalloff and lampCone",
           "vec4(lampFalloff(p[0].x, p[0].y, p[0].z), lampCone(p[1].xyz, p[2].xyz, vec2(p[1].w, p[2].w)), 0.0, 0.0)",
           "vec4(lampFalloff(p[0].x, p[0].y, 1.1 * p[0].z), lampCone(-p[1].xyz, p[2].xyz, vec2(p[1].w, p[2].w)), 0.0, 0.0)",
           2e-6,
           4e-6,
           falloff,
           {"lobe"}},
          {"lamp",
           "lampLight",
           call("lampOf(p[0], p[1], p[2], p[6].xy)", "p[3]"),
           call("lampOf(p[0], p[1], p[2], p[6].xy)", "vec4(-p[3].xyz, p[3].w)"),
           4e-6,
           2e-5,
           lit,
           {"lobe"},
           prelude}};
}

std::vector<Function> castShadowFunctions() {
  const auto share = [](Draws& draw) {
    ShadowFrame frame = shadowFrame({}, draw.direction());
    frame.origin = {draw.between(-2, 2), draw.between(-2, 2), draw.between(-2, 2)};
    frame.width = draw.between(1, 4), frame.height = draw.between(1, 4);
    frame.top = draw.between(0.5F, 2), frame.bottom = -draw.between(0.5F, 2);
    const Vec3 place = frame.origin + Vec3{draw.between(-2, 2), draw.between(-2, 2), draw.between(-2, 2)};
    const float transmittance = draw.between(0, 1), strength = draw.between(0, 1);
    const Vec2 at = shadowPlace(place, frame);
    return Point{{texel(place, transmittance), texel(frame.origin, strength), texel(frame.right / frame.width, frame.top),
                  texel(frame.up / frame.height, frame.bottom), texel(frame.to_sun)},
                 {at.x, at.y, shadowDepth(place, frame), shadowFactor(transmittance, at, strength)}};
  };
  const auto call = [](const std::string& place) {
    const std::string at = "shadowPlace(" + place + ", p[1].xyz, p[2].xyz, p[3].xyz)";
    return "vec4(" + at + ", shadowDepth(" + place + ", p[1].xyz, p[4].xyz, p[2].w, p[3].w), shadowFactor(p[0].w, " + at + ", p[1].w))";
  };
  return {{"cast_shadow", "shadowPlace, shadowDepth and shadowFactor", call("p[0].xyz"), call("p[0].yxz"), 4e-6, 4e-6, share}};
}

std::vector<Function> cloudShadeFunctions() {
  const auto place = [](Draws& draw) {
    const Vec3 low{draw.between(-9, 0), draw.between(-9, 0), draw.between(-9, 0)},
        size{draw.between(1, 9), draw.between(1, 9), draw.between(1, 9)};
    Box box;
    box.add(low);
    box.add(low + size);
    const ShadeFrame frame = shadeFrame(box, draw.direction(), {.cells = 48, .cells_per_cloud = 4});
    const Vec3 point = low + Vec3{draw.between(0, 1) * size.x, draw.between(0, 1) * size.y, draw.between(0, 1) * size.z};
    const std::array<double, 3> at = frame.place(point);
    std::vector<Texel> given{texel(point)};
    for (const auto& row : frame.to_grid) given.push_back({float(row[0]), float(row[1]), float(row[2]), float(row[3])});
    const float shift = draw.between(-40, 40);
    given[0][3] = shift;
    return Point{given, {float(at[0] + double(shift) + 0.5), float(at[2] + 1.5), float(at[0] + 0.5), float(at[1] + 0.5)}};
  };
  const auto call = [](const std::string& point) {
    return "vec4(shadePlace(" + point + ", p[1], p[2], p[3], vec3(p[0].w, 0.0, 1.0)).xz, shadeGroundPlace(" + point + ", p[1], p[2]))";
  };
  return {{"cloud_shade", "shadePlace and shadeGroundPlace", call("p[0].xyz"), call("p[0].yxz"), 2e-4, 4e-6, place}};
}

std::vector<Function> noiseFunctions() {
  // At the lattice points a value is a hash.
  const auto hashes = [](Draws& draw) {
    const Vec3 p{std::floor(draw.between(-500, 500)), std::floor(draw.between(-500, 500)), std::floor(draw.between(-500, 500))};
    const auto seed = uint32_t(draw.between(0, 4000));
    const float value = valueNoise3(p, {.seed = seed}).value;
    return Point{{texel(p, float(seed))}, {value, value, value, value}};
  };
  const auto octaves = [](Draws& draw) {
    const Vec3 p{draw.between(-30, 30), draw.between(-30, 30), draw.between(-30, 30)};
    const FbmSettings fbm{.octaves = 4, .gain = 0.6F, .seed = uint32_t(draw.between(0, 100))};
    return Point{{texel(p, float(fbm.seed))}, {fbmValueOnly3(p, fbm), 0, 0, 0}};
  };
  const auto slopes = [](Draws& draw) {
    const Vec2 p{draw.between(-20, 20), draw.between(-20, 20)};
    const FbmSettings fbm{.octaves = 2, .gain = 0.4F, .seed = uint32_t(draw.between(0, 100)), .period = draw.between(0, 1) < 0.5F ? 4 : 0};
    const Vec2 slope = fbmGradient2(p, fbm).gradient;
    return Point{{{p.x, p.y, float(fbm.seed), float(fbm.period)}}, {slope.x, slope.y, 0, 0}};
  };
  return {{"noise", "hash", "vec4(valueNoise3(p[0].xyz, mixBits(uint(p[0].w)), 0))",
           "vec4(valueNoise3(p[0].xyz, mixBits(uint(p[0].w) + 1u), 0))", 0, 0, hashes},
          {"noise", "fbmValue", "vec4(fbmValue3(p[0].xyz, 4, 0.6, uint(p[0].w)), 0.0, 0.0, 0.0)",
           "vec4(fbmValue3(p[0].xyz, 4, 0.61, uint(p[0].w)), 0.0, 0.0, 0.0)", 1e-6, 0, octaves},
          {"noise", "fbmGradientSlope", "vec4(fbmGradientSlope(p[0].xy, 2, 0.4, uint(p[0].z), int(p[0].w)), 0.0, 0.0)",
           "vec4(fbmGradientSlope(p[0].xy, 2, 0.4, uint(p[0].z) + 1u, int(p[0].w)), 0.0, 0.0)", 4e-6, 0, slopes}};
}

// GLSL's smoothstep, and of ends in any order.
double smoothFrom(double x, double start, double end) {
  const double t = std::clamp((x - start) / (end - start), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

std::vector<Function> softFunctions() {
  const auto fade = [](Draws& draw) {
    const float x = draw.between(0, 1), start = draw.between(0, 1), end = draw.between(0, 1);
    const auto faded = float(smoothFrom(x, start, end));
    return Point{{{x, start, end, 0}}, {faded, x < start ? 0.0F : 1.0F, 1, 1 - faded}};
  };
  const auto rim = [](Draws& draw) {
    const float facing = draw.between(0.3F, 0.6F), noise = draw.between(0, 0.8F), start = draw.between(0, 0.2F),
                end = draw.between(0.6F, 0.9F);
    const double whole = smoothFrom(facing, start, end), taken = 0.75 * double(noise);
    return Point{{{facing, noise, start, end}}, {float(std::clamp((whole - taken) / (1 - taken), 0.0, 1.0)), float(whole), 1, 0}};
  };
  const auto noise = [](Draws& draw) {
    const Vec3 place{draw.between(-2, 2), draw.between(-2, 2), draw.between(-2, 2)};
    const Vec3 scrolled{draw.between(0, 9), draw.between(0, 9), draw.between(0, 9)};
    const float value = fbmValueOnly3(place * 8 + scrolled, {.octaves = 2, .gain = 0.6F, .seed = 0});
    return Point{{texel(place, 8), texel(scrolled)}, {float(smoothFrom(double(value), 0.25, 0.75)), 0, 0, 0}};
  };
  const auto threshold = [](Draws& draw) {
    const float x = std::floor(draw.between(0, 64)), y = std::floor(draw.between(0, 64));
    const float inner = std::fmod(0.06711056F * x + 0.00583715F * y, 1.0F);
    return Point{{{x, y, 0, 0}}, {std::fmod(52.9829189F * inner, 1.0F), 0, 0, 0}};
  };
  const auto fades = [](const std::string& x) {
    return "vec4(fadeBetween(" + x + ", p[0].y, p[0].z), fadeBetween(" + x + ", p[0].y, p[0].y), fadeBetween(" + x + ", 0.0, 0.0), " +
           "fadeBetween(" + x + ", p[0].z, p[0].y))";
  };
  const auto rims = [](const std::string& worn) {
    return "vec4(rimOpacity(p[0].x, " + worn + ", p[0].zw), rimOpacity(p[0].x, 0.0, p[0].zw), rimOpacity(p[0].x, 0.0, vec2(0.0, 0.0)), " +
           "rimOpacity(p[0].z * 0.9, " + worn + ", p[0].zw))";
  };
  const std::vector<std::string> uses{"noise"};
  return {{"soft", "fadeBetween", fades("p[0].x"), fades("(1.0 - p[0].x)"), 1e-6, 0, fade, uses},
          {"soft", "rimOpacity", rims("p[0].y"), rims("0.9 * p[0].y"), 2e-6, 0, rim, uses},
          {"soft", "rimNoise", "vec4(rimNoise(p[0].xyz, p[0].w, p[1].xyz), 0.0, 0.0, 0.0)",
           "vec4(rimNoise(p[0].xyz, p[0].w, -p[1].xyz), 0.0, 0.0, 0.0)", 1e-6, 0, noise, uses},
          {"soft", "ditherThreshold", "vec4(ditherThreshold(p[0].xy), 0.0, 0.0, 0.0)", "vec4(ditherThreshold(p[0].yx), 0.0, 0.0, 0.0)",
           1e-3, 0, threshold, uses}};
}

std::vector<Function> pictureFunctions() {
  const auto sky = [](Draws& draw) {
    SkySettings s;
    s.to_sun = draw.direction();
    s.colors.zenith = draw.color(), s.colors.horizon = draw.color(), s.colors.ground = draw.color(), s.colors.sun_color = draw.color();
    s.colors.low_sky = {s.colors.sun_color.z, s.colors.sun_color.x, s.colors.sun_color.y};
    s.disc = {draw.between(50, 4000), draw.between(1, 250)};
    s.glow = draw.between(0, 0.5F);
    s.horizon_exponent = draw.between(4, 20);
    s.viewer_height = draw.between(0, 1) < 0.5F ? 0 : draw.between(0, 0.1F);
    s.horizon_color = draw.color(), s.horizon_strength = draw.between(0, 1);
    // Half of the views are about the sun.
    const Vec3 any = draw.direction(), view = draw.between(0, 1) < 0.5F ? any : *normalized(s.to_sun + any * 0.2F);
    return Point{{texel(view, s.horizon_exponent),
                  texel(s.to_sun, s.viewer_height),
                  texel(s.colors.zenith),
                  texel(s.colors.horizon),
                  texel(s.colors.ground),
                  texel(s.colors.sun_color),
                  {s.disc.exponent, s.disc.gain, s.glow, 0},
                  texel(*s.horizon_color, s.horizon_strength)},
                 texel(skyColor(view, s))};
  };
  const auto skyCall = [](const std::string& zenith, const std::string& horizon) {
    return "vec4(skyColor(p[0].xyz, Sky(p[1].xyz, " + zenith + ", p[5].zxy, " + horizon +
           ", p[4].xyz, p[5].xyz, p[6].xyz, p[0].w, p[1].w, p[7])), 0.0)";
  };
  const auto tone = [](Draws& draw) {
    const Vec3 color{std::exp2(draw.between(-12, 6)), draw.between(0, 1), draw.between(-0.1F, 0.1F)};
    const float exposure = draw.between(0.2F, 3);
    Image image = blankImage(1, 1);
    image.at(0, 0) = color;
    return Point{{texel(color, exposure)}, texel(toneMap(image, exposure).at(0, 0))};
  };
  const auto dither = [](Draws& draw) {
    const auto x = int(draw.between(0, 32)), y = int(draw.between(0, 32));
    const float offset = dithered(blankImage(32, 32)).at(x, y).x;
    return Point{{{float(x), float(y), 0, 0}}, {offset, offset, offset, offset}};
  };
  return {{"sky", "skyColor", skyCall("p[2].xyz", "p[3].xyz"), skyCall("p[3].xyz", "p[2].xyz"), 2e-5, 1e-3, sky},
          {"tone", "toneMap", "vec4(toneMap(p[0].xyz, p[0].w), 0.0)", "vec4(toneMap(p[0].xyz, 1.02 * p[0].w), 0.0)", 1e-6, 0, tone},
          {"tone", "ditherOffset", "vec4(ditherOffset(ivec2(p[0].xy)))", "vec4(ditherOffset(ivec2(p[0].yx)))", 1e-9, 0, dither}};
}

// Writes all values as floats.
void write(const std::filesystem::path& file, const std::vector<Texel>& values) {
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(values.data()), std::streamsize(values.size() * sizeof(Texel)));
}

}  // namespace

int main(int, char** words) {
  const std::filesystem::path folder = words[1];
  nlohmann::json all = nlohmann::json::array();
  for (const auto& functions : {lobeFunctions(), impostorFunctions(), harmonicFunctions(), lightFunctions(), lampFunctions(),
                                castShadowFunctions(), cloudShadeFunctions(), noiseFunctions(), softFunctions(), pictureFunctions(),
                                sequenceFunctions(), terrainFunctions(), cloudFunctions(), nightFunctions(), gradeFunctions()})
    for (const Function& f : functions) {
      std::vector<Point> points(f.points);
      parallelFor(f.points, [&](uint32_t i) {
        Draws draws(i);
        points[i] = f.point(draws);
      });
      std::vector<Texel> inputs, expected;
      for (const Point& point : points) {
        inputs.insert(inputs.end(), point.inputs.begin(), point.inputs.end());
        expected.push_back(point.expected);
      }
      const std::string stem = std::to_string(all.size());
      write(folder / (stem + ".inputs"), inputs);
      write(folder / (stem + ".expected"), expected);
      all.push_back({{"file", f.file},
                     {"uses", f.uses},
                     {"prelude", f.prelude},
                     {"name", f.name},
                     {"call", f.call},
                     {"wrong", f.wrong},
                     {"absolute", f.absolute},
                     {"relative", f.relative},
                     {"points", f.points},
                     {"texels", inputs.size() / expected.size()}});
    }
  std::fputs(nlohmann::json{{"structs", glslStructs()}, {"functions", std::move(all)}}.dump().c_str(), stdout);
}
