// cloudbake preview ASSET.glb -o out.png: what an engine shows with the four floats and the lobe formula; of a scene, in motion, or beside
// the truth.
#include <cmath>
#include <map>

#include "app/commands.h"
#include "app/compare.h"
#include "app/pipeline.h"
#include "app/scene_file.h"
#include "bake/mesh_topology.h"
#include "io/animated_png.h"
#include "io/exr.h"
#include "io/gltf.h"
#include "io/image.h"
#include "io/report.h"
#include "io/text_scan.h"
#include "io/write_file.h"
#include "preview/camera.h"
#include "preview/mesh_clouds.h"
#include "preview/render.h"

namespace cloudbake {

namespace {

using Motion = ViewSettings::Motion;

struct NamedFile {
  std::filesystem::path file;
  std::string bytes;
};

// What pictures are drawn from.
struct Scenery {
  std::map<std::filesystem::path, BakedMesh> meshes;
  std::vector<Instance> instances;  // of the meshes
  std::optional<CameraPlace> camera;
  LightSettings light;
  PostSettings post;
};

// --- What is drawn ---

const BakedMesh& meshOf(const std::filesystem::path& file, Scenery& scenery, Warnings& warnings) {
  const auto [found, is_new] = scenery.meshes.try_emplace(file);
  if (is_new) found->second = decodeGlb(file, readFileBytes(file), warnings);
  return found->second;
}

Scenery readScenery(Settings& settings, const ApplyCommandLine& apply_command_line, BakeReport& report) {
  Scenery scenery;
  if (settings.scene) {
    SceneFile scene = readSceneFile(*settings.scene, readFileBytes(*settings.scene), settings, apply_command_line);
    for (const SceneCloud& cloud : scene.clouds)
      scenery.instances.push_back({&meshOf(cloud.file, scenery, report.warnings), cloud.to_world});
    scenery.camera = scene.camera;
    scenery.light = scene.light;
    scenery.post = scene.post;
  } else {
    scenery.instances.push_back({&meshOf(settings.input, scenery, report.warnings), {}});
    scenery.light = lightForSun(settings.view.sun_azimuth_degrees, settings.view.sun_elevation_degrees);
  }
  scenery.light.lobes_only = scenery.light.lobes_only || settings.view.lobes_only;
  report.info = scenery.instances.front().mesh->info;
  for (const Instance& instance : scenery.instances) {
    report.vertices += instance.mesh->surface.positions.size();
    report.triangles += instance.mesh->surface.triangles.size();
  }
  return scenery;
}

// `turn` about the vertical through what is looked at, degrees.
Camera cameraFor(const Scenery& scenery, const ViewSettings& view, float turn) {
  if (scenery.camera) {
    const Vec3 arm = transformVector(placement({}, {0, turn, 0}, {1, 1, 1}), scenery.camera->look_from - scenery.camera->look_at);
    return {scenery.camera->look_at + arm, scenery.camera->look_at, view.field_of_view_degrees, view.width, view.height};
  }
  Box box;
  for (const Instance& instance : scenery.instances) {
    const Box drawn = drawnBox(instance.mesh->surface, instance.to_world);
    if (drawn.empty()) continue;
    box.add(drawn.low);
    box.add(drawn.high);
  }
  return frameCamera(box, view.camera_azimuth_degrees + turn, view.camera_elevation_degrees, view.field_of_view_degrees, view.width,
                     view.height);
}

// --- One picture ---

// What --channels and --steps ask for beside the picture.
std::vector<NamedFile> extraPictures(const MeshCloudSteps& steps, const Scenery& scenery, const ViewSettings& view) {
  std::vector<NamedFile> files;
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
          toneMap(composite(*channels, steps.background, scenery.light.sky.colors, scenery.post.composite), view.exposure));
  return files;
}

// `turn`: as of cameraFor.
std::string drawPicture(const Scenery& scenery, const LightSettings& light, const ViewSettings& view, float turn,
                        std::vector<NamedFile>* extra) {
  const Camera camera = cameraFor(scenery, view, turn);
  if (view.plain) return encodePng(toneMap(renderLobe(*scenery.instances.front().mesh, camera, light), view.exposure));
  PostSettings post = scenery.post;
  post.distort.time_seconds = view.time_seconds;
  MeshCloudSteps steps;
  const Image linear = renderMeshClouds(scenery.instances, camera, light, post, &steps);
  if (extra) *extra = extraPictures(steps, scenery, view);
  return encodePng(toneMap(linear, view.exposure));
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

std::vector<std::string> drawFrames(const Scenery& scenery, const ViewSettings& view) {
  std::vector<std::string> frames;
  for (int i = 0; i < view.frame_count; ++i) {
    const double share = double(i) / view.frame_count;
    LightSettings light = scenery.light;
    ViewSettings moment = view;
    if (view.motion == Motion::kAnimate && scenery.post.distort.swirl_speed > 0)  // after half a cycle the two phases have changed places
      moment.time_seconds += share / (2 * double(scenery.post.distort.swirl_speed));
    if (view.motion == Motion::kSunSweep) {
      light.sky.to_sun = sunOfDay(view, double(i) / std::max(1, view.frame_count - 1));
      light.sky.colors = skyColorsForSun(light.sky.to_sun.y);
    }
    frames.push_back(drawPicture(scenery, light, moment, view.motion == Motion::kTurntable ? float(360 * share) : 0, nullptr));
  }
  return frames;
}

std::vector<NamedFile> frameFiles(const std::vector<std::string>& frames, const std::filesystem::path& stem) {
  std::vector<NamedFile> files;
  for (size_t i = 0; i < frames.size(); ++i) {
    char number[32];
    std::snprintf(number, sizeof number, "_%04zu.png", i + 1);
    files.push_back({stem.string() + number, frames[i]});
  }
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
  Settings telling = settings;
  if (settings.json) {
    Json json = Json::parse(reportJson(report));
    json["comparison"] = comparisonJson(comparison);
    writeFileAtomically(*settings.json, json.dump(2) + "\n");
    telling.json.reset();
  }
  tellReport(telling, report);
  if (!settings.quiet) std::fputs(comparisonText(comparison).c_str(), stdout);
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
  std::string png;
  if (view.motion == Motion::kNone) {
    png = drawPicture(scenery, scenery.light, view, 0, &files);
    watch.lap(report, "render");
  } else {
    const std::vector<std::string> frames = drawFrames(scenery, view);
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
  tellReport(settings, report);
  return ExitCode::kDone;
}

}  // namespace cloudbake
