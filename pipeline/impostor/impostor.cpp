#include "pipeline/impostor/impostor.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "bake/lobe/sweep.h"
#include "bake/mesh/mesh_topology.h"
#include "core/lobe_lighting.h"
#include "core/memory_budget.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/decode.h"
#include "pipeline/fields/fields.h"
#include "pipeline/lobes/lobes.h"
#include "pipeline/lobes/parameters.h"
#include "pipeline/sources/sculpt.h"
#include "preview/mesh_clouds/impostor.h"
#include "preview/mesh_clouds/mesh_clouds.h"
#include "preview/mesh_clouds/render.h"

namespace cloudbake {

namespace {

constexpr int kDirections = 60;        // of light, beside the zenith
constexpr size_t kShapeTexels = 512;   // for the search of k and b
constexpr size_t kMostTexels = 40000;  // that are fitted together, so that their light does not fill the memory
constexpr float kThickest = 24;        // optical depths: more of them are as dark

// The frames in groups, so that the texels of a group are not many.
template <class Use>
void forGroups(const ImpostorInfo& info, const Use& use) {
  const int all = info.views * info.views;
  const int together = std::clamp(int(kMostTexels / (size_t(info.frame) * size_t(info.frame) / 3 + 1)), 1, all);
  for (int first = 0; first < all; first += together) use(first, std::min(together, all - first));
}

// A few frames from all sides, for the search of k and b.
std::vector<float> lightOfSomeFrames(const ImpostorInfo& info, const auto& seenAt) {
  std::vector<float> light;
  const int all = info.views * info.views, step = std::max(1, all / 7);
  for (int frame = step / 2; frame < all; frame += step) {
    const SeenTexels seen = seenAt(frame, 1);
    light.insert(light.end(), seen.light.begin(), seen.light.end());
  }
  return light;
}

void storeSixWay(const SeenTexels& seen, std::span<const float> maps, SixWayMaps& six_way) {
  const auto byte = [](float value) { return uint8_t(std::lround(255 * std::clamp(value, 0.0F, 1.0F))); };
  for (size_t t = 0; t < seen.texels.size(); ++t) {
    const auto own = maps.subspan(6 * t, 6);  // +x, +y, +z (towards the eye: the front), −x, −y, −z
    const size_t at = 4 * size_t(seen.texels[t]);
    const std::array<uint8_t, 4> first{byte(own[0]), byte(own[1]), byte(own[5]), byte(seen.opacity[t])},
        second{byte(own[3]), byte(own[4]), byte(own[2]), 0};
    std::copy(first.begin(), first.end(), six_way.first.begin() + ptrdiff_t(at));
    std::copy(second.begin(), second.end(), six_way.second.begin() + ptrdiff_t(at));
  }
}

TexelError errorOfSixWay(const SeenTexels& seen, std::span<const float> maps, const ImpostorInfo& info, const ImpostorLights& lights) {
  const std::vector<Vec3> directions = bothSenses(lights.axes);
  const size_t row = size_t(info.views) * size_t(info.frame);
  TexelError error;
  for (size_t t = 0; t < seen.texels.size(); ++t) {
    const size_t x = seen.texels[t] % row, y = seen.texels[t] / row;
    const FrameAxes axes = frameAxes(frameDirection(int(x) / info.frame, int(y) / info.frame, info.views));
    for (size_t l = 0; l < directions.size(); ++l) {
      const Vec3 d = directions[l], in_view{dot(axes.right, d), dot(axes.up, d), dot(axes.to_eye, d)};
      const double difference = sixWayLight(maps.subspan(6 * t, 6), in_view) - seen.light[t * directions.size() + l];
      const double weight = double(seen.opacity[t]) * double(lights.weights[l]);
      error.squares += weight * difference * difference;
      error.weight += weight;
    }
  }
  return error;
}

// The lobes as a reader has them.
std::vector<Lobe> storedLobes(const SeenTexels& seen, const Impostor& impostor) {
  std::vector<Lobe> lobes;
  for (const uint32_t texel : seen.texels)
    lobes.push_back(lobeOfTexel(impostor.direction[0].pixels[texel], impostor.rest[0].pixels[texel].x, impostor.info.thickest));
  return lobes;
}

void add(TexelError& all, const TexelError& more) { all.squares += more.squares, all.weight += more.weight; }

}  // namespace

BakedImpostor bakeImpostor(const Settings& settings, BakeReport& report, Stopwatch& watch) {
  const std::filesystem::path& file = settings.source.input;
  report.input = file.string();
  const std::string bytes = readFileBytes(file);
  if (isImpostor(bytes)) throw InputError(file.string(), "is an impostor already: give the baked asset that it was made of");
  Warnings told_by_sculpt;
  const BakedMesh mesh = decodeGlb(file, bytes, told_by_sculpt, settings.source.read);
  const Cloud cloud = readSculpt(settings, report, watch);
  if (!cloud.solid() && settings.impostor.of == ImpostorOf::kVolume)
    throw InputError(file.string(),
                     "the mesh encloses nothing, so that there is no volume to see: close it (bake --close wrap), or use --of mesh");
  report.vertices = cloud.surface.positions.size();
  report.triangles = cloud.surface.triangles.size();
  report.info = mesh.info;

  const BakeParameters parameters = parametersFor(cloud, settings);
  ImpostorInfo info;
  info.views = settings.impostor.views;
  info.frame = settings.impostor.frame;
  info.of = settings.impostor.of;
  info.extinction = worldExtinction({&mesh, {}}, {});
  info.box = boundingBox(cloud.surface);
  info.gains = info.of == ImpostorOf::kVolume || mesh.info.volume;
  info.input_hash = hashBytes(bytes);
  std::tie(info.center, info.radius) = ballAround(mesh.surface.positions);
  info.radius *= 1 + 3 / float(info.frame);  // the outermost texels stay empty, for filters
  const LightSet set = fitLights(std::nullopt, true, kDirections);
  const ImpostorLights lights{set.axes, set.weights};
  const size_t texels = size_t(info.views) * size_t(info.frame) * size_t(info.views) * size_t(info.frame);
  requireMemory({fmt::format("an atlas of {} × {} frames of {} pixels", info.views, info.views, info.frame),
                 double(texels) * (3.0 * sizeof(Vec3) + 16), "use fewer --views or a smaller --frame"},
                settings.source.memory_limit);

  std::optional<IntegrationField> field;
  std::function<SeenTexels(int, int)> seenAt;
  LobeShape start{2, 0.25F / info.extinction};
  if (info.of == ImpostorOf::kVolume) {
    field = buildField(cloud, settings.field, Method::kSweep, report.warnings);
    const VolumeLight light = settings.lobe.volume.over(mesh.info.volume.value_or(VolumeLight{}));
    seenAt = [&, light](int first, int count) {
      return seenOfVolume(info, first, count, {field->swept(), light, *parameters.bake.ray_length}, set.axes);
    };
  } else {
    start = mesh.info.shape;
    seenAt = [&](int first, int count) { return seenOfMesh(info, first, count, {mesh, settings.impostor.half_lambert}, set.axes); };
  }
  watch.lap(report.seconds, "field");

  const std::vector<float> some = lightOfSomeFrames(info, seenAt);
  if (some.empty()) throw InputError(file.string(), "nothing of the cloud is seen: is it smaller than a texel?");
  info.shape = fitTexelShape(some, lights, start, info.extinction, kShapeTexels);
  float thickest = 0;
  for (const Lobe& lobe : fitTexels(some, lights, info.shape, info.extinction)) thickest = std::max(thickest, lobe.thickness);
  info.thickest = std::min(thickest, kThickest / info.extinction);
  watch.lap(report.seconds, "shape");

  BakedImpostor baked{blankImpostor(info), {}, {}};
  const int size = info.views * info.frame;
  if (settings.impostor.six_way) baked.six_way = SixWayMaps{std::vector<uint8_t>(4 * texels), std::vector<uint8_t>(4 * texels), size};
  TexelError fitted, stored, six_way;
  forGroups(info, [&](int first, int count) {
    const SeenTexels seen = seenAt(first, count);
    const std::vector<Lobe> lobes = fitTexels(seen.light, lights, info.shape, info.extinction);
    storeTexels(seen, lobes, baked.impostor);
    baked.figures.texels += seen.texels.size();
    add(fitted, errorOfTexels(seen, lobes, lights, info.shape, info.extinction));
    add(stored, errorOfTexels(seen, storedLobes(seen, baked.impostor), lights, info.shape, info.extinction));
    const std::vector<float> maps = fitSixWay(seen, info, lights);
    add(six_way, errorOfSixWay(seen, maps, info, lights));
    if (baked.six_way) storeSixWay(seen, maps, *baked.six_way);
  });
  fillEmptyTexels(baked.impostor);
  addMipLevels(baked.impostor);
  baked.figures.fitted = fitted.rms(), baked.figures.stored = stored.rms(), baked.figures.six_way = six_way.rms();
  watch.lap(report.seconds, "texels");
  return baked;
}

Billboard billboardOf(const Impostor& impostor) {
  constexpr int kSize = 256;
  const ImpostorInfo& info = impostor.info;
  const LightSettings light = lightFor({}, 105, 30);
  const SkyColors colors = lightColors(light.sky);
  Billboard billboard{kSize, std::vector<uint8_t>(4 * size_t(kSize) * kSize)};
  // From so far away that the rays are nearly parallel.
  const Vec3 eye = info.center + Vec3{0, 0, 100 * info.radius};
  const ImpostorView view(impostor, eye);
  const float gain = info.gains ? light.volume_gain : 1;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const auto place = [&](int pixel) { return (2 * (float(pixel) + 0.5F) / kSize - 1) * info.radius; };
      const Vec3 at = info.center + Vec3{place(x), -place(y), 0};
      const ImpostorPoint seen = view.at((at - eye) / length(at - eye), float(info.frame) / kSize);
      const auto transmittance = [&](Vec3 to_light) { return lobeTransmittance(seen.lobe, to_light, info.shape, info.extinction); };
      Image pixel = blankImage(1, 1);
      if (seen.opacity > 0)
        pixel.pixels[0] = cloudColor({std::min(1.0F, gain * transmittance(light.sky.to_sun)), transmittance({0, 1, 0})}, colors);
      const Vec3 shown = toneMap(pixel).pixels[0];
      const auto byte = [](float value) { return uint8_t(std::lround(255 * std::clamp(value, 0.0F, 1.0F))); };
      const std::array<uint8_t, 4> rgba{byte(shown.x), byte(shown.y), byte(shown.z), byte(seen.opacity)};
      std::copy(rgba.begin(), rgba.end(), billboard.rgba.begin() + 4 * (ptrdiff_t(y) * kSize + x));
    }
  return billboard;
}

std::string impostorText(const BakedImpostor& baked) {
  const ImpostorInfo& info = baked.impostor.info;
  const int size = info.views * info.frame;
  return fmt::format(
      "impostor    {} x {} views, frames of {} pixels: {} x {} pixels, of the {}\n"
      "lobe        k {:.3g}, b {:.6g}, extinction {:.6g}\n"
      "light       rms {:.4f} of fitted lobes, {:.4f} as stored; {:.4f} of six-way maps\n",
      info.views, info.views, info.frame, size, size, info.of == ImpostorOf::kMesh ? "mesh" : "volume", info.shape.exponent,
      info.shape.bias, info.extinction, baked.figures.fitted, baked.figures.stored, baked.figures.six_way);
}

Json impostorJson(const BakedImpostor& baked) {
  const ImpostorInfo& info = baked.impostor.info;
  return {{"views", info.views},
          {"frame", info.frame},
          {"of", info.of == ImpostorOf::kMesh ? "mesh" : "volume"},
          {"exponent", shortest(info.shape.exponent)},
          {"bias", shortest(info.shape.bias)},
          {"extinction", shortest(info.extinction)},
          {"texels", baked.figures.texels},
          {"rms_fitted", baked.figures.fitted},
          {"rms_stored", baked.figures.stored},
          {"rms_six_way", baked.figures.six_way}};
}

}  // namespace cloudbake
