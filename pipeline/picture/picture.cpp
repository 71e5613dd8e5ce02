#include "pipeline/picture/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "core/error.h"
#include "core/memory_budget.h"
#include "core/parallel.h"
#include "core/text/scan.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/decode.h"
#include "io/gltf/asset/own_colors.h"
#include "io/gltf/impostor/impostor_file.h"
#include "io/gltf/sequence/sequence_file.h"
#include "io/image/animated_png.h"
#include "io/image/exr.h"
#include "io/image/image.h"
#include "io/volume/lattice.h"
#include "pipeline/asset/asset.h"
#include "pipeline/options/resolve.h"
#include "pipeline/options/version.h"
#include "pipeline/picture/cloud_cache.h"
#include "pipeline/picture/picture_memory.h"
#include "pipeline/picture/scene_shadows.h"
#include "pipeline/sources/grown.h"
#include "preview/mesh_clouds/impostor.h"
#include "preview/mesh_clouds/render.h"

namespace cloudbake {

std::string keyOf(const SceneCloud& cloud) {
  return !cloud.file.empty() ? cloud.file.string() : fmt::format("{} {} {} {}", cloud.preset, cloud.seed, cloud.vertices, cloud.fit);
}

namespace {

using Motion = PictureSettings::Motion;

// --- What is drawn ---

// The options of a cloud of a scene, or of a comparison.
Given givenTo(Command command, const char* name, const std::string& value) { return {findOption(name, command), value, "", 0, 0}; }

struct BakedGlb {
  std::string bytes;
  ReadSettings read;
};

// Grows or reads a cloud and bakes it as `grow` and `bake` do, with these options.
BakedGlb bakedGlb(const SourceSettings& from, std::optional<GrownSource> source, std::span<const Given> given, BakeReport& report) {
  Stopwatch watch;
  std::vector<Given> all;
  if (source) all = source->given;
  all.insert(all.end(), given.begin(), given.end());
  const Settings settings = resolve(from, all);
  const Cloud cloud = source ? growCloud(std::move(*source), settings, std::nullopt, report, watch) : readCloud(settings, report, watch);
  const BakeParameters parameters = resolveParameters(cloud, settings, report, watch);
  return {bakeAsset(cloud, settings, parameters, report, watch).glb, settings.source.read};
}

// A cloud as `grow` makes it, from the cache if it was grown before. One that raised warnings is grown each time, because they are not
// kept.
BakedGlb grownGlb(const SceneCloud& cloud, uint64_t memory_limit, Warnings& warnings) {
  SourceSettings from;
  from.memory_limit = memory_limit;
  from.input = cloud.preset;
  from.kind = sourceKindOf(cloud.preset) == SourceKind::kRecipe ? SourceKind::kRecipe : SourceKind::kPreset;
  const std::vector<Given> given = {givenTo(kGrow, "seed", std::to_string(cloud.seed)),
                                    givenTo(kGrow, "vertices", std::to_string(cloud.vertices)),
                                    givenTo(kGrow, "lobe", cloud.fit ? "fit" : "mean")};
  GrownSource source = readGrownSource(from);
  std::string made_from = buildHash() + source.name + "\n" + source.bytes;
  for (const Given& one : given) made_from += fmt::format("\n{}={}", one.option->name, one.value);
  const std::string key = hashBytes(made_from);

  const CloudCache cache(cloudCacheFolder());
  if (auto kept = cache.find(key)) return {std::move(*kept), {}};
  BakeReport report;
  BakedGlb baked = bakedGlb(from, std::move(source), given, report);
  if (report.warnings.empty()) cache.add(key, baked.bytes);
  for (const auto& [kind, entry] : report.warnings.entries()) warnings.add(kind, cloud.preset + ": " + entry.first, entry.count);
  return baked;
}

BakedMesh grownMesh(const SceneCloud& cloud, uint64_t memory_limit, Warnings& warnings) {
  const BakedGlb baked = grownGlb(cloud, memory_limit, warnings);
  Warnings told_by_the_bake;
  return decodeGlb(cloud.preset, baked.bytes, told_by_the_bake, baked.read);
}

// The same vertices with the other kind of lobe and with harmonics of order 2.
BakedMesh comparedMesh(const SourceSettings& source, const BakedMesh& mesh) {
  SourceSettings from = source;
  from.kind = SourceKind::kSculpt;
  BakeReport told_for_the_asset;
  return bakedMesh(from, std::vector{givenTo(kBake, "lobe", mesh.info.lobe == "fit" ? "mean" : "fit"), givenTo(kBake, "basis", "sh2")},
                   told_for_the_asset);
}

// Of a sequence, the mesh at its beginning, and all of it in `sequence`.
BakedMesh readMesh(const std::filesystem::path& file, uint64_t memory_limit, Warnings& warnings, std::optional<SceneSequence>& sequence) {
  ReadSettings read;
  read.memory_limit = memory_limit;
  requireMemoryForFile(file, memory_limit);
  const std::string bytes = readFileBytes(file);
  if (isImpostor(bytes)) return boxWithImpostor(decodeImpostor(file, bytes, memory_limit));
  if (isSequence(bytes)) {
    sequence.emplace().sequence = decodeSequence(file, bytes, memory_limit);
    sequence->whole = boxOf(sequence->sequence.segments);
    return meshAt(sequence->sequence, {});
  }
  return decodeColoredGlb(file, bytes, warnings, read);
}

const BakedMesh& meshOf(const SceneCloud& cloud, Scenery& scenery, Warnings& warnings) {
  const uint64_t limit = scenery.scene.view.memory_limit;
  const auto [found, is_new] = scenery.meshes.try_emplace(keyOf(cloud));
  if (!is_new) return found->second;
  std::optional<SceneSequence> sequence;
  found->second = cloud.file.empty() ? grownMesh(cloud, limit, warnings) : readMesh(cloud.file, limit, warnings, sequence);
  if (sequence) scenery.sequences.emplace(&found->second, std::move(*sequence));
  return found->second;
}

// Grows the clouds of a scene that are not there yet, several at a time, each within its part of the memory. One that needs more is left to
// meshOf.
void growClouds(Scenery& scenery, Warnings& warnings) {
  struct Fresh {
    const SceneCloud* cloud;
    std::optional<BakedMesh> mesh{};
    Warnings warnings{};
    std::exception_ptr error{};
  };
  std::set<std::string> named;
  std::vector<Fresh> fresh;
  const auto growOnce = [&](const SceneCloud& cloud) {
    if (cloud.file.empty() && !scenery.meshes.contains(keyOf(cloud)) && named.insert(keyOf(cloud)).second) fresh.push_back({&cloud});
  };
  for (const SceneCloud& cloud : scenery.scene.clouds) growOnce(cloud);
  for (const SceneField& field : scenery.scene.fields)
    for (const SceneCloud& cloud : field.clouds) growOnce(cloud);
  const uint64_t limit = scenery.scene.view.memory_limit / std::max<size_t>(1, std::min(threadCount(), fresh.size()));
  parallelFor(fresh.size(), [&](size_t i) {
    try {
      fresh[i].mesh = grownMesh(*fresh[i].cloud, limit, fresh[i].warnings);
    } catch (const MemoryError&) {
    } catch (...) {
      fresh[i].error = std::current_exception();
    }
  });
  for (Fresh& one : fresh) {  // in the order of the file, whichever came first
    if (one.error) std::rethrow_exception(one.error);
    if (!one.mesh) continue;
    for (const auto& [kind, entry] : one.warnings.entries()) warnings.add(kind, entry.first, entry.count);
    scenery.meshes.emplace(keyOf(*one.cloud), std::move(*one.mesh));
  }
}

// Throws unless this is the level of the cloud: its number, its input, and all that a lobe is lit with must agree, because the light of a
// cloud would jump where it changes to the level.
void checkLevel(const std::filesystem::path& file, const BakedMesh& mesh, int number, const std::filesystem::path& full_file,
                const AssetInfo& full) {
  const AssetInfo& level = mesh.info;
  constexpr const char* kCure = ": bake both again with --lods, or leave out levels = true";
  if (level.level != number || level.input_hash != full.input_hash)
    throw InputError(file.string(), fmt::format("this is not level {} of {}{}", number, full_file.string(), kCure));
  const auto same = [&](const char* what, const auto& of_level, const auto& of_full) {
    if (of_level != of_full)
      throw InputError(file.string(),
                       fmt::format("its {} is {}, but that of {} is {}{}", what, of_level, full_file.string(), of_full, kCure));
  };
  if (mesh.impostor) return;  // its lobes are its own
  same("lobe", level.lobe, full.lobe);
  same("exponent", level.shape.exponent, full.shape.exponent);
  same("bias", level.shape.bias, full.shape.bias);
  same("extinction", level.extinction, full.extinction);
  same("lowest extinction", level.extinction_low, full.extinction_low);
  same("highest extinction", level.extinction_high, full.extinction_high);
  same("order of harmonics", level.harmonic_order, full.harmonic_order);
}

// Gives an instance the levels of its cloud: the files beside it, up to the first that is missing. There may be none.
void setLevels(const SceneCloud& cloud, Instance& instance, Scenery& scenery, Warnings& warnings) {
  const auto [found, is_new] = scenery.levels.try_emplace(instance.mesh);
  for (size_t i = 1; is_new && i <= kMostLevels; ++i) {
    SceneCloud level;
    level.file = levelFile(cloud.file, i);
    if (!std::filesystem::exists(level.file)) break;
    const BakedMesh& mesh = meshOf(level, scenery, warnings);
    checkLevel(level.file, mesh, int(i), cloud.file, instance.mesh->info);
    found->second.push_back(&mesh);
  }
  instance.levels = found->second;
}

[[noreturn]] void refuseWithoutLevels(const SceneCloud& cloud) {
  throw InputError(cloud.file.string(), "levels = true, but there is no " + levelFile(cloud.file, 1).filename().string() +
                                            " beside it: bake it with --lods 50%,25%,10%, or leave the key out");
}

// A cloud of a scene where it is placed, with its levels, and with the field that casts its shadow if there are shadows.
Instance placed(const SceneCloud& cloud, Scenery& scenery, Warnings& warnings) {
  Instance instance{&meshOf(cloud, scenery, warnings), cloud.to_world};
  if (const auto changing = scenery.sequences.find(instance.mesh); changing != scenery.sequences.end())
    instance.whole = changing->second.whole;
  if (cloud.levels) setLevels(cloud, instance, scenery, warnings);
  if (!drawsShadows(scenery.scene) || instance.mesh->impostor) return instance;
  const auto [found, is_new] = scenery.casters.try_emplace(instance.mesh);
  if (is_new) found->second = shadowCasterOf(*instance.mesh, warnings).value_or(ShadowCaster{});
  if (!found->second.fractions.empty()) instance.caster = &found->second;
  return instance;
}

// Scatters the clouds of a field.
DrawnField scattered(const SceneField& field, Scenery& scenery, Warnings& warnings) {
  DrawnField drawn{field.scatter, scatterClouds(field.scatter, field.weights), {}};
  for (const SceneCloud& cloud : field.clouds) drawn.meshes.push_back(placed(cloud, scenery, warnings));
  const auto has_levels = [](const Instance& mesh) { return !mesh.levels.empty(); };
  if (field.clouds.front().levels && std::none_of(drawn.meshes.begin(), drawn.meshes.end(), has_levels))
    refuseWithoutLevels(field.clouds.front());
  return drawn;
}

// The files that a scene names apart from its clouds, each read once.
class NamedParts {
 public:
  void readInto(SceneFile& scene) {
    if (scene.light.sky.moon && !scene.moon_picture.empty())
      scene.light.sky.moon->picture = known(pictures_, scene.moon_picture, [&] {
        return linearOfSrgb(decodePng(readFileBytes(scene.moon_picture), scene.moon_picture.string(), scene.view.memory_limit));
      });
    for (SceneDust& dust : scene.dust)
      dust.lattice = known(lattices_, dust.file, [&] {
        return decodeLattice(dust.file, readFileBytes(dust.file),
                             [&](const std::string& name) { return readFileBytes(dust.file.parent_path() / name); });
      });
  }

 private:
  template <typename Part>
  using Parts = std::map<std::filesystem::path, std::shared_ptr<const Part>>;

  template <typename Part, typename Read>
  static std::shared_ptr<const Part> known(Parts<Part>& parts, const std::filesystem::path& file, const Read& read) {
    std::shared_ptr<const Part>& part = parts[file];
    if (!part) part = std::make_shared<const Part>(read());
    return part;
  }

  Parts<Image> pictures_;
  Parts<HarmonicLattice> lattices_;
};

// The scene's file at any moment.
std::function<SceneFile(const std::optional<Moment>&)> sceneReader(const std::filesystem::path& file, std::span<const Given> given,
                                                                   const PictureSettings& settings) {
  const bool begins = (settings.is_live || settings.motion != PictureSettings::Motion::kNone) && !isGiven(given, "time");
  return [file, begins, memory_limit = settings.memory_limit, text = readFileBytes(file), own = std::vector(given.begin(), given.end()),
          parts = std::make_shared<NamedParts>()](const std::optional<Moment>& moment) {
    SceneFile scene = readSceneFile(file, text, [&](const PictureSettings& view) {
      PictureSettings asked = resolvePicture(view, own);
      if (begins) asked.time_seconds = asked.start_seconds.value_or(asked.time_seconds);
      return moment ? viewAt(asked, *moment) : asked;
    });
    scene.view.memory_limit = memory_limit;
    parts->readInto(scene);
    if (scene.view.draft) makeDraft(scene);
    scene.light.lobes_only = scene.light.lobes_only || scene.view.lobes_only;
    return scene;
  };
}

// Scenery that may have meshes already, with what the settings show.
Scenery completed(Scenery scenery, const Settings& settings, std::span<const Given> given, BakeReport& report) {
  SceneFile& scene = scenery.scene;
  scene.view = settings.picture;
  if (settings.scene) {
    scenery.read = sceneReader(*settings.scene, given, settings.picture);
    scene = scenery.read(std::nullopt);
    growClouds(scenery, report.warnings);
    for (const SceneCloud& cloud : scene.clouds) {
      scenery.instances.push_back(placed(cloud, scenery, report.warnings));
      if (cloud.levels && scenery.instances.back().levels.empty()) refuseWithoutLevels(cloud);
    }
    for (const SceneField& field : scene.fields) scenery.fields.push_back(scattered(field, scenery, report.warnings));
  } else {
    SceneCloud asset;
    asset.file = settings.source.input;
    scenery.instances.push_back(placed(asset, scenery, report.warnings));
    const BakedMesh& mesh = *scenery.instances.back().mesh;
    if (scene.view.compare && !scenery.sequences.empty())
      throw UsageError("--compare shows other lobes of a cloud, and a sequence has none: leave it out");
    if (scene.view.compare) scenery.compared.emplace(&mesh, comparedMesh(settings.source, mesh));
    if (scene.view.plain) scene.post = publishedPost();
    scene.light = lightFor(scene.post, scene.view.sun_azimuth_degrees, scene.view.sun_elevation_degrees);
    scene.light.lobes_only = scene.view.lobes_only;
    scene.fog.color = scene.light.sky.colors.horizon;
  }
  const std::vector<Instance> instances = instancesAt(scenery, scene.view);
  if (!instances.empty()) report.info = instances.front().mesh->info;
  report.vertices = report.triangles = 0;
  for (const Instance& instance : withLevels(instances, cameraFor(scene, instances))) {
    if (!instance.is_seen) continue;
    report.vertices += instance.mesh->surface.positions.size();
    report.triangles += instance.mesh->surface.triangles.size();
  }
  return scenery;
}

// --- One picture ---

struct NamedFile {
  std::filesystem::path file;
  std::string bytes;
};

// The files of --channels and --steps.
std::vector<NamedFile> extraPictures(const DrawnParts& parts, const Camera& camera, const SceneFile& scene) {
  const std::vector<ChainStep>& steps = parts.steps;
  const PictureSettings& view = scene.view;
  std::vector<NamedFile> files;
  if ((view.channels || view.steps) && steps.empty())
    throw UsageError("--channels and --steps show mesh clouds, but the scene has none: leave them out");
  const auto add = [&](const std::filesystem::path& stem, const std::string& name, const Image& image) {
    files.push_back({stem.string() + "_" + name + ".png", encodePng(image)});
  };
  if (view.channels && lowerCase(view.channels->extension().string()) == ".exr")
    files.push_back({*view.channels, encodeExr(steps.front().channels)});
  else if (view.channels)
    for (int channel = 0; const char* name : {"sun", "sky", "opacity", "depth"})
      add(*view.channels, name, channelPicture(steps.front().channels, channel++));
  if (view.steps)
    for (int number = 1; const auto& [name, channels, colors] : steps)
      add(*view.steps, fmt::format("{}_{}", number++, name),
          dithered(toneMap(composite(channels, parts.background, camera, scene.light.sky, compositeOf(scene), colors), view.exposure)));
  return files;
}

// Of several pictures, `share` of the first and the rest of the second.
Image blended(Image first, const Image& second, float share) {
  for (size_t i = 0; i < first.pixels.size(); ++i) first.pixels[i] = first.pixels[i] * share + second.pixels[i] * (1 - share);
  return first;
}

// The picture of a scene's view, before it is dithered for 8 bits. `extra`, if given, receives the files of --channels and --steps.
Image drawWithoutFades(const SceneFile& scene, std::span<const Instance> instances, const CameraTurn& turn, StageSeconds& seconds,
                       std::vector<NamedFile>* extra) {
  const Camera camera = cameraFor(scene, instances, turn.now);
  requirePictureMemory(scene, withLevels(instances, camera), camera);
  if (scene.view.plain) {
    const BakedMesh& mesh = *instances.front().mesh;
    return toneMap(mesh.impostor ? renderImpostor(*mesh.impostor, camera, scene.light) : renderLobe(mesh, camera, scene.light),
                   scene.view.exposure);
  }
  DrawnParts parts;
  Image picture = drawScene(scene, instances, turn, parts);
  for (const auto& [name, more] : parts.seconds) addSeconds(seconds, name, more);
  if (extra) *extra = extraPictures(parts, cameraFor(scene, instances, turn.now), scene);
  return picture;
}

// While a cloud that changes fades from one mesh to another, two pictures are blended. Clouds that are at the same moment of a fade share
// them.
Image drawFades(const SceneFile& scene, std::vector<Instance> instances, const CameraTurn& turn, StageSeconds& seconds,
                std::vector<NamedFile>* extra) {
  const auto fading = std::find_if(instances.begin(), instances.end(), [](const Instance& one) { return one.before != nullptr; });
  if (fading == instances.end()) return drawWithoutFades(scene, instances, turn, seconds, extra);
  const float share = fading->before_share;
  std::vector<Instance> before = instances;
  for (size_t i = 0; i < instances.size(); ++i) {
    if (!instances[i].before || instances[i].before_share != share) continue;
    before[i].mesh = before[i].before.get();
    before[i].now = std::move(before[i].before);
    before[i].before = instances[i].before = nullptr;
  }
  const Image earlier = drawFades(scene, std::move(before), turn, seconds, nullptr);
  return blended(earlier, drawFades(scene, std::move(instances), turn, seconds, extra), share);
}

Image drawPicture(const SceneFile& scene, std::span<const Instance> instances, const CameraTurn& turn, StageSeconds& seconds,
                  std::vector<NamedFile>* extra) {
  return dithered(drawFades(scene, {instances.begin(), instances.end()}, turn, seconds, extra));
}

// --- Motion ---

std::filesystem::path frameFile(const std::filesystem::path& stem, size_t number) {
  return stem.string() + fmt::format("_{:04}.png", number);
}

// Draws and encodes frame by frame.
void drawFilm(const Scenery& scenery, const PictureSink& sink, Pictures& drawn, BakeReport& report, Stopwatch& watch) {
  const PictureSettings& view = scenery.scene.view;
  AnimatedPng animation(drawn.film.moments.size(), view.frames_per_second, sink.picture);
  for (size_t i = 0; i < drawn.film.moments.size(); ++i) {
    const Moment& moment = drawn.film.moments[i];
    const CameraTurn turn{moment.turn_degrees, moment.turn_before_degrees};
    const SceneFile scene = sceneAt(scenery, moment);
    const Image frame = drawPicture(scene, instancesAt(scenery, scene.view), turn, drawn.renderers, nullptr);
    watch.lap(report.seconds, "render");
    animation.add(frame);
    if (view.frames) sink.beside(frameFile(*view.frames, i + 1), encodePng(frame));
    watch.lap(report.seconds, "encode");
  }
  animation.end();
}

}  // namespace

std::string assetOf(const SceneCloud& cloud, uint64_t memory_limit, Warnings& warnings) {
  return cloud.file.empty() ? grownGlb(cloud, memory_limit, warnings).bytes : readFileBytes(cloud.file);
}

BakedMesh bakedMesh(const SourceSettings& from, std::span<const Given> given, BakeReport& report) {
  const BakedGlb baked = bakedGlb(from, isGrown(from.kind) ? std::optional(readGrownSource(from)) : std::nullopt, given, report);
  Warnings told;
  BakedMesh mesh = decodeColoredGlb(from.input, baked.bytes, told, baked.read);
  if (const auto colors = told.entries().find(WarningKind::kTextureIgnored); colors != told.entries().end())  // the bake told the others
    report.warnings.add(colors->first, colors->second.first, colors->second.count);
  return mesh;
}

Scenery readScenery(const Settings& settings, std::span<const Given> given, BakeReport& report) {
  return completed({}, settings, given, report);
}

Scenery bakeScenery(const Settings& settings, std::span<const Given> given, BakeReport& report) {
  const SourceSettings& source = settings.source;
  std::vector<Given> of_bake;
  std::copy_if(given.begin(), given.end(), std::back_inserter(of_bake), [](const Given& one) { return needsWatch(*one.option); });
  Scenery scenery;
  const auto isBaked = [&](const std::string& bytes) {
    return isBakedAsset(source.input, bytes) || isImpostor(bytes) || isSequence(bytes);
  };
  if (source.kind != SourceKind::kSculpt || !isBaked(readFileBytes(source.input)))
    scenery.meshes.emplace(source.input.string(), bakedMesh(source, of_bake, report));
  else if (!of_bake.empty())
    throw UsageError(fmt::format("--{}: {} is baked already, and is shown as it is: leave this out, or watch the sculpt",
                                 of_bake.front().option->name, source.input.string()));
  return completed(std::move(scenery), settings, given, report);
}

Image stillPicture(const Scenery& scenery, StageSeconds& seconds) {
  return drawPicture(scenery.scene, instancesAt(scenery, scenery.scene.view), {}, seconds, nullptr);
}

namespace {

Pictures allPictures(const Scenery& scenery, const PictureSink& sink, BakeReport& report, Stopwatch& watch) {
  Pictures drawn;
  if (scenery.scene.view.motion != Motion::kNone) {
    drawn.film = filmOf(scenery.scene, !scenery.instances.empty() || !scenery.fields.empty(), !scenery.sequences.empty());
    drawFilm(scenery, sink, drawn, report, watch);
    return drawn;
  }
  std::vector<NamedFile> beside;
  const std::vector<Instance> instances = instancesAt(scenery, scenery.scene.view);
  const Image picture = drawPicture(scenery.scene, instances, {}, drawn.renderers, &beside);
  watch.lap(report.seconds, "render");
  sink.picture(encodePng(picture));
  for (const auto& [file, bytes] : beside) sink.beside(file, bytes);
  watch.lap(report.seconds, "encode");
  return drawn;
}

}  // namespace

Pictures drawPictures(const Scenery& scenery, const PictureSink& sink, BakeReport& report, Stopwatch& watch) {
  return inStage("this picture", "use a smaller --size, or a scene with less in it",
                 [&] { return allPictures(scenery, sink, report, watch); });
}

}  // namespace cloudbake
