// cloudbake preview ASSET.glb -o out.png: what an engine shows with the four floats and the lobe formula.
#include "app/commands.h"
#include "app/pipeline.h"
#include "bake/mesh_topology.h"
#include "io/gltf.h"
#include "io/image.h"
#include "io/write_file.h"
#include "preview/camera.h"
#include "preview/mesh_clouds.h"
#include "preview/render.h"

namespace cloudbake {

namespace {

struct NamedFile {
  std::filesystem::path file;
  std::string bytes;
};

// What --channels and --steps ask for beside the picture.
std::vector<NamedFile> extraPictures(const MeshCloudSteps& steps, const PostSettings& post, const LightSettings& light,
                                     const ViewSettings& view) {
  std::vector<NamedFile> files;
  const auto add = [&](const std::filesystem::path& stem, const std::string& name, const Image& image) {
    files.push_back({stem.string() + "_" + name + ".png", encodePng(image)});
  };
  if (view.channels)
    for (int channel = 0; const char* name : {"sun", "sky", "opacity", "depth"})
      add(*view.channels, name, channelPicture(steps.drawn, channel++));
  const std::pair<const char*, const Image4*> made[] = {{"1_drawn", &steps.drawn},
                                                        {"2_downsampled", &steps.downsampled},
                                                        {"3_blurred", &steps.blurred},
                                                        {"4_depth_blurred", &steps.depth_blurred},
                                                        {"5_distorted", &steps.distorted}};
  if (view.steps)
    for (const auto& [name, channels] : made)
      add(*view.steps, name, toneMap(composite(*channels, steps.background, light.sky.colors, post.composite), view.exposure));
  return files;
}

}  // namespace

ExitCode runPreview(Settings settings, const ApplyCommandLine& apply_command_line) {
  apply_command_line(settings);
  const ViewSettings& view = settings.view;
  if (view.plain && (view.channels || view.steps || view.time_seconds > 0))
    throw UsageError("--channels, --steps and --time are of the painted look: leave out --look plain");
  BakeReport report;
  report.command = "preview";
  report.input = settings.input.string();
  Stopwatch watch;
  const BakedMesh mesh = decodeGlb(settings.input, readFileBytes(settings.input), report.warnings);
  report.info = mesh.info;
  report.vertices = mesh.surface.positions.size();
  report.triangles = mesh.surface.triangles.size();
  watch.lap(report, "read");

  const Camera camera = frameCamera(boundingBox(mesh.surface), view.camera_azimuth_degrees, view.camera_elevation_degrees,
                                    view.field_of_view_degrees, view.width, view.height);
  const LightSettings light = lightForSun(view.sun_azimuth_degrees, view.sun_elevation_degrees);
  PostSettings post;
  post.distort.time_seconds = view.time_seconds;
  MeshCloudSteps steps;
  const Instance instance{&mesh, {}};
  const Image linear = view.plain ? renderLobe(mesh, camera, light) : renderMeshClouds({&instance, 1}, camera, light, post, &steps);
  watch.lap(report, "render");
  const std::string png = encodePng(toneMap(linear, view.exposure));
  const std::vector<NamedFile> extra = view.plain ? std::vector<NamedFile>{} : extraPictures(steps, post, light, view);
  enforceStrict(settings, report);
  for (const NamedFile& file : extra) writeFileAtomically(file.file, file.bytes);
  writeFileAtomically(settings.output, png);
  report.output = settings.output.string();
  watch.lap(report, "write");
  tellReport(settings, report);
  return ExitCode::kDone;
}

}  // namespace cloudbake
