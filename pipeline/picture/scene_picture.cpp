#include "pipeline/picture/scene_picture.h"

#include <algorithm>
#include <chrono>

#include "preview/compare/image_error.h"
#include "preview/compare/sheet.h"
#include "preview/mesh_clouds/render.h"

namespace cloudbake {

namespace {

struct NamedLayer {
  std::string name, caption;
  Layer layer;
};

// Draws the parts one after the other, and records how long each took.
class Painter {
 private:
  template <typename Draw>
  auto timed(const std::string& name, const Draw& draw) {
    const auto start = std::chrono::steady_clock::now();
    auto drawn = draw();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    parts_.seconds.emplace_back(name, seconds);
    return drawn;
  }

 public:
  Painter(const SceneFile& scene, std::span<const Instance> instances, const Camera& camera, DrawnParts& parts)
      : scene_(scene), instances_(instances), light_(scene.light), camera_(camera), view_(scene.view), parts_(parts) {}

  // The image chain alone, for a scene with nothing else.
  Image meshClouds() {
    return timed("mesh clouds", [&] {
      drawSteps();
      parts_.background = drawSky(camera_, light_.sky, scene_.post);
      return composite(parts_.steps.back().channels, parts_.background, camera_, light_.sky, scene_.post.composite);
    });
  }

  const Image& background() {
    parts_.background = timed("sky", [&] {
      if (scene_.terrain_sky && scene_.terrain) return renderTerrainSky(camera_, light_.sky.to_sun, *scene_.terrain);
      return drawSky(camera_, light_.sky, scene_.post);
    });
    return parts_.background;
  }

  std::vector<NamedLayer> clouds() {
    std::vector<NamedLayer> layers;
    if (!instances_.empty()) {
      Layer layer = timed("mesh clouds", [&] {
        drawSteps();
        const DepthRange range = scene_.post.depth_range.value_or(depthRange(instances_, camera_));
        return meshCloudLayer(parts_.steps.back().channels, camera_, range, light_.sky, scene_.post.composite);
      });
      size_t vertices = 0;
      for (const Instance& instance : instances_) vertices += instance.mesh->surface.positions.size();
      layers.push_back({"mesh clouds", std::to_string(vertices) + " vertices of 16 bytes for the light", std::move(layer)});
    }
    for (const SlabSettings& slab : scene_.slabs)
      layers.push_back({"cartoon slab", "no mesh; a march per pixel",
                        timed("slab clouds", [&] { return renderSlabClouds(camera_, light_.sky, slab); })});
    for (const DistanceCloudSettings& one : scene_.distance_clouds)
      layers.push_back({"marched, distance", "no mesh; a march per pixel",
                        timed("distance clouds", [&] { return renderDistanceClouds(camera_, light_.sky, one); })});
    for (const DensityCloudSettings& one : scene_.density_clouds)
      layers.push_back({"marched, density", "no mesh; a march per pixel",
                        timed("density clouds", [&] { return renderDensityClouds(camera_, light_.sky, one); })});
    return layers;
  }

  std::optional<Layer> terrain() {
    if (!scene_.terrain) return std::nullopt;
    return timed("terrain", [&] { return renderTerrain(camera_, keyLight(light_.sky).direction, *scene_.terrain); });
  }

 private:
  void drawSteps() {
    PostSettings post = scene_.post;
    post.distort.time_seconds = view_.time_seconds;
    const StepsKept kept = view_.channels || view_.steps ? StepsKept::kAll : StepsKept::kLast;
    parts_.steps = drawMeshClouds(instances_, camera_, light_, post, kept);
  }

  const SceneFile& scene_;
  const std::span<const Instance> instances_;
  const LightSettings& light_;
  const Camera& camera_;
  const PictureSettings& view_;
  DrawnParts& parts_;
};

bool isMeshCloudsAlone(const SceneFile& scene) {
  return !scene.terrain && scene.slabs.empty() && scene.distance_clouds.empty() && scene.density_clouds.empty() && !(scene.fog.density > 0);
}

Image developed(Image linear, const GradeSettings& grade, float exposure) {
  if (!grade.sqrt_gamma) return toneMap(std::move(linear), exposure);
  for (Vec3& p : linear.pixels) p = p * exposure;
  return gammaBySqrt(linear);
}

// Blurs by the camera's own motion: along the terrain's path, or from the turn before.
Image blurredByMotion(const Image& image, const SceneFile& scene, std::span<const Instance> instances, float turn_before,
                      const Camera& camera, std::span<const Layer> layers) {
  SceneFile before = scene;
  before.view.time_seconds -= scene.grade.motion_blur->shutter_seconds;
  const Camera previous = cameraFor(before, instances, turn_before);
  std::vector<float> distances(image.pixels.size(), INFINITY);
  for (const Layer& layer : layers)
    for (size_t i = 0; i < distances.size(); ++i)
      if (layer.pixels[i].opacity > 0.5F) distances[i] = std::min(distances[i], layer.pixels[i].distance);
  return motionBlur(image, cameraVelocity(camera, previous, distances), *scene.grade.motion_blur);
}

Image techniquesSheet(const std::vector<NamedLayer>& layers, const Image& background, const SceneFile& scene, float exposure) {
  std::vector<Panel> panels;
  for (const NamedLayer& one : layers)
    panels.push_back({one.name, one.caption, developed(composeLayers({&one.layer, 1}, background, scene.fog), scene.grade, exposure)});
  return sheet(panels, 2);
}

}  // namespace

void makeDraft(SceneFile& scene) {
  scene.post.sky_samples_per_side = 1;
  if (scene.post.published) scene.post.published->channels.samples_per_side = 1;
  if (scene.terrain) {
    scene.terrain->samples_per_side = 1;
    scene.terrain->shape.normal_octaves = std::min(scene.terrain->shape.normal_octaves, 9);
    scene.terrain->march.tolerance = std::max(scene.terrain->march.tolerance, 0.004F);
  }
  for (SlabSettings& slab : scene.slabs) slab.samples_per_side = 1, slab.samples = std::max(1, slab.samples / 4);
  for (DistanceCloudSettings& one : scene.distance_clouds) one.samples_per_side = 1, one.octaves = std::min(one.octaves, 3);
  for (DensityCloudSettings& one : scene.density_clouds) {
    one.samples_per_side = 1;
    one.octaves = std::min(one.octaves, 3);
    one.parts = std::min(one.parts, 4);
    one.part_length *= 2;
  }
}

SceneFile sceneAt(const Scenery& scenery, const Moment& moment) {
  if (scenery.read) return scenery.read(moment);
  SceneFile scene = scenery.scene;
  scene.view = viewAt(scene.view, moment);
  const bool lobes_only = scene.light.lobes_only;
  scene.light = lightFor(scene.post, scene.view.sun_azimuth_degrees, scene.view.sun_elevation_degrees);
  scene.light.lobes_only = lobes_only;
  return scene;
}

Camera cameraFor(const SceneFile& scene, std::span<const Instance> instances, float turn) {
  const PictureSettings& view = scene.view;
  const float roll = scene.camera_roll_degrees * float(kPi / 180);
  if (scene.camera_path) return cameraOf(terrainPath(view.time_seconds, *scene.terrain), view.width, view.height);
  if (scene.camera) {
    const Vec3 arm = transformVector(placement({}, {0, turn, 0}, {1, 1, 1}), scene.camera->look_from - scene.camera->look_at);
    return {scene.camera->look_at + arm, scene.camera->look_at, view.field_of_view_degrees, view.width, view.height, roll};
  }
  Box box;
  for (const Instance& instance : instances) {
    const Box drawn = drawnBox(instance.mesh->surface, instance.to_world);
    if (drawn.empty()) continue;
    box.add(drawn.low);
    box.add(drawn.high);
  }
  Camera camera = frameCamera(box, view.camera_azimuth_degrees + turn, view.camera_elevation_degrees, view.field_of_view_degrees,
                              view.width, view.height);
  camera.roll_radians = roll;
  if (scene.camera_distance)
    camera.look_from = camera.look_at + directionFromAngles(view.camera_azimuth_degrees + turn, view.camera_elevation_degrees) *
                                            float(*scene.camera_distance);
  return camera;
}

Image drawScene(const SceneFile& scene, std::span<const Instance> instances, const CameraTurn& turn, DrawnParts& parts) {
  const PictureSettings& view = scene.view;
  const Camera camera = cameraFor(scene, instances, turn.now);
  Painter painter(scene, instances, camera, parts);
  std::vector<Layer> layers;
  Image linear;
  if (isMeshCloudsAlone(scene)) {
    linear = painter.meshClouds();
  } else {
    const Image& background = painter.background();
    std::vector<NamedLayer> clouds = painter.clouds();
    if (scene.compares_techniques) return techniquesSheet(clouds, background, scene, view.exposure);
    for (NamedLayer& one : clouds) layers.push_back(std::move(one.layer));
    if (std::optional<Layer> ground = painter.terrain()) layers.push_back(std::move(*ground));
    linear = composeLayers(layers, background, scene.fog);
  }
  Image picture = developed(std::move(linear), scene.grade, view.exposure);
  if (scene.grade.motion_blur) picture = blurredByMotion(picture, scene, instances, turn.before, camera, layers);
  if (scene.grade.vignette) picture = vignette(picture, *scene.grade.vignette);
  if (scene.grade.contrast) picture = contrast(picture, *scene.grade.contrast);
  return picture;
}

}  // namespace cloudbake
