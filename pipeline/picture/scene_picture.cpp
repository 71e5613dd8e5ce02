#include "pipeline/picture/scene_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iterator>

#include "core/portable_math.h"
#include "pipeline/picture/picture_memory.h"
#include "pipeline/picture/scene_shadows.h"
#include "preview/compare/image_error.h"
#include "preview/compare/sheet.h"
#include "preview/mesh_clouds/levels.h"
#include "preview/mesh_clouds/render.h"

namespace cloudbake {

namespace {

struct NamedLayers {
  std::string name, caption;
  std::vector<Layer> layers;
};

// Draws the parts one after the other, and records how long each took.
class Painter {
 private:
  using Kind = SceneShadows::Kind;

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
      : scene_(scene),
        instances_(withLevels(instances, camera)),
        light_(scene.light),
        camera_(camera),
        view_(scene.view),
        parts_(parts),
        shadows_(scene, instances_) {
    if (!drawsShadows(scene)) return;
    vertex_shares_ = timed("shadows", [&] { return shadows_.sharesOfVertices(); });
    for (size_t i = 0; i < instances_.size(); ++i) instances_[i].sun_shares = vertex_shares_[i];
  }

  std::span<const Instance> instances() const { return instances_; }

  const Image& background() {
    parts_.background = timed("sky", [&] {
      if (scene_.terrain_sky && scene_.terrain) return renderTerrainSky(camera_, light_.sky.to_sun, *scene_.terrain);
      return drawSky(camera_, light_.sky, scene_.post);
    });
    return parts_.background;
  }

  std::optional<Layer> terrain(const Camera& rows) {
    if (!scene_.terrain) return std::nullopt;
    return timed("terrain",
                 [&] { return renderTerrain(rows, keyLight(light_.sky).direction, *scene_.terrain, shadows_.past(Kind::kTerrain)); });
  }

  // The steps of their chain look at neighbours, so that they are drawn whole, once.
  std::optional<Layer> meshClouds(const Camera& rows) {
    if (instances_.empty()) return std::nullopt;
    return timed("mesh clouds", [&] {
      if (parts_.steps.empty()) drawSteps();
      return meshCloudLayer(*last_, *drawn_, rows, depthRangeOf(scene_.post, instances_), light_.sky, compositeOf(scene_),
                            parts_.steps.back().colors);
    });
  }

  // Clouds that are marched, in front of the surfaces, between and behind them.
  std::vector<NamedLayers> marchedClouds(const Camera& rows, std::span<const Layer> surfaces) {
    std::vector<NamedLayers> clouds;
    const auto add = [&](const char* name, const char* renderer, Kind kind, const auto& all, const auto& render) {
      for (size_t i = 0; i < all.size(); ++i)
        clouds.push_back({name, "no mesh, a march per pixel", timed(renderer, [&] {
                            std::vector<Layer> layers = render(all[i]);
                            shadows_.darken(layers, kind, i, rows);
                            return layers;
                          })});
    };
    add("cartoon slab", "slab clouds", Kind::kSlab, scene_.slabs,
        [&](const SlabSettings& slab) { return renderSlabClouds(rows, slab, surfaces); });
    add("marched, distance", "distance clouds", Kind::kDistance, scene_.distance_clouds,
        [&](const DistanceCloudSettings& one) { return renderDistanceClouds(rows, light_.sky, one, surfaces, shadows_.onSamples()); });
    add("marched, density", "density clouds", Kind::kDensity, scene_.density_clouds,
        [&](const DensityCloudSettings& one) { return renderDensityClouds(rows, light_.sky, one, surfaces, shadows_.onSamples()); });
    for (const SceneDust& dust : scene_.dust)
      clouds.push_back({"dust", "no mesh, a lattice of harmonics", timed("dust", [&] {
                          return renderDust(rows, light_.sky, dust.lattice->box(), dust.to_world, dust.settings,
                                            lightThrough(dust, light_.extinction), surfaces);
                        })});
    return clouds;
  }

 private:
  void drawSteps() {
    PostSettings post = scene_.post;
    post.distort.time_seconds = view_.time_seconds + view_.time_offset_seconds;
    const StepsKept kept = view_.channels || view_.steps ? StepsKept::kAll : StepsKept::kEnds;
    parts_.steps = drawMeshClouds(instances_, camera_, light_, post, kept);
    const ChannelMean mean = post.composite.mean;
    last_ = &atSize(parts_.steps.back().channels, camera_.width, camera_.height, mean, resampled_last_);
    drawn_ = &atSize(parts_.steps.front().channels, camera_.width, camera_.height, mean, resampled_drawn_);
  }

  const SceneFile& scene_;
  std::vector<Instance> instances_;
  const LightSettings& light_;
  const Camera& camera_;
  const PictureSettings& view_;
  DrawnParts& parts_;
  const SceneShadows shadows_;
  std::vector<std::vector<float>> vertex_shares_;
  const Image4 *last_ = nullptr, *drawn_ = nullptr;  // of the steps, at the picture's size
  Image4 resampled_last_, resampled_drawn_;
};

// Draws the layers of a few rows at a time, with a row more above and below for what looks at its neighbours, and passes each group of rows
// to `use(camera of the rows, first row, row count)`.
template <typename Use>
void forRows(const Camera& camera, int together, const Use& use) {
  for (int first = 0; first < camera.height; first += together) {
    const int count = std::min(together, camera.height - first);
    Camera rows = camera;
    rows.first_row = std::max(0, first - 1);
    rows.row_count = std::min(camera.height, first + count + 1) - rows.first_row;
    use(rows, first, count);
  }
}

// What the fog scatters of the key light towards each pixel; empty if it scatters none.
std::vector<Vec3> scatteredOver(const Camera& rows, const SceneFile& scene) {
  const FogScatter& scatter = scene.post.composite.scatter;
  if (!(scatter.strength > 0 && scene.fog.density > 0)) return {};
  const CloudLight light = cloudLight(scene.light.sky);
  const CameraRays rays(rows);
  std::vector<Vec3> scattered;
  for (int y = 0; y < rows.rows(); ++y)
    for (int x = 0; x < rows.width; ++x) {
      const Vec3 view = rays.at(float(x) + 0.5F, float(rows.first_row + y) + 0.5F).direction;
      scattered.push_back(scatteredLight(view, light.to_light, light.colors.sun_color, scatter));
    }
  return scattered;
}

// The layers over the background, in these rows of the picture.
void composeRows(std::span<const Layer> layers, const Camera& rows, int first, int count, const SceneFile& scene, Image& picture) {
  const auto row = [&](Image& image, int y) { return image.pixels.begin() + ptrdiff_t(y) * image.width; };
  Image part = blankImage(picture.width, rows.rows());
  std::copy_n(row(picture, rows.first_row), part.pixels.size(), part.pixels.begin());
  part = composeLayers(layers, part, scene.fog, scatteredOver(rows, scene));
  std::copy_n(row(part, first - rows.first_row), ptrdiff_t(count) * picture.width, row(picture, first));
}

Image developed(Image linear, const GradeSettings& grade, float exposure) {
  if (!grade.sqrt_gamma) return toneMap(std::move(linear), exposure);
  for (Vec3& p : linear.pixels) p = p * exposure;
  return gammaBySqrt(linear);
}

// The distances of what is most opaque in these rows of the picture.
void takeDistances(std::span<const Layer> layers, const Camera& rows, int first, int count, std::vector<float>& distances) {
  for (const Layer& layer : layers)
    for (int y = first; y < first + count; ++y)
      for (int x = 0; x < layer.width; ++x)
        for (int i = 0; i < layer.samples(); ++i) {
          const LayerPixel& pixel = layer.at(x, y - rows.first_row, i);
          float& distance = distances[size_t(y) * size_t(layer.width) + size_t(x)];
          if (pixel.opacity > 0.5F) distance = std::min(distance, pixel.distance);
        }
}

// Blurs by the camera's own motion: along the terrain's path, or from the turn before.
Image blurredByMotion(const Image& image, const SceneFile& scene, std::span<const Instance> instances, float turn_before,
                      const Camera& camera, std::span<const float> distances) {
  SceneFile before = scene;
  before.view.time_seconds -= scene.grade.motion_blur->shutter_seconds;
  const Camera previous = cameraFor(before, instances, turn_before);
  return motionBlur(image, cameraVelocity(camera, previous, distances), *scene.grade.motion_blur);
}

// Each kind of cloud alone, with the time of day if the scene has hours.
Image techniquesSheet(Painter& painter, const SceneFile& scene, const Camera& camera) {
  const std::string clock = scene.day ? ", " + scene.day->clockAt(scene.view.time_seconds) : "";
  const Image background = painter.background();
  std::vector<Panel> panels;
  forRows(camera, rowsTogether(scene, camera), [&](const Camera& rows, int first, int count) {
    std::vector<NamedLayers> all;
    if (std::optional<Layer> clouds = painter.meshClouds(rows)) {
      size_t vertices = 0;
      for (const Instance& instance : painter.instances())
        if (instance.is_seen) vertices += instance.mesh->surface.positions.size();
      all.push_back({"mesh clouds", fmt::format("{} vertices, each with 16 bytes for the light", vertices), {std::move(*clouds)}});
    }
    for (NamedLayers& clouds : painter.marchedClouds(rows, {})) all.push_back(std::move(clouds));
    for (size_t i = 0; i < all.size(); ++i) {
      if (i == panels.size()) panels.push_back({all[i].name + clock, all[i].caption, background});
      composeRows(all[i].layers, rows, first, count, scene, panels[i].image);
    }
  });
  for (Panel& panel : panels) panel.image = developed(std::move(panel.image), scene.grade, scene.view.exposure);
  return sheet(panels, 2);
}

}  // namespace

LightAt lightThrough(const SceneDust& dust, std::optional<float> extinction) {
  const HarmonicLattice& lattice = *dust.lattice;
  const Affine to_own = inverted(dust.to_world).value();
  const float world = extinction.value_or(lattice.extinction / unitScale(dust.to_world));
  return [&lattice, to_own, world](Vec3 point, Vec3 to_light) {
    const Vec3 back = transformVector(to_own, to_light);
    const float stretch = length(back), power = world / (lattice.extinction * stretch);
    const float transmittance = latticeTransmittance(lattice, transformPoint(to_own, point), back / stretch);
    return std::abs(power - 1) < 1e-5F ? transmittance : portablePow(transmittance, power);
  };
}

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
  for (SceneDust& one : scene.dust) one.settings.samples_per_side = 1, one.settings.samples = std::max(1, one.settings.samples / 4);
  for (DensityCloudSettings& one : scene.density_clouds) {
    one.samples_per_side = 1;
    one.octaves = std::min(one.octaves, 3);
    one.parts = std::min(one.parts, 4);
    one.part_length *= 2;
  }
}

Box boxOf(const DrawnField& field) {
  float radius = 0;  // of all meshes about their origins
  for (const Instance& mesh : field.meshes) {
    const Box own = drawnBox(mesh.mesh->surface);
    for (int i = 0; i < 8 && !own.empty(); ++i) radius = std::max(radius, length(transformPoint(mesh.to_world, own.corner(i))));
  }
  return fieldBox(field.settings, radius);
}

namespace {

// Gives instances of clouds that change their meshes at a time. Copies of one cloud share them.
void showMoment(const Scenery& scenery, double seconds, std::vector<Instance>& instances) {
  std::map<const BakedMesh*, Instance> moments;
  for (Instance& instance : instances) {
    const auto found = scenery.sequences.find(instance.mesh);
    if (found == scenery.sequences.end()) continue;
    const auto [place, is_new] = moments.try_emplace(instance.mesh);
    Instance& moment = place->second;
    if (is_new) {
      const auto& [sequence, whole] = found->second;
      const std::vector<SeenSegment> seen = seenAt(sequence, seconds);
      moment.now = std::make_shared<const BakedMesh>(meshAt(sequence, seen.back()));
      if (seen.size() > 1) {
        moment.before = std::make_shared<const BakedMesh>(meshAt(sequence, seen.front()));
        moment.before_share = seen.front().weight;
      }
      if (instance.caster) {
        Warnings told_for_the_file;
        moment.own_caster = std::make_shared<const ShadowCaster>(shadowCasterOf(*moment.now, told_for_the_file).value_or(ShadowCaster{}));
      }
    }
    instance.mesh = moment.now.get();
    instance.now = moment.now, instance.before = moment.before, instance.before_share = moment.before_share;
    instance.own_caster = moment.own_caster;
    if (instance.own_caster) instance.caster = instance.own_caster->fractions.empty() ? nullptr : instance.own_caster.get();
  }
}

}  // namespace

Box boxOfMesh(const Instance& instance) { return instance.whole ? *instance.whole : drawnBox(instance.mesh->surface); }

std::vector<Instance> instancesAt(const Scenery& scenery, double seconds) {
  std::vector<Instance> instances = scenery.instances;
  for (const DrawnField& field : scenery.fields) {
    const ScatterSettings& settings = field.settings;
    const Box all = boxOf(field);
    std::vector<Box> boxes;
    std::vector<float> sides;
    for (const Instance& mesh : field.meshes) {
      boxes.push_back(boxOfMesh(mesh));
      sides.push_back(longestStretched(mesh));
    }
    const Vec3 wind{float(settings.drift.x * seconds), float(settings.drift.y * seconds), float(settings.drift.z * seconds)};
    for (const ScatteredCloud& cloud : field.clouds) {
      Instance instance = field.meshes[cloud.mesh];
      instance.scattered = Scattered{boxes[cloud.mesh], all, wind, cloud.size * sides[cloud.mesh], cloud.turn_degrees};
      instance.to_world = placeAt(settings, cloud, instance.to_world, seconds);
      instances.push_back(instance);
    }
  }
  showMoment(scenery, seconds, instances);
  return instances;
}

SceneFile sceneAt(const Scenery& scenery, const Moment& moment) {
  if (scenery.read) return scenery.read(moment);
  SceneFile scene = scenery.scene;
  scene.view = viewAt(scene.view, moment);
  const bool lobes_only = scene.light.lobes_only;
  scene.light = lightFor(scene.post, scene.view.sun_azimuth_degrees, scene.view.sun_elevation_degrees);
  scene.light.lobes_only = lobes_only;
  scene.fog.color = scene.light.sky.colors.horizon;
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
    const Box drawn = instance.scattered ? instance.scattered->field : placedBox(instance);
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

CompositeSettings compositeOf(const SceneFile& scene) {
  CompositeSettings settings = scene.post.composite;
  settings.fog_color = scene.fog.color;
  if (scene.fog.density > 0) settings.fog_density = 0;
  return settings;
}

std::vector<Instance> withLevels(std::span<const Instance> instances, const Camera& camera) {
  std::vector<Instance> seen(instances.begin(), instances.end());
  for (Instance& instance : seen) {
    instance.is_seen = instance.is_seen && (!instance.scattered || isInView(instance, camera));
    if (!instance.is_seen) continue;
    if (!instance.sized_as) instance.sized_as = instance.mesh;
    instance.mesh = &levelAt(instance, camera);
  }
  return seen;
}

Image drawScene(const SceneFile& scene, std::span<const Instance> instances, const CameraTurn& turn, DrawnParts& parts) {
  const PictureSettings& view = scene.view;
  const Camera camera = cameraFor(scene, instances, turn.now);
  Painter painter(scene, instances, camera, parts);
  if (scene.compares_techniques) return techniquesSheet(painter, scene, camera);
  Image picture = painter.background();
  std::vector<float> distances(scene.grade.motion_blur ? picture.pixels.size() : 0, INFINITY);
  forRows(camera, rowsTogether(scene, camera), [&](const Camera& rows, int first, int count) {
    std::vector<Layer> layers;
    if (std::optional<Layer> clouds = painter.meshClouds(rows)) layers.push_back(std::move(*clouds));
    if (std::optional<Layer> ground = painter.terrain(rows)) layers.push_back(std::move(*ground));
    for (NamedLayers& clouds : painter.marchedClouds(rows, layers))
      std::move(clouds.layers.begin(), clouds.layers.end(), std::back_inserter(layers));
    composeRows(layers, rows, first, count, scene, picture);
    if (scene.grade.motion_blur) takeDistances(layers, rows, first, count, distances);
  });
  picture = developed(std::move(picture), scene.grade, view.exposure);
  if (scene.grade.motion_blur) picture = blurredByMotion(picture, scene, instances, turn.before, camera, distances);
  if (scene.grade.vignette) picture = vignette(picture, *scene.grade.vignette);
  if (scene.grade.contrast) picture = contrast(picture, *scene.grade.contrast);
  return picture;
}

}  // namespace cloudbake
