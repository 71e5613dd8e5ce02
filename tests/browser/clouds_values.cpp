// The functions of shaders/functions/layers/random.glsl, samples.glsl, slab.glsl and marched.glsl, and the noise that they share. Hashes
// are exact, and so but for the last bits is what both sides compute in float from the same numbers. Bounds for the rest are several times
// what follows from these roundings:
//   slabNoise  the C++ computes a place in double: 60 cells from the origin the float is off by 4·10⁻⁶, 8 times as much in the last octave,
//              times slopes of 2 and second derivatives of 6 per cell
//   slab       a contact that one side finds a halving later is 1/256 of a step off, and a tone changes within 2·tone_softness
//   marched    a place on a ray, up to 400 units from the origin, is off by 3·10⁻⁵, of each of up to 128 samples
// A part is compared by what it adds to the picture, and by that times its distance, because one that adds little rounds its own values.
// Steps of a march depend on those before: where a ray that starts 10⁻⁴ higher or lower ends elsewhere in the C++ alone, the point is drawn
// anew.
#include <cmath>
#include <utility>

#include "preview/backdrop/dust.h"
#include "preview/backdrop/marched_clouds.h"
#include "preview/backdrop/noise.h"
#include "preview/backdrop/slab_clouds.h"
#include "preview/shading_math.h"
#include "tests/browser/glsl_text.h"
#include "tests/browser/glsl_values.h"

namespace cloudbake {

namespace {

constexpr float kNowhere = 1e30F;  // as in samples.glsl

// --- Settings: no two values that could be mistaken for each other are equal ---

const SlabSettings& testedSlab() {
  static const SlabSettings settings = [] {
    SlabSettings s;
    s.seed = 11;
    s.time_seconds = 37;
    s.threshold = 0.3F, s.low_share = 0.4F;
    s.edge_width = 0.2F;
    s.bright = 1.2F;
    s.least_den = 0.25F;
    s.day_luminance = 0.5F;
    return s;
  }();
  return settings;
}

const DistanceCloudSettings& testedDistance() {
  static const DistanceCloudSettings settings = [] {
    DistanceCloudSettings s;
    s.scale = 0.7F;
    s.noise_frequency = 0.35F, s.noise_offset = 0.45F;
    s.seed = 13;
    s.wind = {0.3F, 0.1F, -0.2F}, s.time_seconds = 21;
    s.dense_color = {0.1F, 0.2F, 0.3F};
    s.farthest = 20;
    s.shadow_tuning = 0.6F, s.shadow_distance = 1.3F;
    s.tint = {1.1F, 0.95F, 0.9F};
    s.dither = 0.8F;
    return s;
  }();
  return settings;
}

const DensityCloudSettings& testedDensity() {
  static const DensityCloudSettings settings = [] {
    DensityCloudSettings s;
    s.scale = 0.8F;
    s.noise_frequency = 0.17F;
    s.seed = 17;
    s.wind = {-0.2F, 0.1F, 0.3F}, s.time_seconds = 23;
    s.dense_color = {0.12F, 0.14F, 0.16F};
    s.first_t = 0.13F, s.step_growth = 0.25F;
    s.tint = {0.9F, 1.05F, 1.1F};
    s.dither = 0.7F;
    return s;
  }();
  return settings;
}

std::string slabText(const SlabSettings& s) { return glslStruct("Slab", glslMembers(slabKeys(), s), glslMembers(slabToneKeys(), s.tones)); }
std::string distanceText(const DistanceCloudSettings& s) { return glslStruct("DistanceClouds", glslMembers(distanceCloudKeys(), s)); }
std::string densityText(const DensityCloudSettings& s) { return glslStruct("DensityClouds", glslMembers(densityCloudKeys(), s)); }

// --- Points ---

bool isNear(const Texel& a, const Texel& b, float tolerance) {
  for (size_t i = 0; i < 4; ++i)
    if (!(std::abs(a[i] - b[i]) <= tolerance * std::max(1.0F, std::abs(b[i])))) return false;
  return true;
}

// A point whose value hardly changes 10⁻⁴ up or down, and which mostly is neither 0 nor 1. make() draws its inputs and gives value(up).
template <typename Make>
Point steadyPoint(Draws& draw, float tolerance, const Make& make) {
  for (;;) {
    const auto [inputs, value] = make();
    const Texel here = value(0.0F);
    const bool is_plain = here == Texel{} || here == Texel{1, 0, 0, 0};
    if (is_plain && draw.between(0, 1) > 0.05F) continue;
    if (isNear(value(1e-4F), here, tolerance) && isNear(value(-1e-4F), here, tolerance)) return {inputs, here};
  }
}

// --- Random numbers ---

// A number of 64 bits as four of 16, the low ones first.
Texel bits(uint64_t value) {
  Texel parts{};
  for (int i = 0; i < 4; ++i) parts[size_t(i)] = float(value >> (16 * i) & 0xFFFF);
  return parts;
}

uint64_t anyBits(Draws& draw) {
  uint64_t value = 0;
  for (int i = 0; i < 4; ++i) value = value << 16 | uint64_t(draw.between(0, 65536));
  return value;
}

const std::string kBits = R"(
uvec2 bitsOf(vec4 parts) { uvec4 p = uvec4(parts); return uvec2(p.x | (p.y << 16u), p.z | (p.w << 16u)); }
vec4 partsOf(uvec2 b) { return vec4(b.x & 0xffffu, b.x >> 16u, b.y & 0xffffu, b.y >> 16u); }
)";

std::vector<Function> randomFunctions() {
  const auto mixed = [](Draws& draw) {
    const uint64_t any = anyBits(draw);
    return Point{{bits(any)}, bits(mix64(any))};
  };
  // A carry from the low half is as frequent as none.
  const auto sum = [](Draws& draw) {
    const uint64_t a = anyBits(draw), b = anyBits(draw);
    return Point{{bits(a), bits(b)}, bits(a + b)};
  };
  // The ray is sometimes the last one, whose successor needs a carry.
  const auto drawn = [](Draws& draw) {
    const uint64_t stream = anyBits(draw), any = anyBits(draw);
    const uint32_t ray = draw.between(0, 1) < 0.1F ? UINT32_MAX : uint32_t(any), dimension = uint32_t(any >> 32);
    return Point{{bits(stream), bits(uint64_t(dimension) << 32 | ray)}, bits(hashDraw(stream, ray, dimension))};
  };
  const auto jitter = [](Draws& draw) {
    const uint64_t any = anyBits(draw);
    const auto seed = uint32_t(any), x = uint32_t(draw.between(0, 8000)), y = uint32_t(draw.between(0, 8000));
    return Point{{bits(seed), {float(x), float(y), 0, 0}}, {uniformFloat(hashDraw(mix64(seed + kGolden64), x, y)), 0, 0, 0}};
  };
  return {{"random", "mix64", "partsOf(mix64(bitsOf(p[0])))", "partsOf(mix64(bitsOf(p[0]).yx))", 0, 0, mixed, {}, kBits},
          {"random",
           "sum64",
           "partsOf(sum64(bitsOf(p[0]), bitsOf(p[1])))",
           "partsOf(sum64(bitsOf(p[0]), bitsOf(p[1]).yx))",
           0,
           0,
           sum,
           {},
           kBits},
          {"random",
           "hashDraw",
           "partsOf(hashDraw(bitsOf(p[0]), bitsOf(p[1]).x, bitsOf(p[1]).y))",
           "partsOf(hashDraw(bitsOf(p[0]), bitsOf(p[1]).y, bitsOf(p[1]).x))",
           0,
           0,
           drawn,
           {},
           kBits},
          {"random",
           "uniformFloat",
           "vec4(uniformFloat(hashDraw(pixelStream(bitsOf(p[0]).x), uint(p[1].x), uint(p[1].y))), 0.0, 0.0, 0.0)",
           "vec4(uniformFloat(hashDraw(pixelStream(bitsOf(p[0]).x), uint(p[1].y), uint(p[1].x))), 0.0, 0.0, 0.0)",
           0,
           0,
           jitter,
           {},
           kBits}};
}

// --- Noise ---

std::vector<Function> noisesOfClouds() {
  const auto octaves2 = [](Draws& draw) {
    const Vec2 p{draw.between(-100, 100), draw.between(-100, 100)};
    const FbmSettings fbm{.octaves = 1 + int(draw.between(0, 5)), .seed = uint32_t(draw.between(0, 4000))};
    const Noise2 noise = fbmValue2(p, fbm);
    return Point{{{p.x, p.y, float(fbm.octaves), float(fbm.seed)}}, {noise.value, noise.gradient.x, noise.gradient.y, 0}};
  };
  // Under the limit the value is that of all octaves; else only that it is not under the limit is of use.
  const auto limited = [](Draws& draw) {
    const Vec3 p{draw.between(-100, 100), draw.between(-100, 100), draw.between(-100, 100)};
    const FbmSettings fbm{.octaves = 5, .seed = uint32_t(draw.between(0, 4000))};
    const float value = fbmValueOnly3(p, fbm), limit = draw.between(0.4F, 1);
    return Point{{texel(p, float(fbm.seed)), {limit, 0, 0, 0}}, {std::min(value, limit), 0, 0, 0}};
  };
  return {{"noise", "fbmValue2", "vec4(fbmValue2(p[0].xy, int(p[0].z), 0.5, uint(p[0].w)), 0.0)",
           "vec4(fbmValue2(p[0].yx, int(p[0].z), 0.5, uint(p[0].w)), 0.0)", 1e-6, 0, octaves2},
          {"noise", "fbmValueUnder3", "vec4(min(p[1].x, fbmValueUnder3(p[0].xyz, 5, 0.5, uint(p[0].w), p[1].x)), 0.0, 0.0, 0.0)",
           "vec4(min(p[1].x, fbmValueUnder3(p[0].xyz, 4, 0.5, uint(p[0].w), p[1].x)), 0.0, 0.0, 0.0)", 1e-6, 0, limited}};
}

// --- Samples of a march and their parts ---

// Some surfaces along a ray, each at a distance between two, of which one may be clear and one opaque.
std::vector<Layer> someSurfaces(Draws& draw, float near, float far) {
  std::vector<Layer> surfaces(2, blankLayer(1, 1));
  for (Layer& surface : surfaces) surface.at(0, 0) = {{}, std::floor(draw.between(0, 3)) / 2, draw.between(near, far)};
  return surfaces;
}

Texel cutsTexel(const Cuts& cuts) {
  Texel result{kNowhere, kNowhere, 0, 0};
  for (int i = 0; i < cuts.count; ++i) {
    result[size_t(i)] = cuts.cuts[size_t(i)].distance;
    result[size_t(i) + 2] = cuts.cuts[size_t(i)].is_opaque ? 1 : 0;
  }
  return result;
}

// What a part adds to the picture: colour and opacity times what the parts before it let through, or only the opacity with that times the
// distance.
Texel addedBy(const CutPixels& parts, int part, bool distance_wanted) {
  float left = 1;
  for (int i = 0; i < part; ++i) left *= 1 - parts[size_t(i)].opacity;
  const LayerPixel& pixel = parts[size_t(part)];
  const float added = pixel.opacity * left;
  return distance_wanted ? Texel{added > 0 ? added * pixel.distance : 0, added, 0, 0} : texel(pixel.color * added, added);
}

const std::string kParts = R"(
Cuts cutsOf(vec4 c) { return Cuts(int(c.x < NOWHERE) + int(c.y < NOWHERE), c.xy, bvec2(c.z > 0.5, c.w > 0.5)); }
// w: the part, and 4 more for its distance.
vec4 addedBy(vec4 colors[3], vec3 distances, float wanted) {
  int part = int(wanted) % 4;
  float left = 1.0;
  for (int i = 0; i < part; i++) {
    left *= 1.0 - colors[i].a;
  }
  float added = colors[part].a * left;
  if (wanted < 4.0) {
    return vec4(colors[part].rgb * added, added);
  }
  return vec4(added > 0.0 ? added * distances[part] : 0.0, added, 0.0, 0.0);
}
)";

struct Wanted {
  int part;
  bool distance;
  float code() const { return float(part + (distance ? 4 : 0)); }
};
Wanted someWanted(Draws& draw) { return {int(draw.between(0, 3)), draw.between(0, 1) < 0.5F}; }

constexpr int kSamples = 5;

// Samples with steps of up to 2, from which cuts take parts.
Point samplesPoint(Draws& draw) {
  return steadyPoint(draw, 0, [&] {
    const Cuts cuts = cutsAt(someSurfaces(draw, 0, 8), 0, 0, 0, 1);
    const Wanted wanted = someWanted(draw);
    SampleSum sum(1, kSamples, 0.99F, cuts);
    std::vector<Texel> inputs{cutsTexel(cuts), {wanted.code(), 0, 0, 0}};
    for (int i = 0; i < kSamples; ++i) {
      const CloudSample sample{draw.color(), std::max(0.0F, draw.between(-0.2F, 1)), i + 1 < kSamples ? draw.between(0, 2) : INFINITY};
      if (sum.more()) sum.take(sample);
      inputs.push_back(texel(sample.color, sample.opacity));
      inputs.push_back({std::min(sample.step, kNowhere), 0, 0, 0});
    }
    const Texel added = addedBy(sum.pixels(), wanted.part, wanted.distance);
    return std::pair(inputs, [added](float) { return added; });
  });
}

std::vector<Function> sampleFunctions() {
  const auto limits = [](Draws& draw) {
    const Cuts cuts = cutsAt(someSurfaces(draw, 0, 8), 0, 0, 0, 1);
    const int part = int(draw.between(0, 3));
    const float distance = draw.between(0, 8);
    return Point{{cutsTexel(cuts), {float(part), distance, 0, 0}},
                 {std::min(kNowhere, cuts.hiddenFrom()), std::min(kNowhere, cuts.within(size_t(part), distance)), 0, 0}};
  };
  const std::string prelude = kParts + R"(
// The inputs of a point of samplesPoint.
vec4 summed(vec4 p[12], float end) {
  SampleSum sum = startSamples(1.0, 5, 0.99, cutsOf(p[0]));
  for (int i = 0; i < 5 && moreSamples(sum); i++) {
    takeSample(sum, p[2 + 2 * i].rgb, p[2 + 2 * i].a, p[3 + 2 * i].x * end);
  }
  endSamples(sum);
  return addedBy(sum.colors, sum.distances, p[1].x);
})";
  return {{"samples",
           "hiddenFrom, withinPart",
           "vec4(hiddenFrom(cutsOf(p[0])), withinPart(cutsOf(p[0]), int(p[1].x), p[1].y), 0.0, 0.0)",
           "vec4(hiddenFrom(cutsOf(0.9 * p[0])), withinPart(cutsOf(0.9 * p[0]), int(p[1].x), p[1].y), 0.0, 0.0)",
           0,
           0,
           limits,
           {},
           kParts},
          {"samples", "takeSample", "summed(p, 1.0)", "summed(p, 0.9)", 5e-6, 5e-6, samplesPoint, {}, prelude}};
}

// --- Rays through clouds ---

Vec3 moved(Vec3 p, float up) { return p + Vec3{0, up, 0}; }

// A camera of one pixel, whose ray has an origin and about this direction.
Camera pixelCamera(Vec3 origin, Vec3 direction) {
  Camera camera;
  camera.look_from = origin, camera.look_at = origin + direction * 10;
  camera.width = camera.height = 1;
  return camera;
}
Ray rayOf(const Camera& camera) { return CameraRays(camera).at(0.5F, 0.5F); }

CutPixels pixelsOf(const std::vector<Layer>& layers) {
  CutPixels pixels;
  for (size_t i = 0; i < layers.size(); ++i) pixels[i] = layers[i].at(0, 0);
  return pixels;
}

// A part of what render(camera, surfaces) draws of some ray: p[0] and p[1] are the ray, p[2] the cuts, p[1].w says what is wanted.
template <typename Render>
Point partPoint(Draws& draw, float low, float high, float tolerance, const Render& render) {
  return steadyPoint(draw, tolerance, [&] {
    const Vec3 origin{draw.between(-300, 300), draw.between(low, high), draw.between(-300, 300)};
    const Camera camera = pixelCamera(origin, *normalized(draw.direction() + Vec3{0, 1.2F, 0}));
    const std::vector<Layer> surfaces = someSurfaces(draw, 0, 12);
    const Wanted wanted = someWanted(draw);
    const Ray ray = rayOf(camera);
    const auto value = [=](float up) {
      Camera other = camera;
      other.look_from = moved(camera.look_from, up), other.look_at = moved(camera.look_at, up);
      return addedBy(pixelsOf(render(other, surfaces)), wanted.part, wanted.distance);
    };
    return std::pair(std::vector<Texel>{texel(ray.origin), texel(ray.direction, wanted.code()), cutsTexel(cutsAt(surfaces, 0, 0, 0, 1))},
                     value);
  });
}

// What pass(points, shares) leaves of a light at some point.
template <typename Pass>
Point passPoint(Draws& draw, float low, float high, float tolerance, const Pass& pass) {
  return steadyPoint(draw, tolerance, [&] {
    const Vec3 point{draw.between(-300, 300), draw.between(low, high), draw.between(-300, 300)};
    const Vec3 to_light = *normalized(draw.direction() + Vec3{0, 1.2F, 0});
    // What is kept from the point, so that it is 0 in clear sky.
    const auto value = [=](float up) {
      const Vec3 other = moved(point, up);
      float share = 1;
      pass({&other, 1}, to_light, {&share, 1});
      return Texel{1 - share, 0, 0, 0};
    };
    return std::pair(std::vector<Texel>{texel(point), texel(to_light)}, value);
  });
}

// --- The slab ---

Point slabNoisePoint(Draws& draw) {
  const Vec2 p{draw.between(-300, 300), draw.between(-300, 300)};
  const Noise2 noise = slabNoise(p.x, p.y, testedSlab());
  return {{{p.x, p.y, 0, 0}}, {noise.value, noise.gradient.x, noise.gradient.y, 0}};
}

Point slabProfilePoint(Draws& draw) {
  const SlabSettings& s = testedSlab();
  const float noise = draw.between(0, 1), y = draw.between(s.bottom - 0.3F, s.top + 0.3F), step = draw.between(0.01F, 1);
  const SlabProfile profile = slabProfile(noise, s);
  return {{{noise, y, step, 0}}, {profile.lower, profile.upper, slabThickening(y, step, profile, s.edge_width), 0}};
}

Point slabFactorsPoint(Draws& draw) {
  const SlabSettings& s = testedSlab();
  const float view_y = draw.between(0.01F, 0.4F), thickness = draw.between(0, 40);
  return {{{view_y, thickness, 0, 0}}, {slabOpacity(thickness, view_y, s), slabHorizonFade(view_y, s), 0, 0}};
}

Point slabTonePoint(Draws& draw) {
  const float den = draw.between(0, 1), facing = draw.between(-1, 1);
  return {{{den, facing, 0, 0}}, texel(slabTone(den, facing, testedSlab()))};
}

Point slabHitPoint(Draws& draw) {
  return steadyPoint(draw, 5e-3F, [&] {
    const Ray ray{{draw.between(-300, 300), draw.between(-1, 6), draw.between(-300, 300)},
                  *normalized(draw.direction() + Vec3{0, 1.2F, 0})};
    const float jitter = draw.between(0, 1);
    const auto value = [=](float up) {
      const SlabHit hit = marchSlab({moved(ray.origin, up), ray.direction}, jitter, testedSlab());
      return hit.thickness > 0 ? Texel{hit.opacity, hit.den, hit.facing, hit.distance} : Texel{};
    };
    return std::pair(std::vector<Texel>{texel(ray.origin, jitter), texel(ray.direction)}, value);
  });
}

// Without outlines, which need more than one pixel.
Point slabPartPoint(Draws& draw) {
  return partPoint(draw, -1, 6, 5e-3F,
                   [](const Camera& camera, std::span<const Layer> surfaces) { return renderSlabClouds(camera, testedSlab(), surfaces); });
}

Point slabPassPoint(Draws& draw) {
  return passPoint(draw, -1, 6, 2e-3F, [](std::span<const Vec3> points, Vec3 to_light, std::span<float> shares) {
    passSlab(points, to_light, testedSlab(), shares);
  });
}

std::vector<Function> slabFunctions() {
  const std::string prelude = "Slab tested() { return " + slabText(testedSlab()) + "; }" + kParts + R"(
vec4 factorsAt(float view_y, float thickness) {
  return vec4(slabOpacity(thickness, view_y, tested()), slabHorizonFade(view_y, tested()), 0.0, 0.0);
}
vec4 profileAt(float noise, float y, float distance) {
  vec2 profile = slabProfile(noise, tested());
  return vec4(profile, slabThickening(y, distance, profile, tested().edge_width), 0.0);
}
vec4 hitOf(vec3 origin, vec3 direction, float jitter) {
  SlabHits hits = marchSlab(origin, direction, jitter, cutsOf(vec4(NOWHERE)), tested());
  return hits.thicknesses.x > 0.0 ? vec4(hits.opacities.x, hits.dens.x, hits.facings.x, hits.distances.x) : vec4(0.0);
}
// As slab_march.frag and slab.frag.
vec4 partOf(vec3 origin, vec3 direction, Cuts cuts, float wanted) {
  float jitter = tested().dither * uniformFloat(hashDraw(pixelStream(tested().seed), 0u, 0u));
  SlabHits hits = marchSlab(origin, direction, jitter, cuts, tested());
  float before = 0.0;
  vec4 colors[3];
  for (int part = 0; part < 3; part++) {
    float so_far = hits.opacities[part] * slabHorizonFade(direction.y, tested());
    float opacity = so_far > before ? (so_far - before) / (1.0 - before) : 0.0;
    colors[part] = vec4(slabTone(hits.dens[part], hits.facings[part], tested()), opacity);
    before = so_far;
  }
  return addedBy(colors, hits.distances, wanted);
}
// As pass_slab.frag.
vec4 passOf(vec3 point, vec3 to_light) {
  SlabHits hits = marchSlab(point, to_light, 0.5, cutsOf(vec4(NOWHERE)), tested());
  return vec4(slabHorizonFade(to_light.y, tested()) * hits.opacities.z, 0.0, 0.0, 0.0);
})";
  const auto one = [&](const char* name, const char* call, const char* wrong, double bound, Point (*point)(Draws&)) {
    return Function{"slab", name, call, wrong, bound, bound, point, {"noise", "shading", "random", "samples"}, prelude};
  };
  return {one("slabNoise", "vec4(slabNoise(p[0].xy, tested()), 0.0)", "vec4(slabNoise(p[0].yx, tested()), 0.0)", 2e-4, slabNoisePoint),
          one("slabProfile, slabThickening", "profileAt(p[0].x, p[0].y, p[0].z)", "profileAt(1.01 * p[0].x, p[0].y, p[0].z)", 1e-6,
              slabProfilePoint),
          one("slabOpacity, slabHorizonFade", "factorsAt(p[0].x, p[0].y)", "factorsAt(1.01 * p[0].x, p[0].y)", 1e-6, slabFactorsPoint),
          one("slabTone", "vec4(slabTone(p[0].x, p[0].y, tested()), 0.0)", "vec4(slabTone(1.01 * p[0].x, 1.01 * p[0].y, tested()), 0.0)",
              1e-6, slabTonePoint),
          one("marchSlab", "hitOf(p[0].xyz, p[1].xyz, p[0].w)", "hitOf(p[0].zyx, p[1].xyz, p[0].w)", 5e-3, slabHitPoint),
          one("marchSlab with cuts", "partOf(p[0].xyz, p[1].xyz, cutsOf(p[2]), p[1].w)", "partOf(p[0].zyx, p[1].xyz, cutsOf(p[2]), p[1].w)",
              1e-2, slabPartPoint),
          one("passSlab", "passOf(p[0].xyz, p[1].xyz)", "passOf(p[0].zyx, p[1].xyz)", 2e-3, slabPassPoint)};
}

// --- Marched clouds ---

const SkySettings& testedSky() {
  static const SkySettings sky = [] {
    SkySettings s;
    s.to_sun = *normalized(Vec3{0.5F, 0.6F, -0.3F});
    return s;
  }();
  return sky;
}

Point distanceDensityPoint(Draws& draw) {
  return steadyPoint(draw, 1e-3F, [&] {
    const float middle = testedDistance().cloud_height;
    const Vec3 p{draw.between(-300, 300), draw.between(middle - 4, middle + 4), draw.between(-300, 300)};
    const auto value = [=](float up) { return Texel{distanceCloudDensity(moved(p, up), testedDistance()), 0, 0, 0}; };
    return std::pair(std::vector<Texel>{texel(p)}, value);
  });
}

Point densityDensityPoint(Draws& draw) {
  return steadyPoint(draw, 1e-3F, [&] {
    const float middle = testedDensity().cloud_height;
    const Vec3 p{draw.between(-300, 300), draw.between(middle - 6, middle + 6), draw.between(-300, 300)};
    const auto value = [=](float up) { return Texel{densityCloudDensity(moved(p, up), testedDensity()), 0, 0, 0}; };
    return std::pair(std::vector<Texel>{texel(p)}, value);
  });
}

// The search along a whole ray.
Point searchPoint(Draws& draw) {
  return steadyPoint(draw, 2e-4F, [&] {
    const Vec3 origin{draw.between(-300, 300), draw.between(0, 8), draw.between(-300, 300)};
    const Vec3 direction = *normalized(draw.direction() + Vec3{0, 1.2F, 0});
    const float start = draw.between(0, 3);
    const auto value = [=](float up) {
      const auto field = [&](float t) { return distanceCloudField(moved(origin, up) + direction * t, testedDistance()); };
      return Texel{std::min(kNowhere, findDistanceCloud(field, start, testedDistance())), 0, 0, 0};
    };
    return std::pair(std::vector<Texel>{texel(origin, start), texel(direction)}, value);
  });
}

Point distancePartPoint(Draws& draw) {
  return partPoint(draw, 0, 5, 5e-4F, [](const Camera& camera, std::span<const Layer> surfaces) {
    return renderDistanceClouds(camera, testedSky(), testedDistance(), surfaces);
  });
}

Point distancePassPoint(Draws& draw) {
  return passPoint(draw, 0, 7, 5e-4F, [](std::span<const Vec3> points, Vec3 to_light, std::span<float> shares) {
    passDistanceClouds(points, to_light, testedDistance(), shares);
  });
}

Point densityStepPoint(Draws& draw) {
  const DensityCloudSettings& s = testedDensity();
  const float t = draw.between(0, 60);
  const CloudSample sample = densityCloudSample(t, 0.5F, 0, {}, s);
  // Where a rounding decides about the number of parts, C++ and GLSL may differ.
  const float parts = densityCloudStep(t, s) / s.part_length;
  if (std::abs(parts - std::round(parts)) < 1e-4F) return densityStepPoint(draw);
  return {{{t, 0, 0, 0}}, {sample.step, sample.opacity, 0, 0}};
}

Point densityPartPoint(Draws& draw) {
  return partPoint(draw, 0, 8, 5e-4F, [](const Camera& camera, std::span<const Layer> surfaces) {
    return renderDensityClouds(camera, testedSky(), testedDensity(), surfaces);
  });
}

Point densityPassPoint(Draws& draw) {
  return passPoint(draw, 0, 8, 5e-4F, [](std::span<const Vec3> points, Vec3 to_light, std::span<float> shares) {
    passDensityClouds(points, to_light, testedDensity(), shares);
  });
}

std::string skyText(const SkySettings& s) {
  return glslStruct("Sky", s.to_sun, s.colors.zenith, s.colors.low_sky, s.colors.horizon, s.colors.ground, s.colors.sun_color,
                    glslStruct("vec3", s.disc.exponent, s.disc.gain, s.glow), s.horizon_exponent, s.viewer_height,
                    "vec4(" + glslOf(s.colors.horizon) + ", " + glslOf(s.horizon_strength) + ")");
}

std::vector<Function> marchedFunctions() {
  const std::string prelude = "\nDistanceClouds distanceClouds() { return " + distanceText(testedDistance()) +
                              "; }\nDensityClouds densityClouds() { return " + densityText(testedDensity()) +
                              "; }\nconst vec3 TO_LIGHT = " + glslOf(testedSky().to_sun) + ";\nSky testedSky() { return " +
                              skyText(testedSky()) + "; }\n" + kParts + R"(
vec3 shadowAt(vec3 point) { return vec3(1.0); }
float jitterOf(uint seed) { return uniformFloat(hashDraw(hashDraw(pixelStream(seed), 0u, 0u), 0u, 0u)); }
Cuts scaled(Cuts cuts, float scale) {
  cuts.distances /= scale;
  return cuts;
}
// As distance.frag and density.frag.
vec4 distancePart(vec3 origin, vec3 direction, vec4 cuts, float wanted) {
  DistanceClouds s = distanceClouds();
  Cuts own = scaled(cutsOf(cuts), s.scale);
  SampleSum sum = marchDistanceCloud(origin / s.scale, direction, TO_LIGHT, s.dither * jitterOf(s.seed), own, s);
  return addedBy(sum.colors, sum.distances * s.scale, wanted);
}
vec4 densityPart(vec3 origin, vec3 direction, vec4 cuts, float wanted) {
  DensityClouds s = densityClouds();
  vec3 sky = skyColor(direction, testedSky());
  Cuts own = scaled(cutsOf(cuts), s.scale);
  SampleSum sum = marchDensityCloud(origin / s.scale, direction, TO_LIGHT, sky, s.dither * jitterOf(s.seed), own, s);
  return addedBy(sum.colors, sum.distances * s.scale, wanted);
}
// As pass_distance.frag and pass_density.frag.
vec4 distancePass(vec3 point, vec3 to_light) {
  DistanceClouds s = distanceClouds();
  return vec4(marchDistanceCloud(point / s.scale, to_light, to_light, 0.0, cutsOf(vec4(NOWHERE)), s).colors[0].a, 0.0, 0.0, 0.0);
}
vec4 densityPass(vec3 point, vec3 to_light) {
  DensityClouds s = densityClouds();
  return vec4(marchDensityCloud(point / s.scale, to_light, to_light, vec3(0.0), 0.0, cutsOf(vec4(NOWHERE)), s).colors[0].a, 0.0, 0.0, 0.0);
}
vec4 stepAt(float t) {
  vec2 divided = densityStep(t, densityClouds());
  return vec4(divided.x, shareOfOpacity(0.5 * densityClouds().opacity_factor, 1.0 / divided.y), 0.0, 0.0);
}
vec4 searchFrom(vec3 origin, vec3 direction, float start) {
  return vec4(findDistanceCloud(origin, direction, vec2(start, NOWHERE), NOWHERE, distanceClouds()), 0.0, 0.0, 0.0);
})";
  const auto one = [&](const char* name, const char* call, const char* wrong, double bound, Point (*point)(Draws&)) {
    return Function{"marched", name, call, wrong, bound, bound, point, {"sky", "noise", "shading", "random", "samples"}, prelude};
  };
  return {one("distanceDensity", "vec4(distanceDensity(p[0].xyz, distanceClouds()), 0.0, 0.0, 0.0)",
              "vec4(distanceDensity(p[0].zyx, distanceClouds()), 0.0, 0.0, 0.0)", 1e-6, distanceDensityPoint),
          one("findDistanceCloud", "searchFrom(p[0].xyz, p[1].xyz, p[0].w)", "searchFrom(p[0].zyx, p[1].xyz, p[0].w)", 2e-4, searchPoint),
          one("marchDistanceCloud", "distancePart(p[0].xyz, p[1].xyz, p[2], p[1].w)", "distancePart(p[0].zyx, p[1].xyz, p[2], p[1].w)",
              5e-4, distancePartPoint),
          one("passDistanceClouds", "distancePass(p[0].xyz, p[1].xyz)", "distancePass(p[0].zyx, p[1].xyz)", 5e-4, distancePassPoint),
          one("densityDensity", "vec4(densityDensity(p[0].xyz, densityClouds()), 0.0, 0.0, 0.0)",
              "vec4(densityDensity(p[0].zyx, densityClouds()), 0.0, 0.0, 0.0)", 1e-6, densityDensityPoint),
          one("densityStep, shareOfOpacity", "stepAt(p[0].x)", "stepAt(1.01 * p[0].x)", 1e-6, densityStepPoint),
          one("marchDensityCloud", "densityPart(p[0].xyz, p[1].xyz, p[2], p[1].w)", "densityPart(p[0].zyx, p[1].xyz, p[2], p[1].w)", 5e-4,
              densityPartPoint),
          one("passDensityClouds", "densityPass(p[0].xyz, p[1].xyz)", "densityPass(p[0].zyx, p[1].xyz)", 5e-4, densityPassPoint)};
}

// --- Dust ---

const Box kDusty{{-520, -240, -400}, {480, 280, 440}};
constexpr float kDustyReach = 1.3F;

const DustSettings& testedDust() {
  static const DustSettings dust{.reach = kDustyReach,
                                 .thickness = 40,
                                 .fade_start = 0.3F,
                                 .color = {1, 0.7F, 0.4F},
                                 .asymmetry = 0.6F,
                                 .ambient = 0.8F,
                                 .samples = 12,
                                 .dither = 0.7F,
                                 .seed = 5};
  return dust;
}

Point dustPoint(Draws& draw) {
  return partPoint(draw, -100, 100, 5e-3F, [](const Camera& camera, std::span<const Layer> surfaces) {
    const LightAt light = [](Vec3 p, Vec3 to_light) {
      return to_light == Vec3{0, 1, 0} ? 0.5F + 0.5F * std::sin(0.02F * p.y) : 0.5F + 0.5F * std::sin(0.01F * p.x);
    };
    return renderDust(camera, testedSky(), kDusty, {}, testedDust(), light, surfaces);
  });
}

std::vector<Function> dustFunctions() {
  const DustSettings& s = testedDust();
  const Vec3 half = kDusty.size() * (0.5F * kDustyReach), center = kDusty.center();
  const auto row = [](Vec3 axis, float size, float middle) { return "vec4(" + glslOf(axis / size) + ", " + glslOf(-middle / size) + ")"; };
  const std::string prelude = "const mat4 ball = mat4(" + row({1, 0, 0}, half.x, center.x) + ", " + row({0, 1, 0}, half.y, center.y) +
                              ", " + row({0, 0, 1}, half.z, center.z) + ", vec4(0.0));\nconst vec3 to_sun = " + glslOf(testedSky().to_sun) +
                              ";\nconst vec3 sun = " + glslOf(testedSky().colors.sun_color) +
                              ";\nconst vec3 sky = " + glslOf(testedSky().colors.ambient_sky) + ";\n" + kParts + R"(
vec2 dustLight(vec3 p) {
  return vec2(0.5 + 0.5 * sin(0.01 * p.x), 0.5 + 0.5 * sin(0.02 * p.y));
}
// As dust.frag.
vec4 partOf(vec3 origin, vec3 direction, Cuts cuts, float wanted) {
  Dust dust = Dust()" + glslMembers(dustKeys(), s) +
                              R"();
  float jitter = dust.dither * (uniformFloat(hashDraw(hashDraw(pixelStream(dust.seed), 0u, 0u), 0u, 0u)) - 0.5);
  SampleSum sum = marchDust(origin, direction, ball, 1000.0, to_sun, sun, sky, jitter, cuts, dust);
  return addedBy(sum.colors, sum.distances, wanted);
})";
  return {{"dust",
           "marchDust",
           "partOf(p[0].xyz, p[1].xyz, cutsOf(p[2]), p[1].w)",
           "partOf(p[0].zyx, p[1].zyx, cutsOf(p[2]), p[1].w)",
           5e-3,
           5e-3,
           dustPoint,
           {"noise", "shading", "random", "samples", "light"},
           prelude}};
}

}  // namespace

std::vector<Function> cloudFunctions() {
  std::vector<Function> all;
  for (const auto& functions :
       {randomFunctions(), noisesOfClouds(), sampleFunctions(), slabFunctions(), marchedFunctions(), dustFunctions()})
    for (const Function& f : functions) {
      all.push_back(f);
      all.back().points = marchedPoints();
    }
  return all;
}

}  // namespace cloudbake
