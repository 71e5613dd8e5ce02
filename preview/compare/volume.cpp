// Single scattering along a view ray x(t), by "On Mesh Cloud Rendering" (2019-06-30), its fields R and G for every point of the volume:
//   C = ∫ σ_v f(x) T(t) C(x) dt + T(∞)·sky,   T(t) = exp(−∫₀ᵗ σ_v f dt),   C(x) of R = p(l·v) exp(−σ ℓ_sun(x)) and G = exp(−σ ℓ_sky(x))
// with f the inside fraction. Per step h: α = 1 − exp(−σ_v f h), front to back, f and ℓ trilinear at the step's middle.
// p: Henyey and Greenstein, "Diffuse radiation in the galaxy" (1941), times 4π. Octaves: Wrenninge, Kulla, Lundqvist, "Oz: The Great and
// Volumetric" (SIGGRAPH 2013): R = Σᵢ bⁱ p(cⁱ g) exp(−aⁱ σ ℓ_sun), a = b = c = 1/2, here divided by Σᵢ bⁱ, so that a point with nothing
// between it and the light is as bright as with single scattering, and so that pictures can share an exposure.
// All of this is computed in cells: the centre of cell (i, j, k) is (i, j, k), so size and place of the cloud do not matter.
#include "preview/compare/volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "core/parallel.h"
#include "core/random.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

constexpr size_t kRaysPerTask = 256;
constexpr float kOpaque = 1e-5F;  // a view ray ends where less than this passes through

Vec3 toCells(const CoverageField& field, Vec3 world) {
  return field.frame.toIndex(world) - Vec3{float(field.first[0]), float(field.first[1]), float(field.first[2])};
}

size_t cellIndex(const CoverageField& field, int i, int j, int k) {
  return (size_t(k) * size_t(field.cells[1]) + size_t(j)) * size_t(field.cells[0]) + size_t(i);
}

/// The extent of the cloud.
struct Extent {
  Box box;                 // outside, a trilinear read of the fractions gives 0; cells
  float longest_side = 0;  // of the cells with cloud in them
};

Extent extentOf(const CoverageField& field) {
  Box filled;
  for (int k = 0; k < field.cells[2]; ++k)
    for (int j = 0; j < field.cells[1]; ++j)
      for (int i = 0; i < field.cells[0]; ++i)
        if (field.fractions[cellIndex(field, i, j, k)] > 0) filled.add({float(i), float(j), float(k)});
  if (filled.empty()) return {};
  const Vec3 last{float(field.cells[0] - 1), float(field.cells[1] - 1), float(field.cells[2] - 1)}, low = filled.low, high = filled.high;
  Extent extent{{}, filled.longestSide() + 1};
  extent.box.add({std::max(0.0F, low.x - 1), std::max(0.0F, low.y - 1), std::max(0.0F, low.z - 1)});
  extent.box.add({std::min(last.x, high.x + 1), std::min(last.y, high.y + 1), std::min(last.z, high.z + 1)});
  return extent;
}

/// Equal steps along a ray through the extent.
struct Steps {
  float enter = 0, size = 0;
  int count = 0;
};

Steps stepsThrough(const Extent& extent, const Ray& ray, int steps) {
  if (extent.box.empty()) return {};
  // Parallel to an axis these are ±∞, which is right, or NaN on a face, where there is no cloud.
  const Vec3 &o = ray.origin, &d = ray.direction, &low = extent.box.low, &high = extent.box.high;
  float enter = 0, leave = INFINITY;
  for (const auto& [origin, direction, from, to] :
       {std::array{o.x, d.x, low.x, high.x}, {o.y, d.y, low.y, high.y}, {o.z, d.z, low.z, high.z}}) {
    const float first = (from - origin) / direction, second = (to - origin) / direction;
    enter = std::max(enter, std::min(first, second));
    leave = std::min(leave, std::max(first, second));
  }
  if (!(enter < leave)) return {};
  const float length = leave - enter;
  const int count = std::max(1, int(std::ceil(length * float(steps) / extent.longest_side)));
  return {enter, length / float(count), count};
}

/// Weights of the eight cells around a point.
class Trilinear {
 public:
  Trilinear(const CoverageField& field, Vec3 p) {
    const auto place = [](float x, int cells, int& cell) {
      cell = int(std::clamp(x, 0.0F, std::max(0.0F, float(cells - 2))));
      return saturate(x - float(cell));
    };
    int i = 0, j = 0, k = 0;
    x_ = place(p.x, field.cells[0], i), y_ = place(p.y, field.cells[1], j), z_ = place(p.z, field.cells[2], k);
    first_ = cellIndex(field, i, j, k);
    row_ = size_t(field.cells[0]);
    plane_ = row_ * size_t(field.cells[1]);
  }
  float read(std::span<const float> values) const {
    const float* low = &values[first_];
    const float* high = low + plane_;
    return lerp(face(low), face(high), z_);
  }

 private:
  float face(const float* at) const { return lerp(lerp(at[0], at[1], x_), lerp(at[row_], at[row_ + 1], x_), y_); }
  float x_ = 0, y_ = 0, z_ = 0;
  size_t first_ = 0, row_ = 0, plane_ = 0;
};

/// The octaves of a light, for one view ray.
struct OctaveLight {
  std::array<float, kMostLightOctaves + 1> weights{}, extinctions{};  // bⁱ p(cⁱ g) / Σ bⁱ, aⁱ σ
  int count = 1;

  float at(float length) const {
    float sum = 0;
    for (int i = 0; i < count; ++i) sum += weights[size_t(i)] * std::exp(-extinctions[size_t(i)] * length);
    return sum;
  }
};

OctaveLight octaveLight(float cosine, float asymmetry, const VolumeSettings& settings) {
  const OctaveSettings& octaves = settings.light.octaves;
  OctaveLight light;
  light.count = octaves.count + 1;
  float weight = 1, sum = 0, extinction = settings.extinction;
  for (size_t i = 0; i < size_t(light.count); ++i) {
    light.weights[i] = weight * henyeyGreenstein(cosine, asymmetry);
    light.extinctions[i] = extinction;
    sum += weight;
    weight *= octaves.contribution;
    extinction *= octaves.extinction;
    asymmetry *= octaves.eccentricity;
  }
  for (float& one : light.weights) one /= sum;
  return light;
}

void checkSettings(const Volume& volume, const VolumeSettings& settings) {
  const size_t cells = volume.field->fractions.size();
  if (volume.to_sun.size() != cells || volume.to_sky.size() != cells)
    throw std::invalid_argument("renderVolume: one length per cell is needed towards the sun and the sky");
  if (settings.steps < 1) throw std::invalid_argument("renderVolume: at least one step");
  if (!(std::abs(settings.light.asymmetry) < 1)) throw std::invalid_argument("renderVolume: the asymmetry lies between -1 and 1");
  if (settings.light.octaves.count < 0 || settings.light.octaves.count > kMostLightOctaves)
    throw std::invalid_argument("renderVolume: 0 to 15 octaves");
}

/// The march of a volume.
struct March {
  const Volume& volume;
  const VolumeSettings& settings;
  Vec3 to_sun;
  Extent extent;
  float per_cell;      // world units
  OctaveLight of_sky;  // scattered in every direction alike, because it comes from many

  March(const Volume& marched, Vec3 sun, const VolumeSettings& with)
      : volume(marched),
        settings(with),
        to_sun(sun),
        extent(extentOf(*marched.field)),
        per_cell(float(marched.field->frame.voxel_size)),
        of_sky(octaveLight(0, 0, with)) {}

  // Along a ray of the cells.
  SeenLight along(const Ray& ray, uint64_t stream) const {
    const Steps steps = stepsThrough(extent, ray, settings.steps);
    const float extinction = settings.light.view_extinction * settings.extinction * per_cell;
    const OctaveLight of_sun = octaveLight(dot(to_sun, ray.direction), settings.light.asymmetry, settings);
    const auto shadeAt = [&](const Trilinear& cells) -> Shade {
      return {of_sun.at(cells.read(volume.to_sun)), of_sky.at(cells.read(volume.to_sky))};
    };

    Shade sum;
    float through = 1;
    for (int i = 0; i < steps.count && through > kOpaque; ++i) {
      const float place = settings.jitter ? uniformFloat(hashDraw(stream, uint32_t(i), 0)) : 0.5F;
      const Trilinear cells(*volume.field, ray.origin + ray.direction * (steps.enter + (float(i) + place) * steps.size));
      const float fraction = cells.read(volume.field->fractions);
      if (!(fraction > 0)) continue;
      const float passed = std::exp(-extinction * fraction * steps.size), weight = through * (1 - passed);
      const Shade shade = shadeAt(cells);
      sum.sun += weight * shade.sun, sum.sky += weight * shade.sky;
      through *= passed;
    }
    const float opacity = 1 - through;
    if (!(opacity > 0)) return {0, shadeAt(Trilinear(*volume.field, ray.origin))};
    return {opacity, {sum.sun / opacity, sum.sky / opacity}};
  }
};

}  // namespace

Image renderVolume(const Volume& volume, const Camera& camera, const LightSettings& light, const VolumeSettings& settings) {
  checkSettings(volume, settings);
  const March march(volume, light.sky.to_sun, settings);
  Camera local = camera;
  local.look_from = toCells(*volume.field, camera.look_from);
  local.look_at = toCells(*volume.field, camera.look_at);
  const std::vector<Vec2> places = pixelPlaces(light.samples_per_side);
  const CameraRays rays(local);

  Image image = blankImage(camera.width, camera.height);
  parallelFor(camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      Vec3 sum;
      for (size_t i = 0; i < places.size(); ++i) {
        const Ray ray = rays.at(float(x) + places[i].x, float(y) + places[i].y);
        const auto [opacity, shade] = march.along(ray, pointStream(i, {float(x), float(y), 0}));
        sum += cloudColor(shade, light.sky.colors) * opacity + skyColor(ray.direction, light.sky) * (1 - opacity);
      }
      image.at(x, y) = sum / float(places.size());
    }
  });
  return image;
}

std::vector<SeenLight> lightAlong(const Volume& volume, std::span<const Ray> rays, Vec3 to_sun, const VolumeSettings& settings) {
  checkSettings(volume, settings);
  const March march(volume, to_sun, settings);
  std::vector<SeenLight> seen(rays.size());
  parallelBlocks(rays.size(), kRaysPerTask, [&](size_t begin, size_t end) {
    for (size_t n = begin; n < end; ++n) seen[n] = march.along({toCells(*volume.field, rays[n].origin), rays[n].direction}, n);
  });
  return seen;
}

std::vector<Vec3> cellCenters(const CoverageField& field) {
  std::vector<Vec3> centers;
  centers.reserve(field.fractions.size());
  for (int k = 0; k < field.cells[2]; ++k)
    for (int j = 0; j < field.cells[1]; ++j)
      for (int i = 0; i < field.cells[0]; ++i)
        centers.push_back(field.frame.toWorld({float(field.first[0] + i), float(field.first[1] + j), float(field.first[2] + k)}));
  return centers;
}

std::vector<float> plainLengths(const CoverageField& field, std::span<const Vec3> points, Vec3 direction, int steps) {
  if (steps < 1) throw std::invalid_argument("plainLengths: at least one step");
  const Extent extent = extentOf(field);
  std::vector<float> lengths(points.size());
  parallelBlocks(points.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t n = begin; n < end; ++n) {
      const Ray ray{toCells(field, points[n]), direction};
      const Steps march = stepsThrough(extent, ray, steps);
      float sum = 0;
      for (int i = 0; i < march.count; ++i)
        sum += Trilinear(field, ray.origin + direction * (march.enter + (float(i) + 0.5F) * march.size)).read(field.fractions);
      lengths[n] = float(double(sum * march.size) * field.frame.voxel_size);
    }
  });
  return lengths;
}

}  // namespace cloudbake
