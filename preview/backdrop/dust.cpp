// Single scattering in a thin medium: along a ray with the extinction σ(t) of the dust,
//   L = ∫ T(t) σ(t) a (phase(θ) S(sun) T_sun + S(sky) T_up) dt,   T(t) = exp(−∫₀ᵗ σ),
// with the phase function of Henyey and Greenstein times 4π. In the unit ball into which the box's ellipsoid is scaled, the dust is full up
// to fade_start and gone at 1.
#include "preview/backdrop/dust.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "core/parallel.h"
#include "core/random.h"
#include "preview/backdrop/sample_sum.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

/// The part of a ray in the unit ball.
struct Chord {
  float enter, leave;
};

std::optional<Chord> chordOf(Vec3 from, Vec3 along) {
  const double a = dot(along, along), b = dot(from, along), c = double(dot(from, from)) - 1, discriminant = b * b - a * c;
  if (!(discriminant > 0) || !(a > 0)) return std::nullopt;
  const double root = std::sqrt(discriminant);
  const auto enter = float(std::max(0.0, (-b - root) / a)), leave = float((-b + root) / a);
  return leave > enter ? std::optional<Chord>({enter, leave}) : std::nullopt;
}

}  // namespace

std::vector<Layer> renderDust(const Camera& camera, const SkySettings& sky, const Box& box, const Affine& to_world,
                              const DustSettings& settings, const LightAt& light, std::span<const Layer> surfaces) {
  requireInRange(dustKeys(), settings);
  if (box.empty() || !(box.longestSide() > 0) || !inverted(to_world)) throw std::invalid_argument("renderDust: the box has no size");
  // From the world to the ball.
  const Vec3 half = box.size() * (0.5F * settings.reach);
  const float least = 1e-6F * box.longestSide();
  Affine to_ball;
  to_ball.linear[0][0] = 1 / std::max(half.x, least), to_ball.linear[1][1] = 1 / std::max(half.y, least);
  to_ball.linear[2][2] = 1 / std::max(half.z, least);
  const Vec3 center = transformVector(to_ball, box.center());
  to_ball.offset = {-center.x, -center.y, -center.z};
  to_ball = compose(to_ball, *inverted(to_world));

  const float longest = std::cbrt(float(std::abs(determinant(to_world)))) * box.longestSide(), extinction = settings.thickness / longest;
  const KeyLight key{keyLight(sky).direction, lightColors(sky).sun_color};
  const Vec3 from_sky = sky.colors.ambient_sky * settings.ambient;
  const int n = settings.samples_per_side;
  const std::vector<Vec2> places = pixelPlaces(n);
  std::vector<Layer> layers(surfaces.size() + 1, blankLayer(camera.width, camera.rows(), n));
  const CameraRays rays(camera);
  parallelFor(camera.rows(), [&](int y) {
    const int row = camera.first_row + y;
    for (int x = 0; x < camera.width; ++x)
      for (int i = 0; i < n * n; ++i) {
        const Ray ray = rays.at(float(x) + places[size_t(i)].x, float(row) + places[size_t(i)].y);
        const auto chord = chordOf(transformPoint(to_ball, ray.origin), transformVector(to_ball, ray.direction));
        if (!chord) continue;
        const Vec3 from_sun = key.color * henyeyGreenstein(dot(ray.direction, key.direction), settings.asymmetry);
        const Cuts cuts = cutsAt(surfaces, x, y, i, n);
        const float step = (chord->leave - chord->enter) / float(settings.samples);
        const uint64_t stream = hashDraw(mix64(settings.seed + kGolden64), uint32_t(x), uint32_t(row));
        const float jitter = settings.dither * (uniformFloat(hashDraw(stream, uint32_t(i), 0)) - 0.5F);
        SampleSum sum(chord->enter, settings.samples, 1, cuts);
        while (sum.more()) {
          // A sample stands for a step; it is taken at a place in it.
          const Vec3 point = ray.origin + ray.direction * (sum.t() + (0.5F + jitter) * step);
          const float full = smoothStep(1, settings.fade_start, length(transformPoint(to_ball, point)));
          CloudSample sample{{}, 1 - std::exp(-extinction * full * step), step};
          if (sample.opacity > 0)
            sample.color = settings.color * (from_sun * light(point, key.direction) + from_sky * light(point, {0, 1, 0}));
          sum.take(sample);
        }
        const CutPixels pixels = sum.pixels();
        for (size_t part = 0; part < layers.size(); ++part) {
          layers[part].at(x, y, i) = pixels[part];
          if (pixels[part].opacity > 0) layers[part].at(x, y, i).distance = cuts.within(part, pixels[part].distance);
        }
      }
  });
  return layers;
}

// --- Keys ---

const Keys<DustSettings>& dustKeys() {
  using S = DustSettings;
  static const Keys<S> keys{
      {"reach", &S::reach, 0.01, 100, "how far the dust extends, in half sides of the lattice's box", KeyUse::kScript},
      {"thickness", &S::thickness, 0, 1e3, "optical depth of the box's longest side"},
      {"fade_start", &S::fade_start, 0, 0.999, "share of the reach from which the dust thins out"},
      {"color", &S::color, 0, kBright, "albedo"},
      {"asymmetry", &S::asymmetry, -0.99, 0.99, "g of Henyey and Greenstein's phase function"},
      {"ambient", &S::ambient, 0, 1e3, "factor of the sky's light"},
      {"samples", &S::samples, 1, 4096, "samples along a ray through the dust"},
      {"dither", &S::dither, 0, 1, "how far the first sample is moved at random, in steps"},
      {"seed", &S::seed, 0, kMostSeed, "seed of the dither"},
      {"samples_per_side", &S::samples_per_side, 1, 16, "n·n samples per pixel", KeyUse::kScript},
  };
  return keys;
}

}  // namespace cloudbake
