// The functions of shaders/functions/layers/night.glsl and grade.glsl.
#include <algorithm>
#include <cmath>
#include <memory>

#include "preview/backdrop/sky.h"
#include "preview/grade.h"
#include "preview/shading_math.h"
#include "tests/browser/glsl_text.h"
#include "tests/browser/glsl_values.h"

namespace cloudbake {

namespace {

// From low to high, as many values of each order of magnitude.
float magnitude(Draws& draw, float low, float high) { return low * std::pow(high / low, draw.between(0, 1)); }

Vec3 near(Vec3 direction, float reach, Draws& draw) { return *normalized(direction + draw.direction() * (reach * draw.between(0, 1))); }

// A point whose value(view) stays the same where the view is turned as far as rounding may turn it: on the border of a star's cell, C++ and
// GLSL may see different stars.
template <typename Value>
bool isSteady(Vec3 view, const Value& value) {
  const Vec3 here = value(view);
  for (const Vec3 turn : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}})
    if (length(value(*normalized(view + turn * 1e-6F)) - here) > 1e-3F) return false;
  return true;
}

AuroraSettings someAurora(Draws& draw) {
  AuroraSettings aurora;
  aurora.low_color = draw.color(), aurora.high_color = draw.color();
  aurora.bottom_degrees = draw.between(0, 20), aurora.top_degrees = draw.between(30, 85);
  aurora.strength = draw.between(0.2F, 2), aurora.speed = draw.between(0, 3), aurora.time_seconds = draw.between(0, 100);
  aurora.scale = draw.between(0.5F, 3), aurora.ray_scale = draw.between(4, 30);
  aurora.low_height = draw.between(-0.3F, -0.15F), aurora.high_height = draw.between(-0.1F, 0.1F);
  aurora.seed = uint32_t(draw.between(0, 4000));
  return aurora;
}

SmoothDiscSettings someSmoothDisc(Draws& draw) { return {draw.between(0, 0.2F), draw.between(0.5F, 4), draw.between(0.02F, 0.1F)}; }

MoonSettings someMoon(Draws& draw) {
  MoonSettings moon;
  moon.direction = draw.direction(), moon.up = draw.direction();
  moon.disc = {magnitude(draw, 300, 30000), magnitude(draw, 10, 1e8F)};
  moon.color = draw.color();
  moon.smooth_disc = someSmoothDisc(draw);
  moon.phase_degrees = draw.between(-120, 120);
  return moon;
}

// How far its disc reaches.
float radiusOf(const MoonSettings& moon) { return std::sqrt(2 * std::log(2 * moon.disc.gain) / moon.disc.exponent); }

StarSettings someStars(Draws& draw) {
  StarSettings stars;
  stars.count = int(magnitude(draw, 100, 20000));
  stars.brightness = draw.between(0.5F, 3);
  stars.size_degrees = draw.between(0.2F, 2);
  stars.tint = draw.between(0, 1);
  stars.low_height = draw.between(-0.3F, -0.15F), stars.high_height = draw.between(-0.1F, 0.1F);
  stars.seed = uint32_t(draw.between(0, 4000));
  stars.pole = draw.direction();
  stars.turn_degrees = draw.between(-720, 720), stars.day_turn_degrees = draw.between(0, 360);
  return stars;
}

void add(std::vector<Texel>& inputs, const MoonSettings& moon) {
  inputs.push_back(texel(moon.direction, moon.phase_degrees));
  inputs.push_back(texel(moon.up, moon.disc.exponent));
  inputs.push_back(texel(moon.color, moon.disc.gain));
  inputs.push_back({moon.smooth_disc.radius, moon.smooth_disc.softness, moon.smooth_disc.gain, 0});
}

void add(std::vector<Texel>& inputs, const StarSettings& stars) {
  inputs.push_back({float(stars.count), stars.brightness, stars.size_degrees, stars.tint});
  inputs.push_back({stars.low_height, stars.high_height, float(stars.seed), stars.turn_degrees});
  inputs.push_back(texel(stars.pole, stars.day_turn_degrees));
}

void add(std::vector<Texel>& inputs, const AuroraSettings& aurora) {
  inputs.push_back(texel(aurora.low_color, aurora.bottom_degrees));
  inputs.push_back(texel(aurora.high_color, aurora.top_degrees));
  inputs.push_back({aurora.strength, aurora.speed, aurora.scale, aurora.ray_scale});
  inputs.push_back({aurora.low_height, aurora.high_height, float(aurora.seed), aurora.time_seconds});
}

void add(std::vector<Texel>& inputs, const SmoothDiscSettings& disc) { inputs.push_back({disc.radius, disc.softness, disc.gain, 0}); }

Point moonPoint(Draws& draw) {
  const MoonSettings moon = someMoon(draw);
  const Vec3 view = near(moon.direction, radiusOf(moon), draw);
  Point point{{texel(view)}, texel(moonColor(view, moon))};
  add(point.inputs, moon);
  return point;
}

// A picture whose colours are (u, v, 1/2): between its pixels that is what bilinear reading gives.
Point picturePoint(Draws& draw) {
  static const auto picture = [] {
    constexpr int kSide = 16;
    Image image = blankImage(kSide, kSide);
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) image.at(x, y) = {1 - (float(y) + 0.5F) / kSide, (float(x) + 0.5F) / kSide, 0.5F};
    return std::make_shared<const Image>(image);
  }();
  for (;;) {
    MoonSettings moon = someMoon(draw);
    moon.picture = picture;
    const Vec3 view = near(moon.direction, 0.5F * radiusOf(moon), draw);
    const auto uv = moonUv(view, moon);
    constexpr float kRim = 0.5F / 16;  // where the outermost pixels go on
    if (!uv || std::min({uv->x, uv->y, 1 - uv->x, 1 - uv->y}) < kRim) continue;
    Point point{{texel(view)}, texel(moonColor(view, moon))};
    add(point.inputs, moon);
    return point;
  }
}

// Most of them are near a star.
Point starPoint(Draws& draw) {
  for (;;) {
    const StarSettings stars = someStars(draw);
    const float sun_height = draw.between(-0.4F, 0);
    Vec3 view = draw.direction();
    if (draw.between(0, 1) < 0.9F) view.y = std::abs(view.y);
    const Vec3 light = starLight(view, sun_height, stars);
    if (length(light) < 0.01F && draw.between(0, 1) < 0.99F) continue;
    if (!isSteady(view, [&](Vec3 at) { return starLight(at, sun_height, stars); })) continue;
    Point point{{texel(view, sun_height)}, texel(light)};
    add(point.inputs, stars);
    return point;
  }
}

Point auroraPoint(Draws& draw) {
  for (;;) {
    const AuroraSettings aurora = someAurora(draw);
    const float sun_height = draw.between(-0.4F, 0);
    const Vec3 view = draw.direction(), light = auroraLight(view, sun_height, aurora);
    if (length(light) < 0.05F && draw.between(0, 1) < 0.95F) continue;  // most of them are in a curtain
    Point point{{texel(view, sun_height)}, texel(light)};
    add(point.inputs, aurora);
    return point;
  }
}

Point smoothDiscPoint(Draws& draw) {
  const Vec3 to_sun = draw.direction(), color = draw.color(), view = near(to_sun, draw.between(0, 1) < 0.5F ? 0.1F : 2, draw);
  const SmoothDiscSettings disc = someSmoothDisc(draw);
  Point point{{texel(view), texel(to_sun), texel(color)}, texel(smoothDiscColor(view, to_sun, color, disc))};
  add(point.inputs, disc);
  return point;
}

// A sky with any of its parts, seen about one of them.
Point skyPoint(Draws& draw) {
  const auto coin = [&draw] { return draw.between(0, 1) < 0.5F; };
  for (;;) {
    SkySettings sky;
    SkyColors& colors = sky.colors;
    sky.to_sun = draw.direction();
    colors.zenith = draw.color(), colors.horizon = draw.color(), colors.ground = draw.color(), colors.sun_color = draw.color();
    colors.low_sky = {colors.sun_color.z, colors.sun_color.x, colors.sun_color.y};
    sky.disc = {draw.between(50, 4000), draw.between(1, 250)};
    sky.glow = draw.between(0, 0.5F);
    sky.horizon_exponent = draw.between(4, 20);
    sky.viewer_height = coin() ? 0 : draw.between(0, 0.1F);
    sky.horizon_color = draw.color(), sky.horizon_strength = draw.between(0, 1);
    const MoonSettings moon = someMoon(draw);
    const StarSettings stars = someStars(draw);
    sky.smooth_disc = someSmoothDisc(draw);
    const bool is_smooth = coin();
    if (is_smooth) sky.sun_disc = DiscKind::kSmooth;
    const bool is_smooth_moon = coin();
    if (coin()) sky.moon = moon;
    if (sky.moon && is_smooth_moon) sky.moon->disc_kind = DiscKind::kSmooth;
    if (coin()) sky.stars = stars;
    const AuroraSettings aurora = someAurora(draw);
    const bool has_aurora = coin();
    if (has_aurora) sky.aurora = aurora;
    const Vec3 any = draw.direction(), view = sky.moon && coin() ? near(moon.direction, radiusOf(moon), draw)
                                              : coin()           ? near(sky.to_sun, 0.2F, draw)
                                                                 : any;
    if (!isSteady(view, [&](Vec3 at) { return sky.stars ? starLight(at, sky.to_sun.y, stars) : Vec3{}; })) continue;
    Point point{{texel(view, sky.horizon_exponent),
                 texel(sky.to_sun, sky.viewer_height),
                 texel(colors.zenith, is_smooth),
                 texel(colors.horizon, sky.moon.has_value()),
                 texel(colors.ground, sky.stars.has_value()),
                 texel(colors.sun_color, is_smooth_moon),
                 {sky.disc.exponent, is_smooth ? 0 : sky.disc.gain, is_smooth ? 0 : sky.glow, float(has_aurora)},
                 texel(*sky.horizon_color, sky.horizon_strength)},
                texel(skyColor(view, sky))};
    add(point.inputs, moon);
    add(point.inputs, stars);
    add(point.inputs, sky.smooth_disc);
    add(point.inputs, aurora);
    return point;
  }
}

std::string cratersText() {
  std::string text;
  for (const MoonCrater& crater : moonCraters())
    text += (text.empty() ? "" : ", ") + ("vec4(" + glslOf(crater.center) + ", " + glslOf(crater.radius) + ")");
  return "vec4[CRATERS](" + text + ")";
}

}  // namespace

// Bounds: directions, and the cosine of the moon's radius r, are rounded by 6·10⁻⁸, which changes
//   the moon         by 6·10⁻⁸/r² of its radius, r ≥ 0.014, times the slopes of its noises and craters, which are 30 or so
//   a star           by 6·10⁻⁸ over its width, 2·10⁻³ at least, times the slope of exp(−x²)
//   the smooth disc  by 6·10⁻⁸ over softness·10⁻⁴, relatively
std::vector<Function> nightFunctions() {
  const std::string prelude = "const vec4 craters[CRATERS] = " + cratersText() + R"(;
Moon moonOf(vec4 a, vec4 b, vec4 c, vec4 d) {
  Moon moon;
  moon.direction = a.xyz, moon.up = b.xyz, moon.disc_exponent = b.w, moon.disc_gain = c.w, moon.color = c.xyz, moon.phase = a.w;
  moon.smooth_radius = d.x, moon.smooth_softness = d.y, moon.smooth_gain = d.z;
  return moon;
}
Stars starsOf(vec4 a, vec4 b, vec4 c) {
  Stars stars;
  stars.count = int(a.x), stars.brightness = a.y, stars.size = a.z, stars.tint = a.w, stars.low_height = b.x, stars.high_height = b.y;
  stars.seed = uint(b.z), stars.pole = c.xyz, stars.turn = b.w, stars.day_turn = c.w;
  return stars;
}
Aurora auroraOf(vec4 a, vec4 b, vec4 c, vec4 d) {
  Aurora aurora;
  aurora.low_color = a.xyz, aurora.high_color = b.xyz, aurora.bottom = a.w, aurora.top = b.w, aurora.strength = c.x, aurora.speed = c.y;
  aurora.scale = c.z, aurora.ray_scale = c.w, aurora.low_height = d.x, aurora.high_height = d.y, aurora.seed = uint(d.z);
  aurora.time = d.w;
  return aurora;
}
vec3 moonPicture(vec2 uv) { return vec3(uv, 0.5); }
vec4 skyOf(vec4 view, vec4 to_sun, vec4 zenith, vec4 horizon, vec4 ground, vec4 sun_color, vec4 disc, vec4 line, Moon moon, Stars stars,
           vec4 s, Aurora aurora) {
  Sky sky = Sky(to_sun.xyz, zenith.xyz, sun_color.zxy, horizon.xyz, ground.xyz, sun_color.xyz, disc.xyz, view.w, to_sun.w, line);
  Night night = Night(zenith.w > 0.5, horizon.w > 0.5, sun_color.w > 0.5, false, ground.w > 0.5, disc.w > 0.5,
    SmoothDisc(s.x, s.y, s.z), moon, stars, aurora);
  return vec4(nightSkyColor(view.xyz, sky, night, craters), 0.0);
})";
  const auto moon = [](const std::string& up, const std::string& has_picture) {
    return "vec4(moonColor(p[0].xyz, moonOf(p[1], " + up + ", p[3], p[4]), " + has_picture + ", craters), 0.0)";
  };
  const auto stars = [](const std::string& more) {
    return "vec4(starLight(p[0].xyz, p[0].w, starsOf(p[1], p[2]" + more + ", p[3])), 0.0)";
  };
  const auto aurora = [](const std::string& last) {
    return "vec4(auroraLight(p[0].xyz, p[0].w, auroraOf(p[1], p[2], p[3], " + last + ")), 0.0)";
  };
  const auto disc = [](const std::string& gain) {
    return "vec4(smoothDiscColor(p[0].xyz, p[1].xyz, p[2].xyz, SmoothDisc(p[3].x, p[3].y, " + gain + ")), 0.0)";
  };
  const auto sky = [](const std::string& colors) {
    return "skyOf(p[0], p[1], " + colors +
           ", p[4], p[5], p[6], p[7], moonOf(p[8], p[9], p[10], p[11]), "
           "starsOf(p[12], p[13], p[14]), p[15], auroraOf(p[16], p[17], p[18], p[19]))";
  };
  std::vector<Function> all{
      {"night", "moonColor", moon("p[2]", "false"), moon("vec4(-p[2].xyz, p[2].w)", "false"), 1e-2, 0, moonPoint},
      {"night", "moonColor with a picture", moon("p[2]", "true"), moon("vec4(-p[2].xyz, p[2].w)", "true"), 1e-2, 0, picturePoint},
      {"night", "auroraLight", aurora("p[4]"), aurora("p[4] + vec4(0.0, 0.0, 1.0, 0.0)"), 2e-3, 2e-3, auroraPoint},
      {"night", "starLight", stars(""), stars(" + vec4(0.0, 0.0, 1.0, 0.0)"), 1e-4, 1e-3, starPoint},
      {"night", "smoothDiscColor", disc("p[3].z"), disc("1.01 * p[3].z"), 1e-6, 2e-3, smoothDiscPoint},
      {"night", "nightSkyColor", sky("p[2], p[3]"), sky("vec4(p[3].xyz, p[2].w), vec4(p[2].xyz, p[3].w)"), 1e-2, 2e-3, skyPoint}};
  for (Function& f : all) f.uses = {"noise", "shading", "sky"}, f.prelude = prelude, f.points = kManyPoints;
  return all;
}

// The logarithm in pow is rounded, and an exponent of 100 multiplies its error.
std::vector<Function> gradeFunctions() {
  const auto vignette = [](Draws& draw) {
    const float u = draw.between(0, 1), v = draw.between(0, 1);
    const VignetteSettings settings{draw.between(0, 1), magnitude(draw, 1e-3F, 100)};
    const float factor = vignetteFactor(u, v, settings);
    return Point{{{u, v, settings.corner, settings.exponent}}, {factor, factor, factor, factor}};
  };
  const auto contrast = [](Draws& draw) {
    const Vec3 color = draw.color() - Vec3{0.2F, 0.2F, 0.2F}, lift = draw.color() - Vec3{0.5F, 0.5F, 0.5F};
    const float amount = draw.between(0, 1);
    return Point{{texel(color, amount), texel(lift)}, texel(contrastColor(color, {amount, lift}))};
  };
  std::vector<Function> all{{"grade", "vignetteFactor", "vec4(vignetteFactor(p[0].xy, Vignette(p[0].z, p[0].w)))",
                             "vec4(vignetteFactor(p[0].xy, Vignette(0.98 * p[0].z, 1.05 * p[0].w)))", 1e-5, 0, vignette},
                            {"grade", "contrastColor", "vec4(contrastColor(p[0].xyz, Contrast(p[0].w, p[1].xyz)), 0.0)",
                             "vec4(contrastColor(p[0].xyz, Contrast(1.02 * p[0].w, p[1].xyz)), 0.0)", 1e-6, 0, contrast}};
  for (Function& f : all) f.points = kManyPoints;
  return all;
}

}  // namespace cloudbake
