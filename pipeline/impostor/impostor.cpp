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

constexpr int kDirections = 30, kJudgingDirections = 64;  // of light, beside the zenith
constexpr int kNodes = 2, kJudgingNodes = 4;
constexpr int kJudgedFrames = 8;
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

// A frame that is looked at more closely.
struct Sample {
  int frame = 0;
  SeenTexels seen;
  std::vector<TexelLobe> lobes;
};

// Frames from all sides.
std::vector<int> someFrames(const ImpostorInfo& info, int count) {
  const int all = info.views * info.views;
  std::vector<int> frames;
  for (int i = 0; i < count; ++i) frames.push_back((2 * i + 1) * all / (2 * count));
  return frames;
}

}  // namespace

ImpostorSubject readImpostorSubject(const Settings& settings, BakeReport& report, Stopwatch& watch) {
  const std::filesystem::path& file = settings.source.input;
  report.input = file.string();
  const std::string bytes = readFileBytes(file);
  Warnings told_by_sculpt;
  ImpostorSubject subject{decodeGlb(file, bytes, told_by_sculpt, settings.source.read), {}, hashBytes(bytes)};
  subject.cloud = readSculpt(settings, report, watch);
  report.vertices = subject.cloud.surface.positions.size();
  report.triangles = subject.cloud.surface.triangles.size();
  report.info = subject.mesh.info;
  return subject;
}

BakedImpostor bakeImpostor(const ImpostorSubject& subject, const Settings& settings, BakeReport& report, Stopwatch& watch) {
  const auto& [mesh, cloud, hash] = subject;
  const std::string file = settings.source.input.string();
  if (!cloud.solid() && settings.impostor.of == ImpostorOf::kVolume)
    throw InputError(file, "the mesh encloses nothing, so that there is no volume to see: close it (bake --close wrap), or use --of mesh");
  ImpostorInfo info;
  info.views = settings.impostor.views;
  info.frame = settings.impostor.frame;
  info.of = settings.impostor.of;
  info.extinction = worldExtinction({&mesh, {}}, {});
  info.box = boundingBox(cloud.surface);
  info.gains = info.of == ImpostorOf::kVolume || mesh.info.volume;
  info.input_hash = hash;
  std::tie(info.center, info.radius) = ballAround(mesh.surface.positions);
  info.radius *= 1 + 3 / float(info.frame);  // the outermost texels stay empty, for filters
  const size_t texels = size_t(info.views) * size_t(info.frame) * size_t(info.views) * size_t(info.frame);
  requireMemory({fmt::format("an atlas of {} × {} frames of {} pixels", info.views, info.views, info.frame),
                 double(texels) * (3.0 * sizeof(Vec3) + 16), "use fewer --views or a smaller --frame"},
                settings.source.memory_limit);

  std::optional<IntegrationField> field;
  std::optional<MeshFrames> mesh_frames;
  std::function<SeenTexels(int first, int count, std::span<const Vec3> axes, int nodes)> seenAt;
  if (info.of == ImpostorOf::kVolume) {
    const BakeParameters parameters = parametersFor(cloud, settings);
    field = buildField(cloud, settings.field, Method::kSweep, report.warnings);
    seenAt = [&info, &swept = field->swept(), light = settings.lobe.volume.over(mesh.info.volume.value_or(VolumeLight{})),
              ray_length = *parameters.bake.ray_length](int first, int count, std::span<const Vec3> axes, int nodes) {
      return seenOfVolume(info, first, count, {swept, light, ray_length, nodes}, axes);
    };
  } else {
    mesh_frames.emplace(mesh, settings.impostor.half_lambert, info);
    seenAt = [&](int first, int count, std::span<const Vec3> axes, int) { return seenOfMesh(info, first, count, *mesh_frames, axes); };
  }
  watch.lap(report.seconds, "field");

  // Some frames show k and how thick the cloud is.
  const LightSet set = fitLights(std::nullopt, true, kDirections);
  const ImpostorLights lights{set.axes, set.weights};
  std::vector<Sample> samples;
  std::vector<float> light;
  for (const int frame : someFrames(info, kJudgedFrames)) {
    samples.push_back({frame, seenAt(frame, 1, set.axes, kNodes), {}});
    const std::vector<float>& own = samples.back().seen.light;
    light.insert(light.end(), own.begin(), own.end());
  }
  if (light.empty()) throw InputError(file, "nothing of the cloud is seen: is it smaller than a texel?");
  info.exponent = fitTexelExponent(light, lights, 2, info.extinction, kShapeTexels);
  float thickest = 0;
  for (Sample& sample : samples) {
    sample.lobes = fitTexels(sample.seen.light, lights, info.exponent, info.extinction);
    for (const TexelLobe& texel : sample.lobes) thickest = std::max(thickest, texel.lobe.thickness);
  }
  info.thickest = std::min(thickest, kThickest / info.extinction);
  watch.lap(report.seconds, "shape");

  BakedImpostor baked{blankImpostor(info), {}, {}};
  const int size = info.views * info.frame;
  if (settings.impostor.six_way) baked.six_way = SixWayMaps{std::vector<uint8_t>(4 * texels), std::vector<uint8_t>(4 * texels), size};
  forGroups(info, [&](int first, int count) {
    const SeenTexels seen = seenAt(first, count, set.axes, kNodes);
    storeTexels(seen, fitTexels(seen.light, lights, info.exponent, info.extinction), baked.impostor);
    baked.figures.texels += seen.texels.size();
    if (baked.six_way) storeSixWay(seen, fitSixWay(seen, info, lights), *baked.six_way);
  });
  watch.lap(report.seconds, "texels");

  // Other lights than those of the fit, in the same frames.
  const LightSet judging = fitLights(std::nullopt, true, kJudgingDirections);
  const ImpostorLights judges{judging.axes, judging.weights};
  const std::vector<Vec3> directions = bothSenses(judging.axes);
  TexelError fitted, stored, six_way;
  for (const Sample& sample : samples) {
    const SeenTexels judged = seenAt(sample.frame, 1, judging.axes, kJudgingNodes);
    const std::vector<float> maps = fitSixWay(sample.seen, info, lights);
    const auto lightOf = [&](const TexelLobe& texel, size_t l) { return texelLight(texel, directions[l], info.exponent, info.extinction); };
    addTexelError(judged, judges, fitted, [&](size_t t, size_t l) { return lightOf(sample.lobes[t], l); });
    addTexelError(judged, judges, stored, [&](size_t t, size_t l) { return lightOf(storedTexel(baked.impostor, judged.texels[t]), l); });
    addTexelError(judged, judges, six_way, [&](size_t t, size_t l) {
      return sixWayLight(std::span(maps).subspan(6 * t, 6), inView(axesOfTexel(info, judged.texels[t]), directions[l]));
    });
  }
  fillEmptyTexels(baked.impostor);
  addMipLevels(baked.impostor);
  baked.figures.fitted = fitted.rms(), baked.figures.stored = stored.rms(), baked.figures.six_way = six_way.rms();
  watch.lap(report.seconds, "judge");
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
  const auto place = [&](int pixel) { return (2 * (float(pixel) + 0.5F) / kSize - 1) * info.radius; };
  const auto byte = [](float value) { return uint8_t(std::lround(255 * std::clamp(value, 0.0F, 1.0F))); };
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const Vec3 at = info.center + Vec3{place(x), -place(y), 0};
      const ImpostorPoint seen = view.at((at - eye) / length(at - eye), float(info.frame) / kSize);
      const auto lightFrom = [&](Vec3 to_light) { return texelLight(seen.texel, to_light, info.exponent, info.extinction); };
      Vec3 color;
      if (seen.opacity > 0) color = cloudColor({std::min(1.0F, gain * lightFrom(light.sky.to_sun)), lightFrom({0, 1, 0})}, colors);
      toneRow({&color, 1});
      const std::array<uint8_t, 4> rgba{byte(color.x), byte(color.y), byte(color.z), byte(seen.opacity)};
      std::copy(rgba.begin(), rgba.end(), billboard.rgba.begin() + 4 * (ptrdiff_t(y) * kSize + x));
    }
  return billboard;
}

std::string impostorText(const BakedImpostor& baked) {
  const ImpostorInfo& info = baked.impostor.info;
  const int size = info.views * info.frame;
  return fmt::format(
      "impostor    {} x {} views, frames of {} pixels: {} x {} pixels, of the {}\n"
      "lobe        k {:.3g}, extinction {:.6g}\n"
      "light       rms {:.4f} of fitted lobes, {:.4f} as stored; {:.4f} of six-way maps\n",
      info.views, info.views, info.frame, size, size, info.of == ImpostorOf::kMesh ? "mesh" : "volume", info.exponent, info.extinction,
      baked.figures.fitted, baked.figures.stored, baked.figures.six_way);
}

Json impostorJson(const BakedImpostor& baked) {
  const ImpostorInfo& info = baked.impostor.info;
  return {{"views", info.views},
          {"frame", info.frame},
          {"of", info.of == ImpostorOf::kMesh ? "mesh" : "volume"},
          {"exponent", shortest(info.exponent)},
          {"extinction", shortest(info.extinction)},
          {"texels", baked.figures.texels},
          {"rms_fitted", baked.figures.fitted},
          {"rms_stored", baked.figures.stored},
          {"rms_six_way", baked.figures.six_way}};
}

}  // namespace cloudbake
