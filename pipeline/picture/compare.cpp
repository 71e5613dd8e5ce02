// The sheet of "On Mesh Cloud Rendering" (2019-06-30): a volume render, the per-vertex truth of two marches, the lobe, Lambert, and the
// lobe blended with Lambert, from one camera. Every surface is as opaque along the view as the volume is, and the first one shows its
// light, as in an engine, so that only the light differs. Beside them are the transmittance at the vertices, the mean lobe if the asset has
// another, and the painted look, with its own light, opacity and chain.
#include "pipeline/picture/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "bake/lobe/sweep.h"
#include "bake/mesh/mesh_topology.h"
#include "core/harmonics.h"
#include "core/lobe_lighting.h"
#include "core/memory_budget.h"
#include "core/portable_math.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/decode.h"
#include "io/report/figures.h"
#include "pipeline/lobes/lobes.h"
#include "pipeline/sources/sculpt.h"
#include "preview/camera.h"
#include "preview/compare/image_error.h"
#include "preview/compare/sheet.h"
#include "preview/compare/volume.h"
#include "preview/mesh_clouds/mesh_clouds.h"
#include "preview/mesh_clouds/render.h"

namespace cloudbake {

namespace {

constexpr int kVoxels = 200;  // voxels of the truth along the longest side, for the published step
constexpr Vec3 kUp{0, 1, 0};  // towards the sky
constexpr float kBlend = 0.5F;
constexpr float kErrorScale = 0.25F;

// The asset that is compared, and everything that does not depend on the sun.
struct Subject {
  BakedMesh mesh;
  CoverageField field;
  std::vector<Vec3> cells;
  std::vector<float> vertices_to_sky, cells_to_sky;  // ℓ
  std::vector<Lobe> mean;                            // of a fitted asset: the mean lobes that it was fitted from
  LobeShape mean_shape;
  float extinction = 0, ray_length = 0;
  VolumeLight volume;  // as the asset was fitted to, unless the settings say otherwise
};

// ℓ of points towards a direction.
std::vector<float> lengthsTo(Vec3 direction, std::span<const Vec3> points, const Subject& subject) {
  std::vector<float> lengths = sweptLengths(points, {&direction, 1}, subject.field, subject.ray_length);
  lengths.resize(points.size());  // the rest is for the opposite direction
  return lengths;
}

Subject readSubject(const Settings& settings, BakeReport& report, Stopwatch& watch) {
  Subject subject;
  const std::filesystem::path& file = settings.source.input;
  report.input = file.string();
  Warnings told_by_sculpt;
  subject.mesh = decodeGlb(file, readFileBytes(file), told_by_sculpt, settings.source.read);
  const Cloud cloud = readSculpt(settings, report, watch);
  report.vertices = cloud.surface.positions.size();
  report.triangles = cloud.surface.triangles.size();
  report.info = subject.mesh.info;
  FieldSettings fine = settings.field;
  fine.bake_voxels = kVoxels;
  const BakeParameters parameters = parametersFor(cloud, settings);
  const IntegrationField field = buildField(cloud, fine, parameters.bake.method, report.warnings);
  if (subject.mesh.info.lobe == "fit") {
    subject.mean = meanLobes({cloud.surface.positions, cloud.surface.normals}, field, parameters.bake, report.warnings);
    subject.mean_shape = defaultMeanShape(cloud.surface);
  }
  subject.field = *field.coverage;
  subject.cells = cellCenters(subject.field);
  subject.ray_length = boundingBox(cloud.surface).diagonal();
  subject.extinction = worldExtinction({&subject.mesh, {}}, {});
  subject.volume = settings.lobe.volume.over(subject.mesh.info.volume.value_or(VolumeLight{}));
  subject.vertices_to_sky = lengthsTo(kUp, subject.mesh.surface.positions, subject);
  subject.cells_to_sky = lengthsTo(kUp, subject.cells, subject);
  watch.lap(report.seconds, "field");
  return subject;
}

// --- Pictures ---

struct NamedPicture {
  std::string name;
  Image image;  // display-referred
};

// For one sun: ℓ of the vertices towards it, the pictures, and the mask of the cloud's pixels.
struct SunPictures {
  std::vector<float> vertices_to_sun;
  std::vector<NamedPicture> pictures;
  PixelMask mask;
};

std::string lobeName(const Subject& subject) { return subject.mesh.info.lobe == "fit" ? "fitted lobe" : "mean lobe"; }

// R and G of the mean lobes.
std::vector<Shade> meanShades(const Subject& subject, Vec3 to_sun) {
  std::vector<Shade> shades;
  for (const Lobe& lobe : subject.mean)
    shades.push_back({lobeTransmittance(lobe, to_sun, subject.mean_shape, subject.extinction),
                      lobeTransmittance(lobe, kUp, subject.mean_shape, subject.extinction)});
  return shades;
}

// What the camera sees of the volume through every vertex: a march along the view, lit by marches towards the light.
std::vector<Shade> seenShades(const Subject& subject, const Volume& volume, const Camera& camera, Vec3 to_sun,
                              const VolumeSettings& settings) {
  std::vector<Ray> rays;
  for (const Vec3& p : subject.mesh.surface.positions) rays.push_back({p, normalized(p - camera.look_from).value_or(Vec3{0, 0, -1})});
  std::vector<Shade> shades;
  for (const SeenLight& seen : lightAlong(volume, rays, to_sun, settings)) shades.push_back(seen.shade);
  return shades;
}

// Draws all pictures, with spherical harmonics if the asset has them. The volume comes first, the truth second.
SunPictures drawAll(const Subject& subject, const Camera& camera, LightSettings light, const PictureSettings& view) {
  const BakedMesh& mesh = subject.mesh;
  const Vec3 to_sun = keyLight(light.sky).direction;
  const LightSettings painted = lookOf({}, light);
  SunPictures drawn;
  drawn.vertices_to_sun = lengthsTo(to_sun, mesh.surface.positions, subject);
  std::vector<NamedPicture>& pictures = drawn.pictures;
  const auto add = [&](const std::string& name, const Image& linear) { pictures.push_back({name, toneMap(linear, view.exposure)}); };

  const std::vector<float> cells_to_sun = lengthsTo(to_sun, subject.cells, subject);
  const Volume volume{&subject.field, cells_to_sun, subject.cells_to_sky};
  VolumeSettings settings;
  settings.extinction = subject.extinction;
  settings.light = subject.volume;
  add("volume", renderVolume(volume, camera, light, settings));
  light.view_extinction = subject.volume.view_extinction;
  light.first_surface = true;
  add("truth", renderShaded(mesh, seenShades(subject, volume, camera, to_sun, settings), camera, light));
  add("exact T",
      renderShaded(mesh, transmittanceShades(drawn.vertices_to_sun, subject.vertices_to_sky, subject.extinction), camera, light));
  light.half_lambert = 1;
  light.lobes_only = true;
  add(lobeName(subject), renderLobe(mesh, camera, light));
  if (!subject.mean.empty()) add("mean lobe", renderShaded(mesh, meanShades(subject, to_sun), camera, light));
  add("Lambert", renderShaded(mesh, lambertShades(mesh.surface, to_sun), camera, light));
  light.half_lambert = kBlend;
  add("lobe + Lambert", renderLobe(mesh, camera, light));
  light.half_lambert = 1;
  light.lobes_only = false;
  if (!mesh.harmonics.empty()) add("harmonics", renderLobe(mesh, camera, light));
  const Instance instance{&mesh, {}};
  add("painted", renderMeshClouds({&instance, 1}, camera, painted));

  // The mask covers the pixels where at least one of the two exact pictures differs from the sky.
  const Image sky = toneMap(renderSky(camera, light.sky, light.samples_per_side), view.exposure);
  drawn.mask = cloudMask(pictures[0].image, pictures[1].image, sky);
  return drawn;
}

PictureFigures figuresOf(const Image& picture, const Image& truth, const PixelMask& mask) {
  return {imageRms(picture, truth, mask), imagePsnr(picture, truth, mask), imageSsim(picture, truth, mask)};
}

// --- Transmittance on the visible surface ---

// The shade of the nearest surface, sampled like a picture; 0 where there is no surface.
Image surfaceImage(const Subject& subject, std::span<const Shade> shades, const Camera& camera) {
  LightSettings bare;
  bare.sky.colors = {};
  bare.sky.colors.sun_color = {1, 1, 1};
  bare.sky.disc.gain = bare.sky.glow = 0;
  bare.view_extinction = 0;
  bare.samples_per_side = 1;
  return renderShaded(subject.mesh, shades, camera, bare);
}

std::vector<std::pair<std::string, double>> surfaceErrors(const Subject& subject, std::span<const float> vertices_to_sun,
                                                          const Camera& camera, const LightSettings& light) {
  const BakedMesh& mesh = subject.mesh;
  const Vec3 to_sun = keyLight(light.sky).direction;
  const size_t vertices = mesh.surface.positions.size();
  const auto shadesOf = [&](const auto& transmittance) {
    std::vector<Shade> shades(vertices);
    for (size_t v = 0; v < vertices; ++v) shades[v].sun = transmittance(v);
    return shades;
  };
  const Image truth =
      surfaceImage(subject, shadesOf([&](size_t v) { return portableExp(-subject.extinction * vertices_to_sun[v]); }), camera);
  const Image covered = surfaceImage(subject, shadesOf([](size_t) { return 1.0F; }), camera);
  const PixelMask mask = cloudMask(covered, covered, blankImage(camera.width, camera.height));

  std::vector<std::pair<std::string, double>> errors;
  const auto judge = [&](const std::string& name, const auto& transmittance) {
    errors.emplace_back(name, imageRms(surfaceImage(subject, shadesOf(transmittance), camera), truth, mask));
  };
  judge(lobeName(subject), [&](size_t v) { return lobeTransmittance(mesh.lobes[v], to_sun, mesh.info.shape, subject.extinction); });
  if (!subject.mean.empty())
    judge("mean lobe", [&](size_t v) { return lobeTransmittance(subject.mean[v], to_sun, subject.mean_shape, subject.extinction); });
  if (const size_t count = mesh.harmonics.size() / vertices; count > 0)
    judge("harmonics", [&](size_t v) { return harmonicTransmittance(std::span(mesh.harmonics).subspan(v * count, count), to_sun); });
  const std::vector<Vec3> normals = smoothNormals(mesh.surface);
  judge("half-Lambert", [&](size_t v) { return 0.5F * dot(normals[v], to_sun) + 0.5F; });
  judge("Lambert", [&](size_t v) { return std::max(0.0F, dot(normals[v], to_sun)); });
  return errors;
}

// --- Suns ---

SunComparison compareSun(const Subject& subject, const Camera& camera, const LightSettings& light, const SunPictures& drawn) {
  const auto& [vertices_to_sun, pictures, mask] = drawn;
  SunComparison sun;
  const Vec3 l = light.sky.to_sun;
  sun.azimuth_degrees = float(atan2Degrees(l.x, l.z));
  sun.elevation_degrees = float(asinDegrees(std::clamp(l.y, -1.0F, 1.0F)));
  for (const auto& [name, image] : pictures)
    sun.pictures.push_back(
        {name, figuresOf(image, pictures[1].image, mask), figuresOf(image, pictures[0].image, mask), luminanceSpread(image, mask)});
  sun.surface_rms = surfaceErrors(subject, vertices_to_sun, camera, light);
  return sun;
}

// Suns spread evenly above the horizon, or over the arc that the lobes were fitted for.
std::vector<Vec3> sunsFor(const AssetInfo& info, int count) {
  if (info.sun_arc) return sunsOver(*info.sun_arc, count);
  std::vector<Vec3> suns;
  for (const Vec3 axis : sweepAxes(2 * count)) suns.push_back(axis.y < 0 ? -axis : axis);
  return suns;
}

// --- The sheet ---

std::string figureText(const PictureFigures& f) {
  return f.rms > 0 ? fmt::format("rms {:.3f}, {:.1f} dB, SSIM {:.3f}", f.rms, f.psnr, f.ssim) : "the same";
}

Image colorScale(int width, int height) {
  Image scale = blankImage(width, height);
  for (int y = height / 3; y < height / 2; ++y)
    for (int x = 0; x < width; ++x) scale.at(x, y) = errorColor((float(x) + 0.5F) / float(width));
  return scale;
}

// Blocks of a row of pictures and, below it, what is wrong with each. In more than four columns a page would show pictures too small.
Image drawSheet(const std::vector<NamedPicture>& pictures, const PixelMask& mask, const SunComparison& sun) {
  const Image& truth = pictures[1].image;
  const auto pictureOf = [&](size_t i) -> Panel {
    const ComparedPicture& figures = sun.pictures[i];
    return {pictures[i].name,
            i == 1   ? "volume: " + figureText(figures.to_volume)
            : i == 0 ? "marched along the view and towards the light"
                     : "truth: " + figureText(figures.to_truth) + "\nvolume: " + figureText(figures.to_volume),
            pictures[i].image};
  };
  const auto errorOf = [&](size_t i) -> Panel {
    if (i == 1) return {"scale of the errors", "from 0, left, to 0.25 of white", colorScale(truth.width, truth.height)};
    return {pictures[i].name + " \u2212 truth", "", errorMap(pictures[i].image, truth, kErrorScale, mask)};
  };
  constexpr size_t kMostColumns = 4;
  const size_t blocks = (pictures.size() + kMostColumns - 1) / kMostColumns, columns = (pictures.size() + blocks - 1) / blocks;
  std::vector<Panel> panels;
  for (size_t first = 0; first < pictures.size(); first += columns)
    for (const auto& panelOf : {std::function<Panel(size_t)>(pictureOf), std::function<Panel(size_t)>(errorOf)})
      for (size_t i = first; i < first + columns; ++i) panels.push_back(i < pictures.size() ? panelOf(i) : Panel());
  return sheet(panels, int(columns));
}

double medianOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const size_t n = values.size();
  return n == 0 ? NAN : (values[(n - 1) / 2] + values[n / 2]) / 2;
}

// One value per sun.
template <typename Value>
std::vector<double> overSuns(const std::vector<SunComparison>& suns, const Value& value) {
  std::vector<double> values;
  for (const SunComparison& sun : suns) values.push_back(value(sun));
  return values;
}

std::string rowsOf(const SunComparison& sun) {
  std::string text;
  for (const ComparedPicture& picture : sun.pictures)
    text += figureLine(picture.name, "  to the truth: {:36} to the volume: {:36} spread {:.3f}", figureText(picture.to_truth),
                       figureText(picture.to_volume), picture.luminance_spread);
  for (const auto& [name, rms] : sun.surface_rms) text += figureLine("T", "  rms {:.4f} of the {}", rms, name);
  return text;
}

// The pictures, a map of errors for each, all of them in panels and in rows of panels, and the sheet.
void requireSheetMemory(int width, int height, uint64_t limit) {
  constexpr int kPictures = 9, kPanels = 2 * kPictures, kCopies = 3;
  requireMemory({fmt::format("a sheet of {} pictures of {}x{} pixels", kPanels, width, height),
                 double(sizeof(Vec3)) * width * height * (kPictures + kCopies * kPanels), "use a smaller --size"},
                limit);
}

}  // namespace

Comparison compareAsset(const Settings& settings, BakeReport& report, Stopwatch& watch) {
  const PictureSettings& view = settings.picture;
  const int width = std::max(1, view.width / 2), height = std::max(1, view.height / 2);
  namingFile(settings.source.input.string(), [&] { requireSheetMemory(width, height, view.memory_limit); });
  const auto read = [&] { return readSubject(settings, report, watch); };
  const Subject subject = inStage("the fine field of the cloud to compare", "give it more with --memory", read);
  const Camera camera = frameCamera(boundingBox(subject.mesh.surface), view.camera_azimuth_degrees, view.camera_elevation_degrees,
                                    view.field_of_view_degrees, width, height);
  Comparison comparison;
  const LightSettings light = lightForSun(view.sun_azimuth_degrees, view.sun_elevation_degrees);
  const SunPictures drawn = drawAll(subject, camera, light, view);
  comparison.sun = compareSun(subject, camera, light, drawn);
  comparison.sheet = drawSheet(drawn.pictures, drawn.mask, comparison.sun);
  watch.lap(report.seconds, "render");
  if (view.suns == 0) return comparison;

  for (const Vec3 to_sun : sunsFor(subject.mesh.info, view.suns)) {
    LightSettings other = light;
    other.sky.to_sun = to_sun;
    other.sky.colors = skyColorsForSun(to_sun.y);
    other.samples_per_side = 2;
    comparison.suns.push_back(compareSun(subject, camera, other, drawAll(subject, camera, other, view)));
  }
  watch.lap(report.seconds, "suns");
  return comparison;
}

std::string comparisonText(const Comparison& comparison) {
  std::string text = rowsOf(comparison.sun);
  if (comparison.suns.empty()) return text;
  const auto& suns = comparison.suns;
  text += figureLine("suns", "{}: median and worst rms", suns.size());
  for (size_t i = 0; i < suns[0].pictures.size(); ++i) {
    const auto to_truth = overSuns(suns, [i](const SunComparison& sun) { return sun.pictures[i].to_truth.rms; });
    const auto to_volume = overSuns(suns, [i](const SunComparison& sun) { return sun.pictures[i].to_volume.rms; });
    text += figureLine(suns[0].pictures[i].name, "  to the truth {:.4f}, {:.4f}   to the volume {:.4f}, {:.4f}", medianOf(to_truth),
                       *std::max_element(to_truth.begin(), to_truth.end()), medianOf(to_volume),
                       *std::max_element(to_volume.begin(), to_volume.end()));
  }
  for (size_t i = 0; i < suns[0].surface_rms.size(); ++i) {
    const auto own = overSuns(suns, [i](const SunComparison& sun) { return sun.surface_rms[i].second; });
    const auto ratio = overSuns(suns, [i](const SunComparison& sun) { return sun.surface_rms[0].second / sun.surface_rms[i].second; });
    text += figureLine("T", "  {:.4f}, {:.4f} of the {}{}", medianOf(own), *std::max_element(own.begin(), own.end()),
                       suns[0].surface_rms[i].first, "");
    if (i > 0)
      text += figureLine("", "  ratio of the {}'s rms to it: median {:.3f}, worst {:.3f}", suns[0].surface_rms[0].first, medianOf(ratio),
                         *std::max_element(ratio.begin(), ratio.end()));
  }
  return text;
}

namespace {

Json sunJson(const SunComparison& sun) {
  const auto figures = [](const PictureFigures& f) {
    return Json{{"rms", f.rms}, {"psnr", std::isfinite(f.psnr) ? Json(f.psnr) : Json(nullptr)}, {"ssim", f.ssim}};
  };
  Json json = {{"azimuth", sun.azimuth_degrees}, {"elevation", sun.elevation_degrees}, {"pictures", Json::array()}};
  for (const ComparedPicture& picture : sun.pictures)
    json["pictures"].push_back({{"name", picture.name},
                                {"to_truth", figures(picture.to_truth)},
                                {"to_volume", figures(picture.to_volume)},
                                {"luminance_spread", picture.luminance_spread}});
  json["surface_transmittance_rms"] = Json::object();
  for (const auto& [name, rms] : sun.surface_rms) json["surface_transmittance_rms"][name] = rms;
  return json;
}

}  // namespace

Json comparisonJson(const Comparison& comparison) {
  Json json = sunJson(comparison.sun);
  for (const SunComparison& sun : comparison.suns) json["suns"].push_back(sunJson(sun));
  return json;
}

}  // namespace cloudbake
