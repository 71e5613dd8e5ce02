// cloudbake preview ASSET.glb -o out.png: what an engine shows with the four floats and the lobe formula; of a scene, in motion, or beside
// the truth.
#include <algorithm>
#include <cmath>

#include "pipeline/sources/grown.h"
#include "app/commands.h"
#include "pipeline/picture/compare.h"
#include "io/report/figure_lines.h"
#include "pipeline/asset.h"
#include "pipeline/picture/scene_picture.h"
#include "io/image/animated_png.h"
#include "io/image/exr.h"
#include "io/gltf/gltf.h"
#include "io/image/image.h"
#include "core/text/scan.h"
#include "io/file/write_file.h"
#include "preview/mesh_clouds/render.h"

#include <fmt/format.h>

namespace cloudbake {

namespace {

using Motion = ViewSettings::Motion;

struct NamedFile {
  std::filesystem::path file;
  std::string bytes;
};

// --- What is drawn ---

// Grown and baked as `grow` does it.
BakedMesh grownMesh(const SceneCloud& cloud, Warnings& warnings) {
  const auto apply = [&cloud](Settings& settings) {
    settings.bake.seed = cloud.seed;
    settings.vertices = cloud.vertices;
    settings.fit = cloud.fit;
  };
  Settings settings;
  settings.input = cloud.preset;
  apply(settings);
  BakeReport report;
  report.command = "grow";
  Stopwatch watch;
  const Scene scene = growScene(settings, apply, report, watch);
  resolveInfo(settings, scene, report, watch);
  const EncodedAsset asset = encodeAsset(scene, settings, report, watch);
  for (const auto& [kind, entry] : report.warnings.entries()) warnings.add(kind, cloud.preset + ": " + entry.first, entry.count);
  return decodeGlb(cloud.preset, asset.glb, warnings);
}

const BakedMesh& meshOf(const SceneCloud& cloud, Scenery& scenery, Warnings& warnings) {
  const std::string key = !cloud.file.empty() ? cloud.file.string()
                                              : cloud.preset + " " + std::to_string(cloud.seed) + " " + std::to_string(cloud.vertices) +
                                                    (cloud.fit ? " fit" : " mean");
  const auto [found, is_new] = scenery.meshes.try_emplace(key);
  if (is_new && !cloud.file.empty()) found->second = decodeGlb(cloud.file, readFileBytes(cloud.file), warnings);
  if (is_new && cloud.file.empty()) found->second = grownMesh(cloud, warnings);
  return found->second;
}

Scenery readScenery(Settings& settings, const ApplyCommandLine& apply_command_line, BakeReport& report) {
  Scenery scenery;
  SceneFile& scene = scenery.scene;
  if (settings.scene) {
    scene = readSceneFile(*settings.scene, readFileBytes(*settings.scene), settings, apply_command_line);
    if (settings.view.draft) makeDraft(scene);
    for (const SceneCloud& cloud : scene.clouds) scenery.instances.push_back({&meshOf(cloud, scenery, report.warnings), cloud.to_world});
  } else {
    SceneCloud asset;
    asset.file = settings.input;
    scenery.instances.push_back({&meshOf(asset, scenery, report.warnings), {}});
    scene.light = lightForSun(settings.view.sun_azimuth_degrees, settings.view.sun_elevation_degrees);
  }
  scene.light.lobes_only = scene.light.lobes_only || settings.view.lobes_only;
  if (!scenery.instances.empty()) report.info = scenery.instances.front().mesh->info;
  for (const Instance& instance : scenery.instances) {
    report.vertices += instance.mesh->surface.positions.size();
    report.triangles += instance.mesh->surface.triangles.size();
  }
  return scenery;
}

// --- One picture ---

// Seconds per renderer, of a picture or of all frames.
using RendererSeconds = std::vector<std::pair<std::string, double>>;

Json secondsJson(const RendererSeconds& seconds) {
  Json json = Json::object();
  for (const auto& [name, sum] : seconds) json[name] = sum;
  return json;
}

std::string secondsText(const RendererSeconds& seconds) {
  std::string text;
  for (const auto& [name, sum] : seconds) text += figureLine("of render", "{:8.3f} s {}", sum, name);
  return seconds.size() > 1 ? text : "";
}

// What --channels and --steps ask for beside the picture.
std::vector<NamedFile> extraPictures(const MeshCloudSteps& steps, const Scenery& scenery, const ViewSettings& view) {
  std::vector<NamedFile> files;
  if ((view.channels || view.steps) && steps.drawn.pixels.empty())
    throw UsageError("--channels and --steps show mesh clouds, and there are none in the scene: leave them out");
  const auto add = [&](const std::filesystem::path& stem, const std::string& name, const Image& image) {
    files.push_back({stem.string() + "_" + name + ".png", encodePng(image)});
  };
  if (view.channels && lowerCase(view.channels->extension().string()) == ".exr")
    files.push_back({*view.channels, encodeExr(steps.drawn)});
  else if (view.channels)
    for (int channel = 0; const char* name : {"sun", "sky", "opacity", "depth"})
      add(*view.channels, name, channelPicture(steps.drawn, channel++));
  const std::pair<const char*, const Image4*> made[] = {{"1_drawn", &steps.drawn},
                                                        {"2_downsampled", &steps.downsampled},
                                                        {"3_blurred", &steps.blurred},
                                                        {"4_depth_blurred", &steps.depth_blurred},
                                                        {"5_distorted", &steps.distorted}};
  if (view.steps)
    for (const auto& [name, channels] : made)
      add(*view.steps, name,
          dithered(toneMap(composite(*channels, steps.background, scenery.scene.light.sky.colors, scenery.scene.post.composite),
                           view.exposure)));
  return files;
}

// `turn`: as of cameraFor. `extra`, where given, gets --channels and --steps.
std::string drawPicture(const Scenery& scenery, const LightSettings& light, const ViewSettings& view, float turn, RendererSeconds& seconds,
                        std::vector<NamedFile>* extra) {
  if (view.plain) {
    const Camera camera = cameraFor(scenery, view, turn);
    return encodePng(dithered(toneMap(renderLobe(*scenery.instances.front().mesh, camera, light), view.exposure)));
  }
  DrawnParts parts;
  const Image picture = drawScene(scenery, light, view, turn, parts);
  for (const auto& [name, more] : parts.seconds) addSeconds(seconds, name, more);
  if (extra) *extra = extraPictures(parts.steps, scenery, view);
  return encodePng(dithered(picture));
}

// --- Motion ---

// The day of a sun that culminates where `view` has it: from a little below the horizon, a quarter turn before, to as far after.
Vec3 sunOfDay(const ViewSettings& view, double share) {
  constexpr double kBelow = 6;  // degrees
  const double angle = (-kBelow + (180 + 2 * kBelow) * share) * kPi / 180;
  const Vec3 rise = directionFromAngles(view.sun_azimuth_degrees - 90, 0),
             noon = directionFromAngles(view.sun_azimuth_degrees, view.sun_elevation_degrees);
  return *normalized(rise * float(std::cos(angle)) + noon * float(std::sin(angle)));
}

std::vector<std::string> drawFrames(const Scenery& scenery, const ViewSettings& view, RendererSeconds& seconds) {
  std::vector<std::string> frames;
  for (int i = 0; i < view.frame_count; ++i) {
    const double share = double(i) / view.frame_count;
    LightSettings light = scenery.scene.light;
    ViewSettings moment = view;
    if (view.motion == Motion::kAnimate &&
        scenery.scene.post.distort.swirl_speed > 0)  // after half a cycle the two phases have changed places
      moment.time_seconds += share / (2 * double(scenery.scene.post.distort.swirl_speed));
    if (view.motion == Motion::kSunSweep) {
      light.sky.to_sun = sunOfDay(view, double(i) / std::max(1, view.frame_count - 1));
      light.sky.colors = skyColorsForSun(light.sky.to_sun.y);
    }
    frames.push_back(drawPicture(scenery, light, moment, view.motion == Motion::kTurntable ? float(360 * share) : 0, seconds, nullptr));
  }
  return frames;
}

std::vector<NamedFile> frameFiles(const std::vector<std::string>& frames, const std::filesystem::path& stem) {
  std::vector<NamedFile> files;
  for (size_t i = 0; i < frames.size(); ++i) files.push_back({stem.string() + fmt::format("_{:04}.png", i + 1), frames[i]});
  return files;
}

// --- The command ---

void checkTogether(const Settings& settings) {
  const ViewSettings& view = settings.view;
  const auto refuseIf = [](bool wrong, const char* why) {
    if (wrong) throw UsageError(why);
  };
  refuseIf(settings.scene && !settings.input.empty(), "an asset and --scene: give one of the two, the scene names its clouds");
  refuseIf(view.plain && (view.channels || view.steps || view.time_seconds > 0 || view.motion == Motion::kAnimate),
           "--channels, --steps, --time and --animate are of the painted look: leave out --look plain");
  refuseIf(view.plain && settings.scene, "--scene draws the painted look: leave out --look plain");
  const bool moves = view.motion != Motion::kNone;
  refuseIf(moves && (view.channels || view.steps), "--channels and --steps are of one picture: leave them out, or the motion");
  refuseIf(view.frames && !moves, "--frames needs --turntable, --sun-sweep or --animate");
  refuseIf(view.suns > 0 && !view.compare, "--suns needs --compare");
  refuseIf(view.compare && (settings.scene || moves || view.channels || view.steps),
           "--compare draws one asset, alone and still: leave out --scene, motion, --channels and --steps");
  if (moves && !hasAnimationEncoder())
    throw IoError(settings.output.string(), "an animated PNG needs apngasm, which is not installed: install the package apngasm");
}

ExitCode runComparison(const Settings& settings) {
  BakeReport report;
  report.command = "preview";
  Stopwatch watch;
  const Comparison comparison = compareAsset(settings, report, watch);
  const std::string png = encodePng(comparison.sheet);
  enforceStrict(settings, report);
  writeFileAtomically(settings.output, png);
  report.output = settings.output.string();
  watch.lap(report, "write");
  tellReport(settings, report, "comparison", comparisonJson(comparison), comparisonText(comparison));
  return ExitCode::kDone;
}

}  // namespace

ExitCode runPreview(Settings settings, const ApplyCommandLine& apply_command_line) {
  apply_command_line(settings);
  checkTogether(settings);
  if (settings.view.compare) return runComparison(settings);
  BakeReport report;
  report.command = "preview";
  report.input = (settings.scene ? *settings.scene : settings.input).string();
  Stopwatch watch;
  const Scenery scenery = readScenery(settings, apply_command_line, report);
  watch.lap(report, "read");

  const ViewSettings& view = settings.view;
  std::vector<NamedFile> files;
  RendererSeconds seconds;
  std::string png;
  if (view.motion == Motion::kNone) {
    png = drawPicture(scenery, scenery.scene.light, view, 0, seconds, &files);
    watch.lap(report, "render");
  } else {
    const std::vector<std::string> frames = drawFrames(scenery, view, seconds);
    watch.lap(report, "render");
    png = encodeAnimation(frames, view.frames_per_second);
    if (view.frames) files = frameFiles(frames, *view.frames);
    watch.lap(report, "encode");
  }
  enforceStrict(settings, report);
  for (const NamedFile& file : files) writeFileAtomically(file.file, file.bytes);
  writeFileAtomically(settings.output, png);
  report.output = settings.output.string();
  watch.lap(report, "write");
  tellReport(settings, report, "renderers", secondsJson(seconds), secondsText(seconds));
  return ExitCode::kDone;
}

}  // namespace cloudbake
