// What a flash of lightning looks like, after Zhu and others, "Some properties of negative cloud-to-ground flashes from observations of a
// local thunderstorm based on accurate-stroke-count studies" (Journal of Atmospheric and Solar-Terrestrial Physics, 2015), who counted
// 1085 flashes: 30.5 % have a single return stroke, and the chance of one more is about the same after each, which gives 3.3 strokes on
// average; strokes are 62 ms apart (geometric mean), and later ones have 0.52 of the strength of the first. A stroke itself is over in less
// than a millisecond; continuing currents and the eye make it last, so that its light fades exponentially.
#include "preview/lamp.h"

#include "core/random.h"

namespace cloudbake {

namespace {

constexpr float kSingleStrokes = 0.305F, kInterval = 0.062F, kLaterStrength = 0.52F;
constexpr float kLongestFlash = 2;  // seconds, with what is left of its light: 8 strokes and 12 times the longest decay

Flash flashOf(const LightningSettings& settings, uint32_t number) {
  uint32_t draws = 0;
  const auto draw = [&] { return uniformFloat(hashDraw(mix64((settings.seed + 1) * kGolden64), number, draws++)); };
  const auto about = [&](float middle) { return middle * (0.5F + draw()); };
  Flash flash;
  const Vec3 side{2 * draw() - 1, 2 * draw() - 1, 2 * draw() - 1};
  flash.place = settings.place + settings.spread * side;
  float seconds = settings.at.value_or((settings.every_seconds - kLongestFlash) * draw());
  flash.strokes.push_back({seconds, 1});
  while (int(flash.strokes.size()) < settings.most_strokes && draw() >= kSingleStrokes) {
    seconds += about(kInterval);
    flash.strokes.push_back({seconds, about(kLaterStrength)});
  }
  return flash;
}

// The flash of a moment, and the seconds from which its strokes count.
std::pair<size_t, float> flashAt(const LightningSettings& settings, double seconds) {
  if (settings.at) return {0, float(seconds)};
  const double stretch = std::floor(seconds / double(settings.every_seconds));
  const double number = stretch - kFlashes * std::floor(stretch / kFlashes);
  return {size_t(number), float(seconds - stretch * double(settings.every_seconds))};
}

}  // namespace

std::vector<Flash> flashesOf(const LightningSettings& settings) {
  std::vector<Flash> flashes;
  for (uint32_t i = 0; i < (settings.at ? 1U : uint32_t(kFlashes)); ++i) flashes.push_back(flashOf(settings, i));
  return flashes;
}

float flashBrightness(const Flash& flash, float seconds, float decay_seconds) {
  float sum = 0;
  for (const auto& [start, strength] : flash.strokes)
    if (seconds >= start) sum += strength * std::exp((start - seconds) / decay_seconds);
  return sum < kDarkFlash ? 0 : sum;
}

Lamp lampOf(const LampSettings& settings) {
  Lamp lamp{settings.place, settings.color * settings.strength, settings.range, settings.radius};
  if (!settings.look_at) return lamp;
  const auto cosine = [](float degrees) { return std::cos(degrees * float(kPi / 180)); };
  lamp.axis = normalized(*settings.look_at - settings.place).value_or(lamp.axis);
  lamp.cone = {cosine(settings.inner_degrees), cosine(settings.outer_degrees)};
  return lamp;
}

std::vector<Lamp> lampsAt(std::span<const LampSettings> lamps, std::span<const LightningSettings> lightning, double seconds) {
  std::vector<Lamp> all;
  for (const LampSettings& lamp : lamps) all.push_back(lampOf(lamp));
  for (const LightningSettings& settings : lightning) {
    const auto [number, since] = flashAt(settings, seconds);
    const Flash flash = flashesOf(settings)[number];
    const float brightness = flashBrightness(flash, since, settings.decay_seconds);
    all.push_back({flash.place, settings.color * (settings.strength * brightness), settings.range, settings.radius});
  }
  std::erase_if(all, [](const Lamp& lamp) { return lamp.color == Vec3{}; });
  return all;
}

// --- Keys ---

const Keys<LampSettings>& lampKeys() {
  using S = LampSettings;
  static const Keys<S> keys{
      {"place", &S::place, -kFar, kFar, "where the lamp is, world units; it may be inside a cloud", KeyUse::kScript},
      {"color", &S::color, 0, kBright, "its colour", KeyUse::kScript},
      {"strength", &S::strength, 0, 1e9, "factor of the colour: its light at distance 1", KeyUse::kScript},
      {"range", &S::range, 0, kFar, "the light ends there, world units; 0: without end", KeyUse::kScript},
      {"radius", &S::radius, 1e-6, kFar, "of the source, world units: nearer the light grows no more", KeyUse::kScript},
      {"look_at", &S::look_at, -kFar, kFar, "where a spotlight shines to; unset: it shines to all sides", KeyUse::kScript,
       "the page has a spotlight or not"},
      {"inner_angle", &S::inner_degrees, 0, 89, "of a spotlight: all of its light is within it, degrees from its axis", KeyUse::kScript,
       "the page has a spotlight or not"},
      {"outer_angle", &S::outer_degrees, 0.1, 90, "of a spotlight: no light is outside of it, degrees from its axis", KeyUse::kScript,
       "the page has a spotlight or not"},
  };
  return keys;
}

const Keys<LightningSettings>& lightningKeys() {
  using S = LightningSettings;
  constexpr const char* kDrawn = "the page has the flashes as they were drawn";
  static const Keys<S> keys{
      {"place", &S::place, -kFar, kFar, "where flashes are, world units, as a rule inside a cloud", KeyUse::kScript, kDrawn},
      {"spread", &S::spread, 0, kFar, "each flash is at another place, so far away from it at most along x, y and z", KeyUse::kScript,
       kDrawn},
      {"color", &S::color, 0, kBright, "their colour", KeyUse::kScript},
      {"strength", &S::strength, 0, 1e9, "factor of the colour: the light of a first stroke at distance 1", KeyUse::kScript},
      {"range", &S::range, 0, kFar, "the light ends there, world units; 0: without end", KeyUse::kScript},
      {"radius", &S::radius, 1e-6, kFar, "of the channel, world units: nearer the light grows no more", KeyUse::kScript},
      {"every", &S::every_seconds, 2, 1e6, "seconds in which there is one flash; after 16 of them they repeat", KeyUse::kScript, kDrawn},
      {"at", &S::at, 0, 1e6, "moment of a single flash, in place of many, seconds; unset: every", KeyUse::kScript, kDrawn},
      {"strokes", &S::most_strokes, 1, 8, "return strokes of a flash at most", KeyUse::kScript, kDrawn},
      {"decay", &S::decay_seconds, 0.005, 0.1, "time in which the light of a stroke falls to 1/e, seconds", KeyUse::kScript},
      {"seed", &S::seed, 0, kMostSeed, "selects other moments, strokes and places", KeyUse::kScript, kDrawn},
  };
  return keys;
}

}  // namespace cloudbake
