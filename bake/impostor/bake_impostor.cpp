#include "bake/impostor/bake_impostor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include "bake/lobe/fit_lobe.h"
#include "bake/lobe/sweep.h"
#include "bake/lobe/volume_samples.h"
#include "core/lobe_lighting.h"
#include "core/parallel.h"
#include "core/portable_math.h"
#include "core/vertex_normals.h"

namespace cloudbake {

namespace {

constexpr int kRaysPerSide = 2;              // rays to a side of a texel
constexpr float kLeastOpacity = 1.0F / 512;  // half of a step of what is stored

/// A frame of the atlas.
struct AtlasFrame {
  int i = 0, j = 0;
  FrameAxes axes;
};
AtlasFrame atlasFrame(const ImpostorInfo& info, int number) {
  const int i = number % info.views, j = number / info.views;
  return {i, j, frameAxes(frameDirection(i, j, info.views))};
}

// A ray of a texel, away from the eye, that begins on the near side of the ball.
Ray rayOf(const ImpostorInfo& info, const AtlasFrame& frame, int x, int y, int ray) {
  const auto place = [&](int texel, int part) {
    return (2 * (float(texel) + (float(part) + 0.5F) / kRaysPerSide) / float(info.frame) - 1) * info.radius;
  };
  const float right = place(x, ray % kRaysPerSide), up = -place(y, ray / kRaysPerSide);
  return {info.center + frame.axes.right * right + frame.axes.up * up + frame.axes.to_eye * info.radius, -frame.axes.to_eye};
}

/// What is in a row of texels of a frame; rows are put together in order.
struct RowOfTexels {
  SeenTexels seen;
  std::vector<Vec3> places;    // at which the light is taken: kRaysPerSide² · nodes of each texel
  std::vector<float> weights;  // of these, with the sum 1 for each texel
};

// The rows of all frames, one after the other.
template <class Fill>
std::vector<RowOfTexels> rowsOf(const ImpostorInfo& info, int first, int count, const Fill& fill) {
  std::vector<RowOfTexels> rows(size_t(count) * size_t(info.frame));
  parallelFor(rows.size(), [&](size_t row) {
    const AtlasFrame frame = atlasFrame(info, first + int(row) / info.frame);
    const int y = int(row) % info.frame;
    const size_t start = (size_t(frame.j * info.frame + y) * size_t(info.views) + size_t(frame.i)) * size_t(info.frame);
    for (int x = 0; x < info.frame; ++x) fill(rows[row], uint32_t(start + size_t(x)), frame, x, y);
  });
  return rows;
}

template <class T>
void append(std::vector<T>& all, const std::vector<T>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

SeenTexels joined(const std::vector<RowOfTexels>& rows) {
  SeenTexels all;
  for (const RowOfTexels& row : rows) {
    append(all.texels, row.seen.texels);
    append(all.opacity, row.seen.opacity);
    append(all.depth, row.seen.depth);
    append(all.light, row.seen.light);
  }
  return all;
}

/// The fractions of a field along rays.
class FieldMarch {
 public:
  FieldMarch(const CoverageField& field, float view_extinction)
      : field_(field), per_step_(view_extinction * float(field.frame.voxel_size)) {}

  /// The opacity of a ray, and the distances of `nodes`, each of which is in the middle of an equal part of the opacity.
  float along(const Ray& ray, float most, std::span<float> nodes) const {
    const auto voxel = float(field_.frame.voxel_size);
    const Vec3 origin = field_.frame.toIndex(ray.origin) - Vec3{float(field_.first[0]), float(field_.first[1]), float(field_.first[2])};
    float enter = 0, leave = most / voxel;
    const std::array<float, 3> from{origin.x, origin.y, origin.z}, along{ray.direction.x, ray.direction.y, ray.direction.z};
    for (size_t axis = 0; axis < 3; ++axis) {
      const float low = -from[axis] / along[axis], high = (float(field_.cells[axis] - 1) - from[axis]) / along[axis];
      enter = std::max(enter, std::min(low, high));
      leave = std::min(leave, std::max(low, high));
    }
    if (!(enter < leave)) return 0;
    const int steps = std::max(1, int(leave - enter));
    const float step = (leave - enter) / float(steps);
    thread_local std::vector<float> depths;  // τ at the end of each step
    depths.clear();
    float depth = 0;
    for (int s = 0; s < steps; ++s) {
      depth += fractionAt(origin + ray.direction * (enter + (float(s) + 0.5F) * step)) * per_step_ * step;
      depths.push_back(depth);
    }
    if (depth == 0) return 0;
    const float opacity = 1 - portableExp(-depth);
    size_t s = 0;
    for (size_t n = 0; n < nodes.size(); ++n) {
      const float wanted = -portableLog(1 - opacity * (float(n) + 0.5F) / float(nodes.size()));
      while (s + 1 < depths.size() && depths[s] < wanted) ++s;
      const float before = s > 0 ? depths[s - 1] : 0, after = depths[s];
      const float within = after > before ? std::clamp((wanted - before) / (after - before), 0.0F, 1.0F) : 0.5F;
      nodes[n] = (enter + (float(s) + within) * step) * voxel;
    }
    return opacity;
  }

 private:
  float fractionAt(Vec3 p) const {
    const auto cell = [](float at, int cells) { return std::clamp(int(at), 0, std::max(0, cells - 2)); };
    const int i = cell(p.x, field_.cells[0]), j = cell(p.y, field_.cells[1]), k = cell(p.z, field_.cells[2]);
    const auto row = size_t(field_.cells[0]), plane = row * size_t(field_.cells[1]);
    const float* low = &field_.fractions[size_t(k) * plane + size_t(j) * row + size_t(i)];
    return std::clamp(trilinear(low, row, plane, p.x - float(i), p.y - float(j), p.z - float(k)), 0.0F, 1.0F);
  }

  const CoverageField& field_;
  float per_step_;
};

// p(cⁱ g) S of the octaves: what a view sees of a light that passes lengths of cloud to the place and is scattered there.
class ScatteredLight {
 public:
  ScatteredLight(const LightTerms& terms, const VolumeLight& light, float cosine) : terms_(terms), weights_(terms.octave_weights) {
    float asymmetry = light.asymmetry;
    for (float& weight : weights_) weight *= phaseOf(asymmetry, cosine), asymmetry *= light.octaves.eccentricity;
  }
  float at(float length) const {
    float sum = 0;
    for (size_t i = 0; i < weights_.size(); ++i) sum += weights_[i] * portableExp(-terms_.exponentials[terms_.used[i]].exponent * length);
    return sum;
  }

 private:
  const LightTerms& terms_;
  std::vector<float> weights_;
};

}  // namespace

SeenTexels seenOfVolume(const ImpostorInfo& info, int first, int count, const VolumeFrames& volume, std::span<const Vec3> axes) {
  constexpr size_t kRays = kRaysPerSide * kRaysPerSide;
  const auto nodes_per_ray = size_t(volume.nodes), per_texel = kRays * nodes_per_ray;
  const FieldMarch march(volume.field.coverage, volume.light.view_extinction * info.extinction);
  const auto rows = rowsOf(info, first, count, [&](RowOfTexels& row, uint32_t texel, const AtlasFrame& frame, int x, int y) {
    std::vector<float> distances(per_texel);
    std::array<float, kRays> opacities{};
    float sum = 0, depth = 0;
    for (size_t r = 0; r < kRays; ++r) {
      const auto nodes = std::span(distances).subspan(r * nodes_per_ray, nodes_per_ray);
      sum += opacities[r] = march.along(rayOf(info, frame, x, y, int(r)), 2 * info.radius, nodes);
    }
    if (sum / kRays < kLeastOpacity) return;
    for (size_t r = 0; r < kRays; ++r)
      for (size_t n = 0; n < nodes_per_ray; ++n) {
        const float weight = opacities[r] / (sum * float(nodes_per_ray)), distance = distances[r * nodes_per_ray + n];
        const Ray ray = rayOf(info, frame, x, y, int(r));
        row.places.push_back(ray.origin + ray.direction * distance);
        row.weights.push_back(weight);
        depth += weight * distance;
      }
    row.seen.texels.push_back(texel);
    row.seen.opacity.push_back(sum / kRays);
    row.seen.depth.push_back(depth / (2 * info.radius));
  });
  SeenTexels seen = joined(rows);
  std::vector<Vec3> places;
  std::vector<float> weights;
  for (const RowOfTexels& row : rows) append(places, row.places), append(weights, row.weights);
  const LightTerms terms = lightTerms({&info.extinction, 1}, volume.light.octaves);
  const size_t lights = 2 * axes.size();
  seen.light.resize(seen.texels.size() * lights);
  sweepLengths(places, axes, volume.field, volume.ray_length, [&](size_t first_axis, std::span<const float> lengths) {
    for (size_t row = 0; row < lengths.size() / std::max<size_t>(1, places.size()); ++row) {
      const size_t light = 2 * first_axis + row;
      const Vec3 direction = light % 2 == 0 ? axes[light / 2] : -axes[light / 2];
      const auto own = lengths.subspan(row * places.size(), places.size());
      std::optional<ScatteredLight> scattered;
      for (size_t t = 0; t < seen.texels.size(); ++t) {
        if (!scattered || volume.light.asymmetry != 0)
          scattered.emplace(terms, volume.light, -dot(axesOfTexel(info, seen.texels[t]).to_eye, direction));
        float sum = 0;
        for (size_t p = t * per_texel; p < (t + 1) * per_texel; ++p) sum += weights[p] * scattered->at(own[p]);
        seen.light[t * lights + light] = sum;
      }
    }
  });
  return seen;
}

namespace {

std::vector<Vec3> normalsOf(const SurfaceMesh& surface) {
  return surface.normals.empty() ? vertexNormals(surface.positions, surface.triangles) : surface.normals;
}

std::vector<Vec3> inBall(const ImpostorInfo& info, std::span<const Vec3> positions) {
  std::vector<Vec3> places;
  for (const Vec3& p : positions) places.push_back((p - info.center) / info.radius);
  return places;
}

}  // namespace

MeshFrames::MeshFrames(const BakedMesh& mesh, float half_lambert, const ImpostorInfo& info)
    : mesh_(mesh),
      half_lambert_(half_lambert),
      normals_(normalsOf(mesh.surface)),
      places_(inBall(info, mesh.surface.positions)),
      scene_(places_, mesh.surface.triangles) {}

std::optional<MeshFrames::Hit> MeshFrames::nearest(const Ray& ray) const {
  std::optional<Hit> nearest;
  scene_.forHits(ray, [&](const RayHit& hit) {
    const Triangle& t = mesh_.surface.triangles[hit.triangle];
    const Vec3 a = places_[t[0]], e = places_[t[1]] - a, f = places_[t[2]] - a, s = ray.origin - a;
    const Vec3 p = cross(ray.direction, f), q = cross(s, e);
    const float determinant = dot(e, p);
    if (determinant == 0) return;
    const float u = std::clamp(dot(s, p) / determinant, 0.0F, 1.0F), v = std::clamp(dot(ray.direction, q) / determinant, 0.0F, 1 - u);
    const float distance = dot(f, q) / determinant;
    if (!nearest || distance < nearest->distance) nearest = Hit{{t, {1 - u - v, u, v}}, distance};
  });
  return nearest;
}

SeenTexels seenOfMesh(const ImpostorInfo& info, int first, int count, const MeshFrames& frames, std::span<const Vec3> axes) {
  constexpr int kRays = kRaysPerSide * kRaysPerSide;
  constexpr float kBefore = 0.01F;  // rays begin so many radii before the ball, in front of what touches it
  const BakedMesh& mesh = frames.mesh();
  const std::vector<Vec3> lights = bothSenses(axes);
  return joined(rowsOf(info, first, count, [&](RowOfTexels& row, uint32_t texel, const AtlasFrame& frame, int x, int y) {
    std::vector<float> light(lights.size());
    float hits = 0, depth = 0;
    for (int r = 0; r < kRays; ++r) {
      const Ray ray = rayOf(info, frame, x, y, r);
      const auto hit = frames.nearest({(ray.origin - info.center) / info.radius + frame.axes.to_eye * kBefore, ray.direction});
      if (!hit) continue;
      ++hits;
      depth += hit->distance - kBefore;
      const Vec3 normal = normalAt(hit->place, frames.normals());
      for (size_t l = 0; l < lights.size(); ++l)
        light[l] += blendedTransmittance(hit->place, mesh.lobes, lights[l], mesh.info.shape, info.extinction) *
                    surfaceFactor(normal, lights[l], frames.halfLambert());
    }
    if (hits == 0) return;
    for (const float l : light) row.seen.light.push_back(l / hits);
    row.seen.texels.push_back(texel);
    row.seen.opacity.push_back(hits / kRays);
    row.seen.depth.push_back(depth / hits / 2);
  }));
}

std::pair<Vec3, float> ballAround(std::span<const Vec3> points) {
  if (points.empty()) return {};
  constexpr int kSteps = 400;
  Vec3 center = points[0];
  const auto farthest = [&] {
    return *std::max_element(points.begin(), points.end(),
                             [&](Vec3 a, Vec3 b) { return dot(a - center, a - center) < dot(b - center, b - center); });
  };
  for (int step = 1; step <= kSteps; ++step) center += (farthest() - center) / float(step + 1);
  return {center, length(farthest() - center)};
}

// --- Fit ---

namespace {

constexpr int kRounds = 5, kIterations = 3;  // of lobes and factors; more gain less than a percent

// Where the light is darkest the bulk is.
std::vector<Lobe> startsOf(std::span<const float> light, std::span<const Vec3> directions, float extinction) {
  std::vector<Lobe> starts(light.size() / directions.size());
  parallelFor(starts.size(), [&](size_t i) {
    const auto own = light.subspan(i * directions.size(), directions.size());
    Vec3 sum;
    for (size_t l = 0; l < own.size(); ++l) sum += directions[l] * own[l];
    starts[i] = {normalized(-sum).value_or(Vec3{0, -1, 0}), 1 / extinction};
  });
  return starts;
}

// The light of texels, divided by the factor of each.
std::vector<float> dividedLight(std::span<const float> light, std::span<const TexelLobe> texels) {
  const size_t count = texels.empty() ? 0 : light.size() / texels.size();
  std::vector<float> divided(light.size());
  parallelFor(texels.size(), [&](size_t t) {
    for (size_t l = t * count; l < (t + 1) * count; ++l) divided[l] = light[l] / texels[t].lit;
  });
  return divided;
}

// One round from the texels as they are.
void fitRound(std::span<const float> light, std::span<const Vec3> directions, std::span<const float> weights, float exponent,
              float extinction, std::vector<TexelLobe>& texels) {
  constexpr float kDarkest = 0.5F / 255;
  FitSettings fit;
  fit.shape = {exponent, 0};
  fit.extinctions = {extinction};
  fit.iterations = kIterations;
  std::vector<Lobe> starts;
  for (const TexelLobe& texel : texels) starts.push_back(texel.lobe);
  const std::vector<float> divided = dividedLight(light, texels);
  const std::vector<Lobe> lobes = fitLobes(starts, {directions, {}, weights, divided}, fit);
  parallelFor(texels.size(), [&](size_t t) {
    double squares = 0, products = 0;
    for (size_t l = 0; l < directions.size(); ++l) {
      const double shown = lobeTransmittance(lobes[t], directions[l], fit.shape, extinction);
      squares += weights[l] * shown * shown;
      products += weights[l] * shown * light[t * directions.size() + l];
    }
    texels[t] = {lobes[t], std::clamp(squares > 0 ? float(products / squares) : 0, kDarkest, 1.0F)};
  });
}

std::vector<TexelLobe> firstTexels(std::span<const float> light, std::span<const Vec3> directions, float extinction) {
  constexpr float kFirstLit = 0.8F;
  std::vector<TexelLobe> texels;
  for (const Lobe& start : startsOf(light, directions, extinction)) texels.push_back({start, kFirstLit});
  return texels;
}

}  // namespace

std::vector<TexelLobe> fitTexels(std::span<const float> light, const ImpostorLights& lights, float exponent, float extinction) {
  const std::vector<Vec3> directions = bothSenses(lights.axes);
  std::vector<TexelLobe> texels = firstTexels(light, directions, extinction);
  for (int round = 0; round < kRounds; ++round) fitRound(light, directions, lights.weights, exponent, extinction, texels);
  return texels;
}

float fitTexelExponent(std::span<const float> light, const ImpostorLights& lights, float start, float extinction, size_t most) {
  const std::vector<Vec3> directions = bothSenses(lights.axes);
  const size_t texels = light.size() / directions.size(), count = std::min(texels, most);
  std::vector<float> some;
  for (size_t i = 0; i < count; ++i) {
    const auto row = light.subspan(i * texels / count * directions.size(), directions.size());
    some.insert(some.end(), row.begin(), row.end());
  }
  float exponent = start;
  std::vector<TexelLobe> fitted = firstTexels(some, directions, extinction);
  for (int round = 0; round < kRounds; ++round) {
    fitRound(some, directions, lights.weights, exponent, extinction, fitted);
    std::vector<Lobe> starts;
    for (const TexelLobe& texel : fitted) starts.push_back(texel.lobe);
    FitSettings fit;
    fit.shape = {exponent, 0};
    fit.extinctions = {extinction};
    ShapeSearch search;
    search.first_step = 0.5F;
    search.vertices = count;
    exponent = fitShape(starts, {directions, {}, lights.weights, dividedLight(some, fitted)}, fit, search).exponent;
  }
  return exponent;
}

double TexelError::rms() const { return weight > 0 ? std::sqrt(squares / weight) : 0; }

// --- The atlas ---

namespace {

float inSteps(float value) { return std::round(std::clamp(value, 0.0F, 1.0F) * 255) / 255; }

}  // namespace

FrameAxes axesOfTexel(const ImpostorInfo& info, uint32_t texel) {
  const uint32_t row = uint32_t(info.views) * uint32_t(info.frame);
  return frameAxes(frameDirection(int(texel % row) / info.frame, int(texel / row) / info.frame, info.views));
}

void storeTexels(const SeenTexels& seen, std::span<const TexelLobe> lobes, Impostor& impostor) {
  for (size_t t = 0; t < seen.texels.size(); ++t) {
    const Vec2 o = encodedDirection(lobes[t].lobe.direction, axesOfTexel(impostor.info, seen.texels[t]));
    const float thickness = impostor.info.thickest > 0 ? lobes[t].lobe.thickness / impostor.info.thickest : 0;
    impostor.lobe[0].pixels[seen.texels[t]] = {inSteps(o.x), inSteps(o.y), inSteps(std::sqrt(thickness))};
    impostor.rest[0].pixels[seen.texels[t]] = {inSteps(lobes[t].lit), inSteps(seen.opacity[t]), inSteps(seen.depth[t])};
  }
}

TexelLobe storedTexel(const Impostor& impostor, uint32_t texel) {
  const Vec3 own = impostor.lobe[0].pixels[texel];
  return {{decodedDirection({own.x, own.y}, axesOfTexel(impostor.info, texel)), own.z * own.z * impostor.info.thickest},
          impostor.rest[0].pixels[texel].x};
}

// Pull and push: means of four texels by opacity, over and over, then back to what is empty (Gortler and others, "The Lumigraph", 1996).
void fillEmptyTexels(Impostor& impostor) {
  const int size = impostor.info.frame, views = impostor.info.views;
  parallelFor(size_t(views) * size_t(views), [&](size_t frame) {
    struct Texel {
      Vec3 lobe;
      float lit = 0, depth = 0, weight = 0;
    };
    struct Level {
      int size = 0;
      std::vector<Texel> texels;
      Texel& at(int x, int y) { return texels[size_t(y) * size_t(size) + size_t(x)]; }
    };
    const int left = int(frame) % views * size, top = int(frame) / views * size;
    std::vector<Level> levels{{size, std::vector<Texel>(size_t(size) * size_t(size))}};
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const Vec3 rest = impostor.rest[0].at(left + x, top + y);
        if (rest.y > 0) levels[0].at(x, y) = {impostor.lobe[0].at(left + x, top + y), rest.x, rest.z, 1};
      }
    while (levels.back().size > 1) {
      Level& fine = levels.back();
      Level coarse{(fine.size + 1) / 2, {}};
      coarse.texels.resize(size_t(coarse.size) * size_t(coarse.size));
      for (int y = 0; y < fine.size; ++y)
        for (int x = 0; x < fine.size; ++x) {
          const Texel& from = fine.at(x, y);
          Texel& to = coarse.at(x / 2, y / 2);
          to.lobe += from.lobe * from.weight, to.lit += from.lit * from.weight;
          to.depth += from.depth * from.weight, to.weight += from.weight;
        }
      for (Texel& texel : coarse.texels)
        if (texel.weight > 0) {
          texel.lobe = texel.lobe / texel.weight, texel.lit /= texel.weight, texel.depth /= texel.weight;
          texel.weight = 1;
        }
      levels.push_back(std::move(coarse));
    }
    for (size_t level = levels.size() - 1; level-- > 0;)
      for (int y = 0; y < levels[level].size; ++y)
        for (int x = 0; x < levels[level].size; ++x)
          if (Texel& texel = levels[level].at(x, y); texel.weight == 0) texel = levels[level + 1].at(x / 2, y / 2);
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        Vec3& rest = impostor.rest[0].at(left + x, top + y);
        if (rest.y > 0) continue;
        const Texel& texel = levels[0].at(x, y);
        impostor.lobe[0].at(left + x, top + y) = {inSteps(texel.lobe.x), inSteps(texel.lobe.y), inSteps(texel.lobe.z)};
        rest = {inSteps(texel.lit), 0, inSteps(texel.depth)};
      }
  });
}

// --- Six-way light maps ---

namespace {

constexpr size_t kSix = 6;

std::array<float, kSix> sixWeights(Vec3 light) {
  std::array<float, kSix> weights{};
  const std::array<float, 3> axes{light.x, light.y, light.z};
  for (size_t i = 0; i < 3; ++i) weights[axes[i] < 0 ? i + 3 : i] = axes[i] * axes[i];
  return weights;
}

// Solves the normal equations a x = b by Cholesky's decomposition; a is symmetric, and a small ridge keeps it positive.
std::array<double, kSix> solved(std::array<std::array<double, kSix>, kSix> a, std::array<double, kSix> b) {
  for (size_t i = 0; i < kSix; ++i) a[i][i] += 1e-6;
  for (size_t i = 0; i < kSix; ++i) {
    for (size_t j = 0; j <= i; ++j) {
      double sum = a[i][j];
      for (size_t k = 0; k < j; ++k) sum -= a[i][k] * a[j][k];
      a[i][j] = i == j ? std::sqrt(sum) : sum / a[j][j];
    }
  }
  for (size_t i = 0; i < kSix; ++i) {
    for (size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
    b[i] /= a[i][i];
  }
  for (size_t i = kSix; i-- > 0;) {
    for (size_t k = i + 1; k < kSix; ++k) b[i] -= a[k][i] * b[k];
    b[i] /= a[i][i];
  }
  return b;
}

}  // namespace

float sixWayLight(std::span<const float> maps, Vec3 light_in_view) {
  const auto weights = sixWeights(light_in_view);
  float sum = 0;
  for (size_t i = 0; i < kSix; ++i) sum += weights[i] * maps[i];
  return sum;
}

std::vector<float> fitSixWay(const SeenTexels& seen, const ImpostorInfo& info, const ImpostorLights& lights) {
  const std::vector<Vec3> directions = bothSenses(lights.axes);
  std::vector<float> maps(seen.texels.size() * kSix);
  parallelFor(seen.texels.size(), [&](size_t t) {
    const FrameAxes axes = axesOfTexel(info, seen.texels[t]);
    std::array<std::array<double, kSix>, kSix> a{};
    std::array<double, kSix> b{};
    for (size_t l = 0; l < directions.size(); ++l) {
      const auto own = sixWeights(inView(axes, directions[l]));
      const double weight = lights.weights[l];
      for (size_t i = 0; i < kSix; ++i) {
        b[i] += weight * own[i] * seen.light[t * directions.size() + l];
        for (size_t j = 0; j < kSix; ++j) a[i][j] += weight * own[i] * own[j];
      }
    }
    const auto best = solved(a, b);
    for (size_t i = 0; i < kSix; ++i) maps[t * kSix + i] = inSteps(float(best[i]));
  });
  return maps;
}

}  // namespace cloudbake
