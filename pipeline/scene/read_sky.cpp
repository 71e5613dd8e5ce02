#include <fmt/format.h>

#include <cmath>

#include "core/error.h"
#include "core/portable_math.h"
#include "core/text/toml.h"
#include "io/image/image.h"
#include "pipeline/scene/read_keys.h"
#include "pipeline/scene/scene_parts.h"
#include "preview/mesh_clouds/render.h"

namespace cloudbake {

namespace {

// A sky that has its own horizon begins there, if the table does not say otherwise.
void readSkyColors(TomlReader& table, SkyColors& colors) {
  readKeys(table, colorKeys(), colors);
  if (table.has("horizon") && !table.has("low_sky")) colors.low_sky = colors.horizon;
}

// The colours of hours, with those of the default sky where an hour does not say.
SkyRamp readRamp(TomlReader& table) {
  SkyRamp ramp{{}, false, false, false};
  for (TomlReader& hour : table.tables("hours")) {
    double elevation = 0;
    if (!hour.has("elevation")) hour.refuseAt("elevation", "[[sky.hours]] has no elevation: give that of the sun, in degrees");
    hour.read("elevation", -90, 90, elevation);
    const auto height = float(sinCosDegrees(elevation).sin);
    if (!ramp.hours.empty() && !(height > ramp.hours.back().sun_height))
      hour.refuseAt("elevation", "[[sky.hours]]: the elevations do not rise: put the hours of a lower sun first");
    SkyHour& colors = ramp.hours.emplace_back(SkyHour{height, skyColorsForSun(height)});
    readSkyColors(hour, colors.colors);
    ramp.own_ground |= hour.has("ground");
    ramp.own_ambient_sky |= hour.has("ambient_sky");
    ramp.own_ambient_ground |= hour.has("ambient_ground");
    hour.finish();
  }
  return ramp.hours.empty() ? defaultSkyRamp() : ramp;
}

// The hours of a strip of colours.
SkyRamp readStrip(TomlReader& table, const std::filesystem::path& folder, const FileReader* read_file, SceneFile& scene) {
  SkyStrip& strip = scene.sky_strip;
  readKeys(table, skyStripKeys(), strip);
  std::string name;
  table.read("ramp", name);
  if (name.empty()) return defaultSkyRamp();
  if (table.has("hours")) table.refuseAt("ramp", "[sky] has a ramp and [[sky.hours]]: give one of the two");
  if (!(strip.low_degrees < strip.high_degrees))
    table.refuseAt(table.has("ramp_low") ? "ramp_low" : "ramp_high", "[sky]: ramp_low is not below ramp_high");
  if (!read_file) return defaultSkyRamp();
  const Image picture = [&] {
    const std::filesystem::path file = folder / name;
    try {
      return linearOfSrgb(decodePng((*read_file)(file), file.string(), scene.view.memory_limit));
    } catch (const Error& error) {
      table.refuseAt("ramp", fmt::format("[sky]: the picture of the ramp cannot be read: {}", error.what()));
    }
  }();
  if (picture.width < strip.columns)
    table.refuseAt("ramp", fmt::format("[sky]: {} has {} pixels in a row, and the ramp {} columns: paint a wider picture, or set a smaller "
                                       "ramp_columns",
                                       name, picture.width, strip.columns));
  return rampOfStrip(picture, strip);
}

// With `by_sky`, ground and ambient light that neither the table nor an hour of the scene gives follow from the scene's other colours.
void readColors(TomlReader table, SkySettings& sky, bool by_sky, bool has_hours) {
  SkyColors& colors = sky.colors;
  readSkyColors(table, colors);
  const bool is_own_sky = table.has("zenith") || table.has("low_sky") || table.has("horizon") || table.has("sun");
  table.finish();
  if (!by_sky || !is_own_sky) return;
  const SkyColors lit = withAmbientOfSky(colors, sky.to_sun.y);
  const auto follow = [&](const char* key, Vec3 SkyColors::*color, bool is_own) {
    if (!table.has(key) && !(has_hours && is_own)) colors.*color = lit.*color;
  };
  follow("ground", &SkyColors::ground, sky.ramp.own_ground);
  follow("ambient_sky", &SkyColors::ambient_sky, sky.ramp.own_ambient_sky);
  follow("ambient_ground", &SkyColors::ambient_ground, sky.ramp.own_ambient_ground);
}

// A direction that the table has; unset if it has none.
std::optional<Vec3> readDirection(TomlReader& table, const char* name, const char* key) {
  Vec3 given;
  table.read(key, -kFar, kFar, given);
  if (!table.has(key)) return std::nullopt;
  const auto direction = normalized(given);
  if (!direction) table.refuseAt(key, fmt::format("{}: '{}' has no length: give a direction such as [0, 1, 0]", name, key));
  return direction;
}

// A moon on the sun's circle, whose lit side faces the sun.
void placeByHour(MoonSettings& moon, const SunCircle& circle, double sun_degrees) {
  moon.direction = circle.directionAt(moonDegrees(sun_degrees, moon.phase_degrees));
  const Vec3 sun = circle.directionAt(sun_degrees), across = sun - moon.direction * dot(sun, moon.direction);
  const Vec3 lit_side = normalized(moon.phase_degrees < 0 ? -across : across).value_or(cross(moon.direction, circle.axis()));
  moon.up = cross(lit_side, moon.direction);
}

std::optional<MoonSettings> readMoon(TomlReader table, bool is_there, const std::filesystem::path& folder, SceneFile& scene) {
  MoonSettings moon;
  readKeys(table, moonKeys(), moon);
  readKeys(table, moonDiscKeys(), moon.disc);
  readKeys(table, smoothDiscKeys(), moon.smooth_disc);
  table.read("disc", {{"simple", DiscKind::kSimple}, {"smooth", DiscKind::kSmooth}}, moon.disc_kind);
  std::string picture;
  table.read("picture", picture);
  if (!picture.empty()) scene.moon_picture = folder / picture;
  if (!picture.empty() && moon.disc_kind == DiscKind::kSmooth)
    table.refuseAt("picture", "[sky.moon] has a picture and a smooth disc, which shows none: leave out one of the two");
  const std::optional<Vec3> up = readDirection(table, "[sky.moon]", "up");
  float azimuth = 180, elevation = 45;
  const bool is_placed = table.has("azimuth") || table.has("elevation");
  table.read("azimuth", -3600.0, 3600.0, azimuth);
  table.read("elevation", -90.0, 90.0, elevation);
  table.finish();
  if (scene.day && !is_placed) {
    placeByHour(moon, SunCircle(scene.day->noon), scene.day->degreesAt(scene.view.time_seconds));
  } else {
    moon.direction = directionFromAngles(azimuth, elevation);
    if (std::abs(moon.direction.y) > 0.999F) moon.up = {0, 0, 1};
    if (up && length(cross(*up, moon.direction)) < 1e-3F)
      table.refuseAt("up", "[sky.moon]: 'up' is the direction to the moon, along which no top is seen: give another one");
  }
  if (up) moon.up = *up;
  return is_there ? std::optional(moon) : std::nullopt;
}

std::optional<StarSettings> readStars(TomlReader table, bool is_there, const SceneFile& scene) {
  StarSettings stars;
  readKeys(table, starKeys(), stars);
  if (!(stars.low_height < stars.high_height))
    table.refuseAt(table.has("low_height") ? "low_height" : "high_height", "[sky.stars]: low_height is not below high_height");
  const std::optional<Vec3> pole = readDirection(table, "[sky.stars]", "pole");
  table.finish();
  if (scene.day) {
    stars.pole = SunCircle(scene.day->noon).axis();
    stars.day_turn_degrees = float(scene.day->degreesAt(scene.view.time_seconds));
  }
  if (pole) stars.pole = *pole;
  return is_there ? std::optional(stars) : std::nullopt;
}

std::optional<AuroraSettings> readAurora(TomlReader table, bool is_there, const SceneFile& scene) {
  AuroraSettings aurora;
  readKeys(table, auroraKeys(), aurora);
  const auto demandOrder = [&](bool is_in_order, const char* first, const char* second) {
    if (!is_in_order) table.refuseAt(table.has(first) ? first : second, fmt::format("[sky.aurora]: {} is not below {}", first, second));
  };
  demandOrder(aurora.bottom_degrees < aurora.top_degrees, "bottom", "top");
  demandOrder(aurora.low_height < aurora.high_height, "low_height", "high_height");
  table.finish();
  aurora.time_seconds = float(scene.view.time_seconds + scene.view.time_offset_seconds);
  return is_there ? std::optional(aurora) : std::nullopt;
}

enum class SunChoice { kSimple, kSmooth, kNone };

}  // namespace

void readSky(TomlReader table, const std::filesystem::path& folder, const FileReader* read_file, SceneFile& scene) {
  SkySettings& sky = scene.light.sky;
  bool as_published = false;
  table.read("as_published", as_published);
  if (as_published) sky.disc = publishedSky().disc;
  const bool has_hours = table.has("hours") || table.has("ramp");
  const SkyRamp of_hours = readRamp(table), of_strip = readStrip(table, folder, read_file, scene);
  sky.ramp = table.has("ramp") ? of_strip : of_hours;
  sky.colors = skyColorsFor(scene.post, sky.to_sun.y, sky.ramp);
  readColors(table.table("colors"), sky, !scene.post.published, has_hours);
  const bool has_moon = table.has("moon"), has_stars = table.has("stars"), has_aurora = table.has("aurora");
  sky.moon = readMoon(table.table("moon"), has_moon, folder, scene);
  sky.stars = readStars(table.table("stars"), has_stars, scene);
  sky.aurora = readAurora(table.table("aurora"), has_aurora, scene);
  SunChoice disc = SunChoice::kSimple;
  table.read("disc", {{"simple", SunChoice::kSimple}, {"smooth", SunChoice::kSmooth}, {"none", SunChoice::kNone}}, disc);
  readKeys(table, sunDiscKeys(), sky.disc);
  readKeys(table, smoothDiscKeys(), sky.smooth_disc);
  readKeys(table, skyKeys(), sky);
  table.finish();
  if (disc == SunChoice::kSmooth) sky.sun_disc = DiscKind::kSmooth;
  if (disc == SunChoice::kNone) sky.disc.gain = 0;
}

}  // namespace cloudbake
