#include "pipeline/impostor/picture_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "bake/impostor/bake_impostor.h"
#include "bake/lobe/sweep.h"
#include "bake/mesh/mesh_topology.h"
#include "core/parallel.h"
#include "core/portable_math.h"
#include "pipeline/fields/fields.h"
#include "preview/compare/image_error.h"
#include "preview/compare/volume.h"
#include "preview/mesh_clouds/impostor.h"
#include "preview/mesh_clouds/render.h"

namespace cloudbake {

namespace {

constexpr int kViews = 60, kSuns = 24, kSunsPerView = 2, kTurns = 24;
constexpr std::array<int, 5> kSizes{200, 128, 64, 32, 16};
constexpr int kFinest = 256;  // pixels of the pictures whose means are those of smaller sizes
constexpr float kFieldOfView = 3;

// A camera so far away that the ball covers the picture.
Camera cameraFrom(const ImpostorInfo& info, Vec3 to_eye, int pixels) {
  const float distance = info.radius / float(tanDegrees(kFieldOfView / 2));
  Camera camera{info.center + to_eye * distance, info.center, kFieldOfView};
  camera.width = camera.height = pixels;
  return camera;
}

// The mean over the places of larger pixels.
Image resized(const Image& image, int pixels) {
  if (image.width == pixels) return image;
  Image small = blankImage(pixels, pixels);
  const double scale = double(image.width) / pixels;
  const auto share = [&](int from, int to) {  // of the pixel `from` that is in the pixel `to`
    return std::max(0.0, std::min((to + 1) * scale, from + 1.0) - std::max(to * scale, double(from))) / scale;
  };
  for (int y = 0; y < pixels; ++y)
    for (int x = 0; x < pixels; ++x)
      for (int v = int(y * scale); v < image.height && v < (y + 1) * scale; ++v)
        for (int u = int(x * scale); u < image.width && u < (x + 1) * scale; ++u)
          small.at(x, y) += image.at(u, v) * float(share(u, x) * share(v, y));
  return small;
}

// The six maps of an atlas, with mip levels.
struct SixWayAtlas {
  Impostor impostor;  // for opacity and depth
  std::vector<Image> positive, negative;
};

// Six maps, opacity and depth are 8 bytes of a texel; those of an impostor are 6. So frames of the same bytes are smaller. Both atlases
// have the same texels without a cloud filled from their neighbours.
SixWayAtlas sixWayAtlas(const ImpostorSubject& subject, const Settings& settings) {
  Settings of_six = settings;
  of_six.impostor.six_way = true;
  of_six.impostor.frame = std::max(2 * kLeastFrame, int(std::lround(settings.impostor.frame * std::sqrt(6.0 / 8))));
  BakeReport told_to_nobody;
  Stopwatch watch;
  BakedImpostor baked = bakeImpostor(subject, of_six, told_to_nobody, watch);
  const auto mapsOf = [&](const std::vector<uint8_t>& bytes, std::array<size_t, 3> channels) {
    Impostor one = baked.impostor;
    for (size_t i = 0; i < one.lobe[0].pixels.size(); ++i)
      one.lobe[0].pixels[i] =
          Vec3{float(bytes[4 * i + channels[0]]), float(bytes[4 * i + channels[1]]), float(bytes[4 * i + channels[2]])} / 255;
    fillEmptyTexels(one);
    addMipLevels(one);
    return one.lobe;
  };
  SixWayMaps& maps = *baked.six_way;
  for (size_t i = 2; i < maps.first.size(); i += 4) std::swap(maps.first[i], maps.second[i]);  // back and front
  return {baked.impostor, mapsOf(maps.first, {0, 1, 2}), mapsOf(maps.second, {0, 1, 2})};
}

Image drawnSixWay(const SixWayAtlas& atlas, const Camera& camera, const LightSettings& light) {
  const ImpostorView view(atlas.impostor, camera.look_from);
  const float share = float(atlas.impostor.info.frame) / float(camera.height);
  const Vec3 sun = keyLight(light.sky).direction;
  return renderQuad(camera, light, [&](Vec3 direction) -> QuadPoint {
    Shade sum;
    float opacity = 0;
    view.forFrames(direction, share, [&](const AtlasPlace& place) {
      const Vec3 positive = filtered(atlas.positive, place.u, place.v, place.level),
                 negative = filtered(atlas.negative, place.u, place.v, place.level);
      const std::array<float, 6> maps{positive.x, positive.y, positive.z, negative.x, negative.y, negative.z};
      const auto from = [&](Vec3 l) { return sixWayLight(maps, inView(place.axes, l)); };
      sum.sun += place.weight * from(sun), sum.sky += place.weight * from({0, 1, 0});
      opacity += place.weight;
    });
    if (!(opacity > 0)) return {{}, 0};
    return {{sum.sun / opacity, sum.sky / opacity}, opacity};
  });
}

void addTo(PixelMask& mask, const PixelMask& more) {
  for (size_t i = 0; i < mask.size(); ++i) mask[i] |= more[i];
}

// The rms over all pixels of many pictures that count.
struct Sum {
  double squares = 0;
  size_t count = 0;
  void add(const Image& a, const Image& b, const PixelMask& mask) {
    const double rms = 255 * imageRms(a, b, mask);
    const auto own = size_t(std::ranges::count(mask, 1));
    squares += rms * rms * double(own);
    count += own;
  }
  double rms() const { return std::sqrt(squares / double(std::max<size_t>(1, count))); }
};

}  // namespace

std::vector<SizeFigures> pictureFigures(const ImpostorSubject& subject, const Settings& settings, const BakedImpostor& baked,
                                        BakeReport& report) {
  const ImpostorInfo& info = baked.impostor.info;
  const auto& [mesh, cloud, hash] = subject;
  FieldSettings fine = settings.field;
  fine.bake_voxels = 128;
  const IntegrationField field = buildField(cloud, fine, Method::kSweep, report.warnings);
  const std::vector<Vec3> cells = cellCenters(*field.coverage);
  const float ray_length = boundingBox(cloud.surface).diagonal();
  const auto lengthsTo = [&](Vec3 direction) {
    std::vector<float> lengths = sweptLengths(cells, {&direction, 1}, field.swept(), ray_length);
    lengths.resize(cells.size());
    return lengths;
  };
  const std::vector<float> to_sky = lengthsTo({0, 1, 0});
  VolumeSettings volume_settings;
  volume_settings.extinction = info.extinction;
  volume_settings.light = settings.lobe.volume.over(mesh.info.volume.value_or(VolumeLight{}));

  const SixWayAtlas six_way = sixWayAtlas(subject, settings);

  std::vector<SizeFigures> figures;
  std::array<std::array<Sum, 5>, kSizes.size()> sums;
  for (int s = 0; s < kSuns; ++s) {
    const std::vector<Vec3> axes = sweepAxes(2 * kSuns);
    const Vec3 to_sun = axes[size_t(s)].y < 0 ? -axes[size_t(s)] : axes[size_t(s)];
    LightSettings light = lightForSun(float(atan2Degrees(to_sun.x, to_sun.z)),
                                      float(atan2Degrees(to_sun.y, std::sqrt(to_sun.x * to_sun.x + to_sun.z * to_sun.z))));
    light.samples_per_side = 1;
    light.half_lambert = 1;
    light.view_extinction = 0;
    const std::vector<float> to_light = lengthsTo(keyLight(light.sky).direction);
    const Volume volume{&*field.coverage, to_light, to_sky};
    const std::vector<Vec3> views = bothSenses(sweepAxes(kViews));
    for (int v = s % (kSuns / kSunsPerView); v < kViews; v += kSuns / kSunsPerView) {
      const Vec3 to_eye = views[size_t(v)];
      const Camera finest = cameraFrom(info, to_eye, kFinest);
      const Image of_volume = renderVolume(volume, finest, light, volume_settings), of_mesh = renderLobe(mesh, finest, light);
      LightSettings soft = light;
      soft.view_extinction = volume_settings.light.view_extinction;
      soft.first_surface = true;
      const Image of_soft = renderLobe(mesh, finest, soft), sky = renderSky(finest, light.sky, 1);
      for (size_t size = 0; size < kSizes.size(); ++size) {
        const Camera camera = cameraFrom(info, to_eye, kSizes[size]);
        const auto shownAt = [&](const Image& image) { return toneMap(resized(image, kSizes[size])); };
        const Image truth = shownAt(of_volume), opaque = shownAt(of_mesh), gentle = shownAt(of_soft),
                    quad = toneMap(renderImpostor(baked.impostor, camera, light)), six = toneMap(drawnSixWay(six_way, camera, light));
        PixelMask shows = cloudMask(truth, opaque, shownAt(sky));
        addTo(shows, cloudMask(quad, quad, shownAt(sky)));
        sums[size][0].add(quad, truth, shows), sums[size][1].add(six, truth, shows), sums[size][2].add(opaque, truth, shows);
        sums[size][3].add(gentle, truth, shows), sums[size][4].add(quad, opaque, shows);
      }
    }
  }
  // Swimming: the change from one degree of a turn to the next.
  LightSettings light = lightForSun(105, 30);
  light.samples_per_side = 1;
  light.half_lambert = 1;
  light.view_extinction = 0;
  for (size_t size = 0; size < kSizes.size(); ++size) {
    Sum of_impostor, of_mesh;
    for (int turn = 0; turn < kTurns; ++turn) {
      std::array<Image, 2> quads, meshes;
      Image sky;
      for (int next = 0; next < 2; ++next) {
        const Vec3 to_eye = directionFromAngles(360 * float(turn) / kTurns + float(next), 12);
        const Camera camera = cameraFrom(info, to_eye, kSizes[size]), finest = cameraFrom(info, to_eye, kFinest);
        quads[size_t(next)] = toneMap(renderImpostor(baked.impostor, camera, light));
        meshes[size_t(next)] = toneMap(resized(renderLobe(mesh, finest, light), kSizes[size]));
        sky = toneMap(renderSky(camera, light.sky, 1));
      }
      const PixelMask shows = cloudMask(quads[0], meshes[0], sky);
      of_impostor.add(quads[0], quads[1], shows), of_mesh.add(meshes[0], meshes[1], shows);
    }
    const auto& all = sums[size];
    figures.push_back(
        {kSizes[size], all[0].rms(), all[1].rms(), all[2].rms(), all[3].rms(), all[4].rms(), of_impostor.rms(), of_mesh.rms()});
  }
  return figures;
}

std::string pictureFiguresText(const std::vector<SizeFigures>& figures) {
  std::string text =
      "pictures    rms of 8-bit values against the volume, and of the impostor against the mesh and one degree on\n"
      "  pixels  impostor  six-way    mesh  soft mesh   to mesh  next degree (mesh)\n";
  for (const SizeFigures& f : figures)
    text += fmt::format("  {:6}  {:8.2f}  {:7.2f}  {:6.2f}  {:9.2f}  {:8.2f}  {:11.2f} ({:.2f})\n", f.pixels, f.impostor, f.six_way, f.mesh,
                        f.soft_mesh, f.impostor_to_mesh, f.next_frame, f.mesh_next_frame);
  return text;
}

Json pictureFiguresJson(const std::vector<SizeFigures>& figures) {
  Json json = Json::array();
  for (const SizeFigures& f : figures)
    json.push_back({{"pixels", f.pixels},
                    {"impostor", f.impostor},
                    {"six_way", f.six_way},
                    {"mesh", f.mesh},
                    {"soft_mesh", f.soft_mesh},
                    {"impostor_to_mesh", f.impostor_to_mesh},
                    {"next_degree", f.next_frame},
                    {"mesh_next_degree", f.mesh_next_frame}});
  return json;
}

}  // namespace cloudbake
