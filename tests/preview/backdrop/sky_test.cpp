// The sky: finite and defined everywhere, brightest in the sun.
#include "preview/backdrop/sky.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>

#include "preview/camera.h"
#include "preview/mesh_clouds/render.h"
#include "preview/shading_math.h"

namespace cloudbake {
namespace {

float brightness(Vec3 color) { return 0.2126F * color.x + 0.7152F * color.y + 0.0722F * color.z; }

SkySettings skyForSun(float azimuth, float elevation) {
  SkySettings sky;
  sky.to_sun = directionFromAngles(azimuth, elevation);
  sky.colors = skyColorsForSun(sky.to_sun.y);
  return sky;
}

TEST(Sky, IsFiniteAndNotNegativeEverywhere) {
  for (const float sun : {-90.0F, -12.0F, 0.0F, 5.0F, 40.0F, 90.0F}) {
    const SkySettings sky = skyForSun(30, sun);
    for (float azimuth = 0; azimuth < 360; azimuth += 15)
      for (float elevation = -90; elevation <= 90; elevation += 5) {
        const Vec3 color = skyColor(directionFromAngles(azimuth, elevation), sky);
        ASSERT_TRUE(isFinite(color));
        ASSERT_GE(std::min({color.x, color.y, color.z}), 0);
      }
  }
}

TEST(Sky, SunIsBrighterThanElsewhereAndThereIsOnlyOne) {
  const SkySettings sky = skyForSun(30, 40);
  const float sun = brightness(skyColor(sky.to_sun, sky));
  int outside = 0;
  for (float azimuth = 0; azimuth < 360; azimuth += 5)
    for (float elevation = -90; elevation <= 90; elevation += 5) {
      const Vec3 view = directionFromAngles(azimuth, elevation);
      if (angleDegrees(view, sky.to_sun) < 4) continue;
      EXPECT_LT(brightness(skyColor(view, sky)) * 2, sun);
      ++outside;
    }
  EXPECT_GT(outside, 2000);
}

// The rim of the disc: saturate(cos(x)^a·b) falls under 1 where cos(x)^a = 1/b.
TEST(Sky, DiscHasTheRadiusThatItsConstantsGive) {
  SkySettings sky = skyForSun(0, 40);
  const double radius = std::acos(std::pow(1.0 / sky.disc.gain, 1.0 / sky.disc.exponent)) * 180 / kPi;
  EXPECT_NEAR(radius, 3, 0.1);
  const auto at = [&](double degrees) { return brightness(skyColor(directionFromAngles(0, 40 + float(degrees)), sky)); };
  const float inside = at(0.9 * radius);
  EXPECT_NEAR(inside, at(0), 0.03 * at(0));
  EXPECT_LT(at(2 * radius), 0.3 * inside);
}

TEST(Sky, PublishedDiscIsTheFormula) {
  EXPECT_EQ(kPublishedDisc.exponent, 1000);
  EXPECT_EQ(kPublishedDisc.gain, 250);
  const Vec3 sun = directionFromAngles(0, 40);
  for (const double degrees : {0.0, 3.0, 5.9, 6.2, 7.0, 9.0, 90.0, 179.0}) {
    const double expected = std::min(1.0, std::pow(std::max(0.0, std::cos(degrees * kPi / 180)), 1000) * 250);
    EXPECT_NEAR(discMask(directionFromAngles(0, 40 + float(degrees)), sun, kPublishedDisc), expected, 2e-3) << degrees;
  }
}

TEST(Sky, SmoothDiscIsAPlateauThatFallsOffEverywhere) {
  const SmoothDiscSettings settings;
  EXPECT_EQ(settings.softness, 2);
  EXPECT_EQ(settings.gain, 0.06F);
  const Vec3 sun = directionFromAngles(0, 0), color{1, 0.5F, 2};
  float last = INFINITY;
  for (const double degrees : {0.0, 2.9, 3.2, 4.0, 10.0, 60.0, 180.0}) {
    // (1 − cos)/2 is sin² of half the angle.
    const double half_sine = std::sin(degrees * kPi / 360);
    const double r = std::sqrt(std::max(half_sine * half_sine - 0.05 * 0.01, 2e-4));
    const Vec3 found = smoothDiscColor(directionFromAngles(0, float(degrees)), sun, color, settings);
    EXPECT_NEAR(found.x, std::pow(0.06 / r, 2), 1e-3 * std::pow(0.06 / r, 2)) << degrees;
    EXPECT_NEAR(found.y / found.x, 0.25, 1e-5);
    EXPECT_NEAR(found.z / found.x, 4, 1e-5);
    EXPECT_LE(found.x, last);
    last = found.x;
  }
  SkySettings sky = skyForSun(30, 40);
  const float simple = brightness(skyColor(directionFromAngles(30, 60), sky));
  sky.sun_disc = DiscKind::kSmooth;
  sky.glow = 100;  // of the simple disc alone
  EXPECT_NEAR(brightness(skyColor(directionFromAngles(30, 60), sky)), simple, 0.1F);
  EXPECT_GT(brightness(skyColor(sky.to_sun, sky)), 5);
}

MoonSettings someMoon() {
  MoonSettings moon;
  moon.direction = directionFromAngles(50, 35);
  return moon;
}

// Its picture: centre at the moon, u along up, v along direction × up, the rim of the disc on the circle of radius 1/2.
TEST(Sky, MoonHasItsPictureOnce) {
  const MoonSettings moon = someMoon();
  const auto center = moonUv(moon.direction, moon);
  ASSERT_TRUE(center);
  EXPECT_NEAR(center->x, 0.5, 1e-4);
  EXPECT_NEAR(center->y, 0.5, 1e-4);
  EXPECT_FALSE(moonUv(-moon.direction, moon));

  const Vec3 y = *normalized(cross(moon.direction, moon.up)), x = cross(y, moon.direction);
  EXPECT_GT(x.y, 0.5F);  // up
  const double radius = std::acos(std::pow(0.5 / double(moon.disc.gain), 1.0 / double(moon.disc.exponent)));
  const auto tilted = [&](Vec3 axis, double angle) { return moon.direction * float(std::cos(angle)) + axis * float(std::sin(angle)); };
  EXPECT_NEAR(moonUv(tilted(x, radius), moon)->x, 1, 1e-3);
  EXPECT_NEAR(moonUv(tilted(x, radius), moon)->y, 0.5, 1e-3);
  EXPECT_NEAR(moonUv(tilted(y, radius), moon)->y, 1, 1e-3);
  EXPECT_NEAR(moonUv(tilted(y, -radius / 2), moon)->y, 0.25, 1e-3);
  EXPECT_NEAR(discMask(tilted(y, radius), moon.direction, moon.disc), 0.5, 0.01);

  // In the sky: where the moon stands, and nowhere else; not on the other side, where the formula repeats.
  SkySettings sky = skyForSun(200, -30);
  const SkySettings empty = sky;
  sky.moon = moon;
  EXPECT_GT(brightness(skyColor(moon.direction, sky)), 10 * brightness(skyColor(moon.direction, empty)));
  int elsewhere = 0;
  for (float azimuth = 0; azimuth < 360; azimuth += 5)
    for (float elevation = -90; elevation <= 90; elevation += 5) {
      const Vec3 view = directionFromAngles(azimuth, elevation);
      if (angleDegrees(view, moon.direction) < 4.5) continue;
      EXPECT_EQ(skyColor(view, sky), skyColor(view, empty));
      ++elsewhere;
    }
  EXPECT_GT(elsewhere, 2000);
  // Below the horizon it has set.
  sky.moon->direction = directionFromAngles(50, -20);
  EXPECT_EQ(skyColor(sky.moon->direction, sky), skyColor(sky.moon->direction, empty));
}

TEST(Sky, MoonWanesWithItsPhaseAndHasAFace) {
  const auto mean = [](float phase, float from, float to) {
    double sum = 0;
    int count = 0;
    for (float u = 0.01F; u < 1; u += 0.02F)
      for (float v = from; v < to; v += 0.02F) {
        if ((u - 0.5F) * (u - 0.5F) + (v - 0.5F) * (v - 0.5F) > 0.24F) continue;
        const float brightness = moonBrightness({u, v}, phase);
        EXPECT_TRUE(brightness >= 0 && brightness <= 1);
        sum += brightness;
        ++count;
      }
    return sum / count;
  };
  const double full = mean(0, 0.01F, 1);
  EXPECT_GT(full, 0.4);
  EXPECT_NEAR(mean(180, 0.01F, 1), 0, 1e-6);
  // A half moon is lit on one side.
  EXPECT_GT(mean(90, 0.5F, 1), 0.3);
  EXPECT_LT(mean(90, 0.01F, 0.48F), 0.01);
  EXPECT_GT(mean(-90, 0.01F, 0.5F), 0.3);
  // Plains and craters: bright and dark ground.
  float brightest = 0, darkest = 1;
  for (float u = 0.25F; u < 0.75F; u += 0.01F)
    for (float v = 0.25F; v < 0.75F; v += 0.01F) {
      brightest = std::max(brightest, moonBrightness({u, v}, 0));
      darkest = std::min(darkest, moonBrightness({u, v}, 0));
    }
  EXPECT_GT(brightest, 1.6F * darkest);
}

TEST(Sky, HorizonIsALineAndGroundLiesBelow) {
  const SkySettings sky = skyForSun(180, 60);
  EXPECT_LT(length(skyColor({0, 0, 1}, sky) - sky.colors.horizon), 1e-6F);
  EXPECT_EQ(skyColor({0, -1, 0}, sky), sky.colors.ground);
  EXPECT_LT(skyColor({0, 1, 0}, sky).x, sky.colors.horizon.x);
  // Continuous across the line.
  const Vec3 above = skyColor(directionFromAngles(0, 0.001F), sky), below = skyColor(directionFromAngles(0, -0.001F), sky);
  EXPECT_LT(length(above - below), 0.01F);
}

TEST(Sky, HorizonSinksForAViewerHighAbove) {
  SkySettings sky = skyForSun(180, 60);
  sky.viewer_height = 1;  // one radius up: the horizon is 60 degrees below level
  EXPECT_LT(length(skyColor(directionFromAngles(0, -60), sky) - sky.colors.horizon), 0.02F);
  EXPECT_EQ(skyColor({0, -1, 0}, sky).x < sky.colors.horizon.x, true);
}

// h = saturate(1 − |y|)^e, and from the height h above a planet of radius R it lies where the cosine is R/(R + h).
TEST(Sky, HorizonLineIsTheFormulaAtAnyHeight) {
  for (const float exponent : {4.0F, 8.0F, 50.0F})
    for (const float y : {-1.0F, -0.3F, 0.0F, 0.1F, 0.7F, 1.0F})
      EXPECT_NEAR(horizonLine(y, exponent, 0), std::pow(1 - std::abs(double(y)), double(exponent)), 1e-5);
  for (const double height : {0.0, 0.0016, 0.01, 0.3, 3.0}) {
    const double dip = std::acos(1 / (1 + height));  // R/(R + h) with R = 1
    EXPECT_NEAR(horizonLine(float(-std::sin(dip)), 50, float(height)), 1, 0.01) << height;
    EXPECT_LT(horizonLine(float(-std::sin(dip)) + 0.02F, 50, float(height)), 0.4F);
    EXPECT_LT(horizonLine(float(-std::sin(dip)) - 0.02F, 50, float(height)), 0.4F);
    // The gradient has its horizon there too, the ground below and the sky above.
    SkySettings sky = skyForSun(180, 60);
    sky.viewer_height = float(height);
    sky.horizon_exponent = 50;
    const auto at = [&](double degrees) { return skyColor(directionFromAngles(0, float(-dip * 180 / kPi + degrees)), sky); };
    EXPECT_LT(length(at(0.02) - sky.colors.horizon), 0.02F * length(sky.colors.horizon));
    EXPECT_LT(length(at(-0.02) - sky.colors.horizon), 0.02F * length(sky.colors.horizon));
    EXPECT_GT(length(at(-20) - sky.colors.horizon), 0.1F);
    EXPECT_GT(length(at(20) - sky.colors.horizon), 0.1F);
  }
}

// From high above, the sky between the horizon and level is the sky that lies as far above the horizon for others.
// Far from the sun and without its glow: from the low sky's colour to the zenith's by the root of the height, under the bright line.
TEST(Sky, GradientIsTheRootOfTheHeight) {
  SkySettings settings;
  settings.to_sun = {1, 0, 0};
  settings.glow = 0;
  settings.colors.horizon = {0.8F, 0.6F, 0.4F}, settings.colors.zenith = {0.1F, 0.2F, 0.7F};
  settings.colors.low_sky = {0.3F, 0.5F, 0.9F};
  for (const float height : {0.0F, 0.09F, 0.36F, 0.81F, 1.0F}) {
    const float line = std::pow(1 - height, settings.horizon_exponent);
    const Vec3 blue = settings.colors.low_sky + (settings.colors.zenith - settings.colors.low_sky) * std::sqrt(height);
    const Vec3 expected = blue + (settings.colors.horizon - blue) * line;
    EXPECT_LT(length(skyColor({-std::sqrt(1 - height * height), height, 0}, settings) - expected), 1e-5F) << height;
  }
}

TEST(Sky, GradientCountsFromTheSunkenHorizon) {
  SkySettings low = skyForSun(180, 60);
  low.disc.gain = low.glow = 0;
  SkySettings high = low;
  high.viewer_height = 1;
  const float dip = std::sqrt(0.75F);
  for (const float y : {-0.8F, -0.5F, -0.1F, 0.1F}) {
    const float above = y + dip;
    const Vec3 seen = skyColor({0, y, std::sqrt(1 - y * y)}, high), expected = skyColor({0, above, std::sqrt(1 - above * above)}, low);
    EXPECT_LT(length(seen - expected), 1e-5F) << y;
  }
}

TEST(Sky, PictureIsTheMeanOfItsSamplesForAnyNumberOfThreads) {
  SkySettings sky = skyForSun(0, 20);
  sky.moon = someMoon();
  const Camera camera{{0, 0, 0}, directionFromAngles(10, 20), 60, 37, 23};
  const Image one = renderSky(camera, sky, 1);
  EXPECT_EQ(one.at(11, 7), skyColor(cameraRay(camera, 11.5F, 7.5F).direction, sky));
  const auto render = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return renderSky(camera, sky, 3);
  };
  const Image several = render(1);
  Vec3 sum;
  for (const Vec2 place : pixelPlaces(3)) sum += skyColor(cameraRay(camera, 18 + place.x, 11 + place.y).direction, sky);
  EXPECT_LT(length(several.at(18, 11) - sum / 9), 1e-5F);
  for (const size_t threads : {2U, 7U})
    EXPECT_EQ(std::memcmp(several.pixels.data(), render(threads).pixels.data(), several.pixels.size() * sizeof(Vec3)), 0);
}

TEST(Sky, HoursAreMixedWithoutJumps) {
  Vec3 last = skyColorsForSun(-1).sun_color;
  for (float height = -1; height <= 1; height += 0.001F) {
    const Vec3 color = skyColorsForSun(height).sun_color;
    EXPECT_LT(length(color - last), 0.03F) << height;
    last = color;
  }
  EXPECT_GT(brightness(skyColorsForSun(1).sun_color), 5 * brightness(skyColorsForSun(-1).sun_color));
}

// Colours of a scene's own hours are met at these hours, and mixed between.
TEST(Sky, RampOfItsOwn) {
  SkyRamp ramp{{{-0.3F, skyColorsForSun(-1)}, {0.5F, skyColorsForSun(1)}}, false, false, false};
  ramp.hours[0].colors.zenith = {1, 0, 0};
  ramp.hours[1].colors.zenith = {0, 0, 3};
  EXPECT_EQ(skyColorsForSun(-0.9F, ramp).zenith, (Vec3{1, 0, 0}));
  EXPECT_EQ(skyColorsForSun(0.9F, ramp).zenith, (Vec3{0, 0, 3}));
  EXPECT_LT(length(skyColorsForSun(0.1F, ramp).zenith - Vec3{0.5F, 0, 1.5F}), 1e-6F);
  EXPECT_EQ(skyHours(ramp), (std::vector<float>{-0.3F, 0, 0.5F, 1}));
  ramp.hours.resize(1);
  EXPECT_EQ(skyColorsForSun(0.9F, ramp).zenith, (Vec3{1, 0, 0}));
}

// The line has its own colour at the horizon, as strong as asked for, and is gone a little above and below.
TEST(Sky, HorizonLineHasAColour) {
  SkySettings sky = skyForSun(0, 40);
  sky.glow = 0;
  const Vec3 without = skyColor({0, 0, -1}, sky);
  EXPECT_LT(length(without - sky.colors.horizon), 1e-6F);
  sky.horizon_color = Vec3{4, 0.5F, 0};
  EXPECT_LT(length(skyColor({0, 0, -1}, sky) - Vec3{4, 0.5F, 0}), 1e-5F);
  EXPECT_LT(length(skyColor(directionFromAngles(180, -0.01F), sky) - Vec3{4, 0.5F, 0}), 0.02F);
  sky.horizon_strength = 0.25F;
  EXPECT_LT(length(skyColor({0, 0, -1}, sky) - lerp(sky.colors.horizon, {4, 0.5F, 0}, 0.25F)), 1e-5F);
  SkySettings plain = sky;
  plain.horizon_color.reset();
  for (const float elevation : {40.0F, -40.0F})
    EXPECT_LT(length(skyColor(directionFromAngles(180, elevation), sky) - skyColor(directionFromAngles(180, elevation), plain)), 0.02F);
}

// --- The light that clouds receive ---

TEST(KeyLight, IsTheSunsByDay) {
  for (const float elevation : {90.0F, 60.0F, 6.0F}) {
    const SkySettings sky = skyForSun(30, elevation);
    EXPECT_EQ(keyLight(sky).direction, sky.to_sun);
    EXPECT_EQ(keyLight(sky).color, sky.colors.sun_color);
  }
  const SkySettings low = skyForSun(30, 4);  // dimmer, in the same direction and hue
  EXPECT_EQ(keyLight(low).direction, low.to_sun);
  EXPECT_LT(brightness(keyLight(low).color), brightness(low.colors.sun_color));
  EXPECT_NEAR(keyLight(low).color.x / keyLight(low).color.z, low.colors.sun_color.x / low.colors.sun_color.z, 1e-4F);
}

SkySettings skyWithMoon(float elevation) {
  SkySettings sky = skyForSun(30, elevation);
  sky.moon.emplace().direction = directionFromAngles(210, 40);
  sky.moon->light = {0.2F, 0.3F, 0.4F};
  return sky;
}

// How bright a light is on the screen, in steps of 8 bits.
float shownLight(const SkySettings& sky) {
  const float light = brightness(keyLight(sky).color);
  Image image = blankImage(1, 1);
  image.pixels.front() = {light, light, light};
  return 255 * toneMap(image).pixels.front().x;
}

// On a day on which the sun is 50 degrees high at noon, as at 40 degrees of latitude when day and night are equal.
float sunAtMinute(int minute) {
  return std::asin(std::sin(float(50 * kPi / 180)) * std::sin(float(minute - 6 * 60) / 4 * float(kPi / 180))) * float(180 / kPi);
}

// The light of sun and twilight rises with the sun, and no minute of the day changes what is seen by more than 2/255.
TEST(KeyLight, RisesAndFadesEvenly) {
  for (const bool has_moon : {false, true}) {
    const auto at = [&](int minute) {
      SkySettings sky = skyForSun(30, sunAtMinute(minute));
      if (has_moon) {  // full, opposite the sun
        sky.moon.emplace().direction = -sky.to_sun;
      }
      return sky;
    };
    for (int minute = 0; minute < 24 * 60; ++minute) {
      const float before = shownLight(at(minute)), after = shownLight(at(minute + 1));
      EXPECT_LE(std::abs(after - before), 2) << minute << " minutes after midnight";
      if (minute < 12 * 60 && sunAtMinute(minute) > kLastLight) {
        EXPECT_GE(after, before - 0.05F) << minute;
      }
      if (sunAtMinute(minute) < kMoonLight) {
        EXPECT_EQ(after > 30, has_moon) << "dim at night";
      }
      EXPECT_TRUE(!(sunAtMinute(minute) < kLastLight) || after < 60) << "dim at night";
    }
  }
}

// From a sun below the horizon that the viewer sees comes no light from below it, also for a viewer whose horizon has sunk.
TEST(KeyLight, NeverComesFromBelow) {
  for (const float viewer_height : {0.0F, 0.001F, 0.02F})
    for (float elevation = -90; elevation < 20; elevation += 0.25F) {
      SkySettings sky = skyForSun(30, elevation);
      sky.viewer_height = viewer_height;
      const float dip = std::acos(1 / (1 + viewer_height)) * float(180 / kPi);
      const KeyLight key = keyLight(sky);
      EXPECT_NEAR(length(key.direction), 1, 1e-5F);
      EXPECT_GT(std::asin(key.direction.y) * float(180 / kPi), 1.4F - dip);
      EXPECT_EQ(elevation + dip <= kLastLight, key.color == Vec3{}) << elevation;
      sky.moon.emplace().direction = directionFromAngles(210, -5 - dip);
      if (elevation + dip <= kLastLight) {
        EXPECT_EQ(keyLight(sky).color, Vec3{}) << "a moon that has set";
      }
    }
}

// By day the sun's, at night the moon's, nothing where they change, and no jump anywhere.
TEST(KeyLight, IsTheMoonsAtNight) {
  EXPECT_EQ(keyLight(skyWithMoon(30)).color, skyWithMoon(30).colors.sun_color);
  EXPECT_EQ(keyLight(skyWithMoon(30)).direction, skyWithMoon(30).to_sun);
  EXPECT_EQ(keyLight(skyWithMoon(-30)).direction, directionFromAngles(210, 40));
  EXPECT_LT(length(keyLight(skyWithMoon(-30)).color - Vec3{0.2F, 0.3F, 0.4F}), 1e-5F);
  EXPECT_EQ(lightColors(skyWithMoon(-30)).sun_color, keyLight(skyWithMoon(-30)).color);
  EXPECT_EQ(lightColors(skyWithMoon(-30)).ambient_sky, skyWithMoon(-30).colors.ambient_sky);
  KeyLight last = keyLight(skyWithMoon(20));
  int changes = 0;
  for (float elevation = 20; elevation > -25; elevation -= 0.02F) {
    const KeyLight now = keyLight(skyWithMoon(elevation));
    EXPECT_LT(length(now.color - last.color), 0.03F) << elevation;
    if (dot(now.direction, last.direction) < 0.99F) {
      EXPECT_LT(length(now.color) + length(last.color), 2e-3F) << "the light jumps from sun to moon";
      ++changes;
    }
    last = now;
  }
  EXPECT_EQ(changes, 1);
  // One that is brighter than nature's takes over earlier.
  EXPECT_EQ(keyLight(skyWithMoon(-16)).direction, directionFromAngles(210, 40));
  SkySettings natural = skyWithMoon(-16);
  natural.moon->light = MoonSettings().light;
  EXPECT_EQ(natural.to_sun.x > 0, keyLight(natural).direction.x > 0);
  EXPECT_LT(keyLight(natural).direction.y, 0.05F);
  // A half moon sends half as much, a new one none.
  SkySettings sky = skyWithMoon(-30);
  sky.moon->phase_degrees = 90;
  EXPECT_NEAR(keyLight(sky).color.x, 0.1F, 1e-5);
  sky.moon->phase_degrees = 180;
  EXPECT_NEAR(keyLight(sky).color.x, 0, 1e-6);
}

// Without a key light, what faces it is not darker than the rest.
TEST(KeyLight, LightsAtLeastAsTheGroundDoes) {
  const SkySettings night = skyForSun(30, -40);
  EXPECT_EQ(keyLight(night).color, Vec3{});
  EXPECT_EQ(lightColors(night).sun_color, night.colors.ambient_ground);
}

// A picture stands upright and not mirrored: its top along `up`, its right side on the right of who looks at it.
TEST(Moon, ShowsAPicture) {
  MoonSettings moon;
  moon.direction = directionFromAngles(180, 0);  // straight ahead, towards −Z
  moon.color = {1, 1, 1};
  Image picture = blankImage(16, 16);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x)
      picture.at(x, y) = y < 8 ? (x < 8 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}) : (x < 8 ? Vec3{0, 0, 1} : Vec3{1, 1, 0});
  moon.picture = std::make_shared<const Image>(picture);
  const Camera camera{{0, 0, 0}, {0, 0, -1}, 6, 60, 60};  // the disc's radius is half the picture's height
  const auto seen = [&](float x, float y) { return moonColor(cameraRay(camera, x, y).direction, moon); };
  EXPECT_LT(length(seen(16, 16) - Vec3{1, 0, 0}), 0.1F);
  EXPECT_LT(length(seen(44, 16) - Vec3{0, 1, 0}), 0.1F);
  EXPECT_LT(length(seen(16, 44) - Vec3{0, 0, 1}), 0.1F);
  EXPECT_LT(length(seen(44, 44) - Vec3{1, 1, 0}), 0.1F);
  EXPECT_LT(length(seen(1, 1)), 0.01F) << "outside the disc";
  moon.phase_degrees = 90;  // lit from the right
  EXPECT_LT(length(seen(16, 16)), 0.01F);
  EXPECT_LT(length(seen(44, 16) - Vec3{0, 1, 0}), 0.1F);
}

// A moon with a smooth disc is a plateau that falls off: (b·colour/r)², less by its phase.
TEST(Moon, MayHaveASmoothDisc) {
  SkySettings sky = skyForSun(0, -40);
  SkySettings empty = sky;
  MoonSettings& moon = sky.moon.emplace();
  moon.direction = directionFromAngles(180, 40);
  moon.color = {0.5F, 0.6F, 0.7F};
  moon.disc_kind = DiscKind::kSmooth;
  moon.smooth_disc = {0.1F, 4, 0.03F};
  const auto lightAt = [&](float elevation) {
    const Vec3 view = directionFromAngles(180, elevation);
    return skyColor(view, sky) - skyColor(view, empty);
  };
  const Vec3 plateau{0.25F * 9e-4F / 4e-4F, 0.36F * 9e-4F / 4e-4F, 0.49F * 9e-4F / 4e-4F};
  EXPECT_LT(length(lightAt(40) - plateau), 1e-4F);
  EXPECT_LT(length(lightAt(41) - plateau), 1e-4F);
  const double half = 10 * kPi / 180, square = std::sin(half) * std::sin(half) - 0.001;  // 20 degrees off
  EXPECT_NEAR(lightAt(60).x, 0.25 * 9e-4 / square, 1e-4);
  moon.phase_degrees = 90;
  EXPECT_LT(length(lightAt(40) - plateau * 0.5F), 1e-4F);
  moon.phase_degrees = 180;
  EXPECT_LT(length(lightAt(40)), 1e-6F);
  // It hides stars as much as it shines: all of them on its plateau, a share around it.
  EXPECT_EQ(smoothDiscShare(moon.direction, moon.direction, moon.smooth_disc), 1);
  EXPECT_NEAR(smoothDiscShare(directionFromAngles(180, 60), moon.direction, moon.smooth_disc), 4e-4 / square, 1e-4);
}

// The top of its picture is where `up` is.
TEST(Moon, ShowsItsTopWhereItIsAsked) {
  MoonSettings moon;
  moon.direction = directionFromAngles(180, 0);
  for (const Vec3 up : {Vec3{0, 1, 0}, Vec3{1, 0, 0}, Vec3{-0.6F, 0.8F, 0.5F}}) {
    moon.up = up;
    const Vec3 across = *normalized(Vec3{up.x, up.y, 0});
    const Vec2 top = *moonUv(*normalized(moon.direction + across * 0.02F), moon);
    EXPECT_NEAR(top.y, 0.5F, 1e-4);
    EXPECT_GT(top.x, 0.6F);
  }
}

// Stars do not shine through the dark part of a moon.
TEST(Moon, HidesStars) {
  SkySettings sky = skyForSun(200, -40);
  sky.stars.emplace().count = 200000;
  sky.moon.emplace().direction = directionFromAngles(180, 45);
  sky.moon->phase_degrees = 180;
  SkySettings empty = sky;
  empty.stars.reset();
  empty.moon.reset();
  int behind = 0, beside = 0;
  for (float x = -5; x < 5; x += 0.03F)
    for (const float y : {-1.0F, -0.4F, 0.3F, 1.1F}) {
      const Vec3 view = directionFromAngles(180 + x, 45 + y);
      const bool has_star = length(skyColor(view, sky) - skyColor(view, empty)) > 0.004F;
      (angleDegrees(view, sky.moon->direction) < 2.7 ? behind : beside) += has_star;
    }
  EXPECT_EQ(behind, 0);
  EXPECT_GT(beside, 10);
}

// Towards the sun the haze below the horizon glows as the sky above it: no seam but the disc's own.
TEST(Sky, GlowHasNoSeamAtTheHorizon) {
  for (const float viewer_height : {0.0F, 0.01F})
    for (const DiscKind disc : {DiscKind::kSimple, DiscKind::kSmooth})
      for (const float azimuth : {0.0F, 3.0F, 20.0F, 90.0F, 180.0F}) {
        SkySettings sky;
        sky.to_sun = directionFromAngles(0, 12);
        sky.sun_disc = disc;
        sky.viewer_height = viewer_height;
        const float dip = std::acos(1 / (1 + viewer_height)) * float(180 / kPi);
        const Vec3 above = skyColor(directionFromAngles(azimuth, -dip + 0.002F), sky),
                   below = skyColor(directionFromAngles(azimuth, -dip - 0.002F), sky);
        EXPECT_LT(length(above - below), 0.03F * length(above)) << azimuth << " " << viewer_height;
      }
}

// The mean of the gradient over the upper hemisphere, by the cosine, summed over heights; the ground reflects that and the sun.
TEST(Sky, AmbientLightIsThatOfTheSky) {
  SkyColors colors = skyColorsForSun(0.4F);
  Vec3 mean;
  constexpr int kSteps = 2000;
  for (int i = 0; i < kSteps; ++i) {
    const float y = (float(i) + 0.5F) / kSteps;
    mean += lerp(colors.low_sky, colors.zenith, std::sqrt(y)) * (2 * y / kSteps);
  }
  const SkyColors lit = withAmbientOfSky(colors, 0.4F);
  const float grey = dot(mean, {0.2126F, 0.7152F, 0.0722F});
  EXPECT_LT(length(lit.ambient_sky - (mean + Vec3{grey, grey, grey}) * 0.5F), 1e-3F);
  EXPECT_EQ(lit.zenith, colors.zenith);
  EXPECT_EQ(lit.sun_color, colors.sun_color);
  const SkyColors night = withAmbientOfSky(colors, -0.4F), noon = withAmbientOfSky(colors, 1);
  EXPECT_EQ(night.ambient_sky, lit.ambient_sky);
  for (const auto& [low, high] : {std::pair(night.ground, lit.ground), std::pair(lit.ground, noon.ground)}) EXPECT_LT(low.x, high.x);
  EXPECT_LT(length(lit.ambient_ground), length(lit.ground));
}

// Where only edges have all samples, no pixel is off by more than can be seen, and the disc's rim is exact.
TEST(Sky, SamplesAtEdgesAlone) {
  SkySettings sky;
  sky.to_sun = *normalized(Vec3{0.05F, 0.1F, -1});
  sky.moon.emplace().direction = *normalized(Vec3{-0.2F, 0.15F, -1});
  const Camera camera{{0, 0, 0}, {0, 0.1F, -1}, 40, 160, 120};
  const Image all = renderSky(camera, sky, 3), edges = renderSky(camera, sky, 3, SkySampling::kAtEdges), one = renderSky(camera, sky, 1);
  size_t same = 0;
  float largest = 0, largest_of_one = 0;
  for (size_t i = 0; i < all.pixels.size(); ++i) {
    same += edges.pixels[i] == all.pixels[i];
    largest = std::max(largest, length(edges.pixels[i] - all.pixels[i]));
    largest_of_one = std::max(largest_of_one, length(one.pixels[i] - all.pixels[i]));
  }
  EXPECT_GT(same, 100U);
  EXPECT_LT(same, all.pixels.size() * 9 / 10) << "even parts have one sample";
  EXPECT_LT(largest, 1.5F / 256);
  EXPECT_GT(largest_of_one, 0.1F);
}

}  // namespace
}  // namespace cloudbake
