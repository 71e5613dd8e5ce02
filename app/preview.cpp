// cloudbake preview ASSET.glb -o out.png: what an engine shows with the four floats and the lobe formula.
#include "app/commands.h"
#include "app/pipeline.h"
#include "bake/mesh_topology.h"
#include "io/gltf.h"
#include "io/image.h"
#include "io/write_file.h"
#include "preview/camera.h"
#include "preview/render.h"

namespace cloudbake {

ExitCode runPreview(Settings settings, const ApplyCommandLine& apply_command_line) {
  apply_command_line(settings);
  BakeReport report;
  report.command = "preview";
  report.input = settings.input.string();
  Stopwatch watch;
  const BakedMesh mesh = decodeGlb(settings.input, readFileBytes(settings.input), report.warnings);
  report.info = mesh.info;
  report.vertices = mesh.surface.positions.size();
  report.triangles = mesh.surface.triangles.size();
  watch.lap(report, "read");

  const ViewSettings& view = settings.view;
  const Camera camera = frameCamera(boundingBox(mesh.surface), view.camera_azimuth_degrees, view.camera_elevation_degrees,
                                    view.field_of_view_degrees, view.width, view.height);
  const Image image = toneMap(renderLobe(mesh, camera, lightForSun(view.sun_azimuth_degrees, view.sun_elevation_degrees)), view.exposure);
  watch.lap(report, "render");
  const std::string png = encodePng(image);
  enforceStrict(settings, report);
  writeFileAtomically(settings.output, png);
  report.output = settings.output.string();
  watch.lap(report, "write");
  tellReport(settings, report);
  return ExitCode::kDone;
}

}  // namespace cloudbake
