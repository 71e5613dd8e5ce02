#include "pipeline/plan/plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "core/error.h"
#include "core/parallel.h"
#include "core/portable_math.h"
#include "io/file/own_file.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/relabel.h"
#include "io/report/figures.h"
#include "pipeline/asset/levels.h"
#include "pipeline/options/run_files.h"
#include "pipeline/picture/picture.h"
#include "pipeline/plan/choose.h"
#include "pipeline/plan/planned_scene.h"
#include "pipeline/plan/ways.h"
#include "pipeline/scene/day.h"
#include "preview/compare/image_error.h"
#include "preview/mesh_clouds/levels.h"

namespace cloudbake {

namespace {

constexpr int kStops = 9;        // of a path
constexpr size_t kPictures = 3;  // that are drawn to correct a plan
// The painted look shows about so much of what Popping sees, which has no blur.
constexpr double kStart = 0.6;
constexpr int kRounds = 5;  // of corrections
constexpr float kSeenOpacity = 0.02F;

// An asset of the scene.
struct Asset {
  std::string name;  // of its files
  std::string key;   // keyOf
  const BakedMesh* full = nullptr;
  std::vector<MadeWay> ways;
};

// Where an instance is, and how large.
struct Extent {
  Box box;
  float longest_side = 0;
};

// A picture that the plan is for, at any hour.
struct View {
  std::optional<CameraPlace> place;  // unset: the scene's own camera
  Camera camera;
};

// One at one of the hours.
struct Picture {
  size_t view = 0, hour = 0;
  auto operator<=>(const Picture&) const = default;
};

std::vector<Vec3> stopsOn(std::span<const Vec3> path) {
  float whole = 0;
  for (size_t i = 1; i < path.size(); ++i) whole += length(path[i] - path[i - 1]);
  std::vector<Vec3> stops;
  for (int stop = 0; stop < kStops; ++stop) {
    float left = whole * float(stop) / (kStops - 1);
    Vec3 at = path.back();
    for (size_t i = 1; i < path.size(); ++i) {
      const Vec3 step = path[i] - path[i - 1];
      if (left <= length(step) && length(step) > 0) {
        at = path[i - 1] + step * (left / length(step));
        break;
      }
      left -= length(step);
    }
    stops.push_back(at);
  }
  return stops;
}

// The corners of the box and its centre.
std::vector<Vec3> stopsIn(const std::pair<Vec3, Vec3>& region) {
  Box box;
  box.add(region.first), box.add(region.second);
  std::vector<Vec3> stops{box.center()};
  for (int i = 0; i < 8; ++i)
    if (std::find(stops.begin(), stops.end(), box.corner(i)) == stops.end()) stops.push_back(box.corner(i));
  return stops;
}

class Planner {
 public:
  Planner(const Settings& settings, std::span<const Given> given, BakeReport& report, Stopwatch& watch)
      : settings_(settings), scenery_(readScenery(settings, given, report)), own_(sceneAt(scenery_, momentOf(std::nullopt))) {
    watch.lap(report.seconds, "read");
    all_ = instancesAt(scenery_, own_.view);
    for (Instance& instance : all_) instance.levels = {};
    extents_.resize(all_.size());
    parallelFor(all_.size(), [&](size_t i) { extents_[i] = {placedBox(all_[i]), longestStretched(all_[i])}; });
    nameAssets();
    if (assets_.empty()) throw InputError(settings.scene->string(), "the scene has no baked clouds to plan: add a [[cloud]] with its file");
    makeAllWays();
    watch.lap(report.seconds, "ways");
    setViews();
    for (const double hour : settings.plan.hours) hours_.emplace_back(hour);
    if (hours_.empty()) hours_.emplace_back();
  }

  ScenePlan plan(BakeReport& report, Stopwatch& watch) {
    chooseAndCompare();
    watch.lap(report.seconds, "choose");
    // A picture that turns out to change too much is watched from then on.
    constexpr int kMostWatched = 8;
    for (int i = 0; settings_.plan.measure && i <= kMostWatched; ++i) {
      if (const Picture worst = measureAll(); measured_[worst.view * hours_.size() + worst.hour] > settings_.plan.change)
        watched_.push_back(worst);
      else
        break;
      if (i < kMostWatched) chooseAndCompare();
    }
    if (settings_.plan.measure) watch.lap(report.seconds, "measure");
    requireBudget();
    ScenePlan scene;
    addFiles(scene);
    scene.text = text();
    scene.json = json();
    return scene;
  }

 private:
  Moment momentOf(const std::optional<double>& hour) const {
    const SceneFile& scene = scenery_.scene;
    Moment moment;
    moment.time_seconds = scene.view.time_seconds;
    if (!hour) return moment;
    Day day;
    day.hour = *hour;
    const SunAngles noon = scene.day ? scene.day->noon : SunAngles{scene.view.sun_azimuth_degrees, scene.view.sun_elevation_degrees};
    moment.sun = SunCircle(noon).anglesAt(day.degreesAt(0));
    return moment;
  }

  void nameAssets() {
    std::set<std::string> names;
    const auto add = [&](const SceneCloud& cloud) {
      const BakedMesh& mesh = scenery_.meshes.at(keyOf(cloud));
      if (mesh.impostor || asset_of_.contains(&mesh)) return;
      const std::string stem = cloud.file.empty() ? std::filesystem::path(cloud.preset).stem().string() : cloud.file.stem().string();
      std::string name = stem;
      for (int number = 2; !names.insert(name).second; ++number) name = stem + "_" + std::to_string(number);
      asset_of_[&mesh] = assets_.size();
      assets_.push_back({name, keyOf(cloud), &mesh, {}});
      clouds_.push_back(&cloud);
    };
    for (const SceneCloud& cloud : scenery_.scene.clouds) add(cloud);
    for (const SceneField& field : scenery_.scene.fields)
      for (const SceneCloud& cloud : field.clouds) add(cloud);
  }

  void makeAllWays() {
    WaysSettings ways;
    ways.packs = settings_.plan.change >= double(kMostPackedChange);
    ways.half_lambert = own_.light.half_lambert;
    ways.impostors = own_.light.lamps.empty() && scenery_.scene.lightning.empty() && scenery_.scene.lamps.empty();
    ways.memory_limit = settings_.source.memory_limit;
    parallelFor(assets_.size(), [&](size_t i) {
      Warnings told_before;
      const SceneCloud& cloud = *clouds_[i];
      assets_[i].ways = makeWays(cloud.file.empty() ? std::filesystem::path(cloud.preset + ".glb") : cloud.file,
                                 assetOf(cloud, ways.memory_limit, told_before), ways);
    });
    for (const Asset& asset : assets_)
      for (std::vector<DrawnWay>& drawn = drawn_.emplace_back(); const MadeWay& way : asset.ways) drawn.push_back(way.drawn());
  }

  // A camera that looks to all sides has so many views that they cover the horizon, each at the mean height of the clouds.
  void setViews() {
    std::vector<View> views;
    if (settings_.plan.path.empty() && !settings_.plan.region) {
      views.push_back({std::nullopt, cameraFor(own_, all_)});
    } else {
      const std::vector<Vec3> stops = settings_.plan.region ? stopsIn(*settings_.plan.region) : stopsOn(settings_.plan.path);
      const PictureSettings& view = own_.view;
      const double tangent = tanDegrees(double(view.field_of_view_degrees) / 2) * view.width / view.height;
      const int headings = std::max(3, int(std::ceil(180 / atan2Degrees(tangent, 1))));
      for (const Vec3& stop : stops) {
        double rise = 0;
        size_t count = 0;
        for (const Extent& extent : extents_) {
          const Vec3 there = extent.box.center() - stop;
          if (const float far = length(there); far > 0) rise += double(there.y / far), ++count;
        }
        const float elevation = count == 0 ? 0 : float(std::clamp(asinDegrees(std::clamp(rise / double(count), -1.0, 1.0)), -60.0, 60.0));
        for (int heading = 0; heading < headings; ++heading) {
          const CameraPlace place{stop, stop + directionFromAngles(360 * float(heading) / float(headings), elevation)};
          views.push_back({place, {place.look_from, place.look_at, view.field_of_view_degrees, view.width, view.height}});
        }
      }
    }
    for (View& view : views) {
      ViewCounts counts(assets_.size(), SizeCounts{});
      bool sees = false;
      for (size_t i = 0; i < all_.size(); ++i) {
        const auto asset = asset_of_.find(all_[i].mesh);
        if (asset == asset_of_.end() || !isInView(extents_[i].box, view.camera)) continue;
        ++counts[asset->second][stepOfSize(sizeIn(view, i))];
        sees = true;
      }
      if (!sees) continue;
      views_.push_back(view);
      counts_.push_back(std::move(counts));
    }
    if (views_.empty()) throw InputError(settings_.scene->string(), "no cloud is in any picture of the plan: move the camera nearer");
  }

  float sizeIn(const View& view, size_t instance) const {
    return pixelsAcross(extents_[instance].box, extents_[instance].longest_side, view.camera);
  }

  double pixels() const { return double(own_.view.width) * own_.view.height; }

  // The change that is measured corrects what the ways say, until the pictures are within the limit and not far below.
  void chooseAndCompare() {
    const double change = settings_.plan.change;
    const PlanBudget budget{change, settings_.plan.vertices, settings_.plan.bytes, settings_.plan.draws};
    double correction = kStart;
    std::optional<PlannedWays> accepted;
    std::vector<double> accepted_changes;
    std::optional<std::pair<double, double>> within, beyond;  // corrections and what was measured with them
    for (int round = 0; round < kRounds; ++round) {
      take(chooseWays(drawn_, counts_, budget, pixels(), correction));
      compare();
      const double measured = mostMeasured();
      const bool is_within = measured <= change;
      if (is_within && (!accepted || plan_.cost.vertices < accepted->cost.vertices)) accepted = plan_, accepted_changes = measured_;
      (is_within ? within : beyond) = {correction, measured};
      constexpr double kNear = 0.85, kAim = 0.95, kClose = 1.03;
      if (is_within && measured >= kNear * change) break;
      const double wanted = std::max(kAim * change, 1e-3), found = std::max(measured, 1e-3);
      correction *= std::clamp(found / wanted, 0.4, 4.0);
      if (within && beyond) {  // between the two, the change is a power of the correction
        const double near = within->first, least = std::max(within->second, 1e-3);
        const double far = beyond->first, most = beyond->second;
        if (near / far < kClose) break;
        correction = near * portablePow(far / near, std::clamp(portableLog(wanted / least) / portableLog(most / least), 0.1, 0.9));
      }
    }
    if (!accepted) {  // the full assets change nothing but what packing does
      take(chooseWays(drawn_, counts_, budget, pixels(), 1e6));
      compare();
      return;
    }
    take(std::move(*accepted));
    measured_ = accepted_changes;
  }

  // Compares all pictures, and returns the one that changes most.
  Picture measureAll() {
    measured_.clear();
    Picture worst;
    double most = -1;
    for (size_t view = 0; view < views_.size(); ++view)
      for (size_t hour = 0; hour < hours_.size(); ++hour) {
        measured_.push_back(changeOf({view, hour}));
        if (measured_.back() > most) most = measured_.back(), worst = {view, hour};
      }
    return worst;
  }

  void compare() {
    measured_.clear();
    for (const Picture& picture : worstPictures()) measured_.push_back(changeOf(picture));
  }

  // The pictures whose changes are said to be largest, each at another hour, and those that are watched.
  std::vector<Picture> worstPictures() const {
    std::vector<size_t> order(views_.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return plan_.changes[a] > plan_.changes[b]; });
    std::vector<Picture> pictures;
    const size_t views = views_.size(), count = std::min(kPictures, views * hours_.size());
    for (size_t i = 0; pictures.size() < count; ++i) {
      const Picture picture{order[i % views], (i % views + i / views) % hours_.size()};
      if (std::find(pictures.begin(), pictures.end(), picture) == pictures.end()) pictures.push_back(picture);
    }
    for (const Picture& picture : watched_)
      if (std::find(pictures.begin(), pictures.end(), picture) == pictures.end()) pictures.push_back(picture);
    return pictures;
  }

  // Labels the ways with the sizes of a plan.
  void take(PlannedWays plan) {
    plan_ = std::move(plan);
    drawn_meshes_.clear();
    for (size_t a = 0; a < assets_.size(); ++a) {
      std::vector<const BakedMesh*>& meshes = drawn_meshes_.emplace_back();
      for (const size_t way : waysOf(a)) {
        assets_[a].ways[way].mesh.info.switch_pixels = plan_.switch_pixels[a][way];
        meshes.push_back(&assets_[a].ways[way].mesh);
      }
    }
  }

  std::vector<size_t> waysOf(size_t asset) const { return usedWays(plan_.switch_pixels[asset]); }

  double mostMeasured() const { return *std::max_element(measured_.begin(), measured_.end()); }

  // The full clouds as a view sees them.
  std::vector<Instance> seenBy(const View& view) const {
    std::vector<Instance> instances = all_;
    for (size_t i = 0; i < instances.size(); ++i) instances[i].is_seen = isInView(extents_[i].box, view.camera);
    return instances;
  }

  std::vector<Instance> planned(std::vector<Instance> instances) const {
    for (Instance& instance : instances) {
      const auto found = asset_of_.find(instance.mesh);
      if (found == asset_of_.end()) continue;
      instance.sized_as = instance.mesh;
      const std::span<const BakedMesh* const> meshes = drawn_meshes_[found->second];
      instance.mesh = meshes.front();
      instance.levels = meshes.subspan(1);
    }
    return instances;
  }

  struct Drawn {
    Image picture;
    PixelMask clouds;
  };

  Drawn drawn(const SceneFile& scene, std::span<const Instance> instances) const {
    DrawnParts parts;
    Drawn drawn{drawScene(scene, instances, {}, parts), {}};
    const Image4& channels = parts.steps.back().channels;
    for (int y = 0; y < drawn.picture.height; ++y)
      for (int x = 0; x < drawn.picture.width; ++x)
        drawn.clouds.push_back(channels.at(x * channels.width / drawn.picture.width, y * channels.height / drawn.picture.height)[2] >
                               kSeenOpacity);
    return drawn;
  }

  SceneFile sceneOf(const Picture& picture) const {
    SceneFile scene = sceneAt(scenery_, momentOf(hours_[picture.hour]));
    if (const auto& place = views_[picture.view].place) {
      scene.camera = place;
      scene.camera_path = false;
      scene.camera_distance.reset();
      scene.camera_roll_degrees = 0;
    }
    scene.compares_techniques = false;
    return scene;
  }

  // The rms of the 8-bit values over the pixels that show clouds.
  double changeOf(const Picture& picture) {
    const SceneFile scene = sceneOf(picture);
    const auto [known, is_new] = full_.try_emplace(picture);
    const std::vector<Instance> instances = seenBy(views_[picture.view]);
    if (is_new) known->second = drawn(scene, instances);
    Drawn other = drawn(scene, planned(instances));
    for (size_t i = 0; i < other.clouds.size(); ++i) other.clouds[i] |= known->second.clouds[i];
    const double change = 255 * imageRms(known->second.picture, other.picture, other.clouds);
    if (full_.size() > kMostKept) full_.erase(full_.begin());
    return change;
  }

  void requireBudget() const {
    const auto require = [&](const char* what, const std::optional<double>& limit, double cost) {
      if (!limit || cost <= *limit) return;
      throw Error(ExitCode::kBound, settings_.scene->string(), 0, 0,
                  fmt::format("within a change of {:g}/255 the scene costs {:.0f} {}, and --budget allows {:.0f}: allow more of them or a "
                              "larger change, such as --budget change={:g}",
                              settings_.plan.change, cost, what, *limit, 2 * settings_.plan.change));
    };
    require("vertices", settings_.plan.vertices, plan_.cost.vertices);
    require("bytes", settings_.plan.bytes, plan_.cost.bytes);
    require("draws", settings_.plan.draws, plan_.cost.draws);
    const double measured = mostMeasured();
    if (measured > settings_.plan.change)
      throw Error(ExitCode::kBound, settings_.scene->string(), 0, 0,
                  fmt::format("a picture changes by {:.2f}/255, and {:g} is allowed: allow a larger change (--budget change=N)", measured,
                              settings_.plan.change));
  }

  void addFiles(ScenePlan& scene) const {
    const std::filesystem::path& folder = settings_.output.file;
    std::map<std::string, PlannedCloud> clouds;
    for (size_t a = 0; a < assets_.size(); ++a) {
      const Asset& asset = assets_[a];
      const std::vector<size_t> ways = waysOf(a);
      for (size_t level = 0; level < ways.size(); ++level) {
        const MadeWay& way = asset.ways[ways[level]];
        const LevelLabel label{int(level), plan_.switch_pixels[a][ways[level]], asset.ways[ways.front()].mesh.info.input_hash};
        scene.files.push_back({folder / fileOf(a, level), relabelled(fileOf(a, level), way.glb, label)});
      }
      clouds[asset.key] = {fileOf(a, 0), ways.size() > 1};
      const auto stale = staleLevels(folder / fileOf(a, 0), ways.size() - 1);
      scene.stale.insert(scene.stale.end(), stale.begin(), stale.end());
    }
    PlannedSizes sizes;
    if (!own_.camera && !own_.camera_path) {
      const Camera camera = cameraFor(own_, all_);
      sizes.camera = CameraPlace{camera.look_from, camera.look_at};
    }
    std::vector<Instance> bases = planned(all_);
    for (Instance& instance : bases) instance.sized_as = nullptr;
    sizes.far_distance = double(depthRangeOf(own_.post, all_).far);
    sizes.detail_factor = double(meanLongestSide(all_)) / double(meanLongestSide(bases));
    const std::string text = plannedScene(*settings_.scene, readFileBytes(*settings_.scene), folder, clouds, sizes);
    scene.files.push_back({folder / "scene.toml", text});
    std::set<std::filesystem::path> inputs{std::filesystem::weakly_canonical(*settings_.scene)};
    for (const SceneCloud* cloud : clouds_)
      if (!cloud->file.empty()) inputs.insert(std::filesystem::weakly_canonical(cloud->file));
    for (const ScenePlan::File& file : scene.files) {
      if (inputs.contains(std::filesystem::weakly_canonical(file.file)))
        throw UsageError(fmt::format("-o {}: the plan would replace {}, which it is made from: choose another folder", folder.string(),
                                     file.file.string()));
      if (!settings_.run.force && isForeignFile(file.file)) throw UsageError("-o: " + foreignFile(file.file));
    }
  }

  std::string costText(const PlanCost& cost) const {
    return fmt::format("{:.0f} vertices and {:.0f} draws in a picture, {:.0f} bytes", cost.vertices, cost.draws, cost.bytes);
  }

  // Of the full asset or of a level.
  std::string fileOf(size_t asset, size_t level) const {
    const std::string full = assets_[asset].name + ".glb";
    return level == 0 ? full : levelFile(full, level).string();
  }
  std::string fileAt(size_t asset, float pixels) const {
    const std::vector<size_t> ways = waysOf(asset);
    return fileOf(asset, size_t(std::find(ways.begin(), ways.end(), wayAt(plan_.switch_pixels[asset], pixels)) - ways.begin()));
  }

  std::string text() const {
    std::string text =
        figureLine("plan", "{} clouds of {} assets in {} pictures", all_.size(), assets_.size(), views_.size() * hours_.size());
    text += figureLine("in full", "{}", costText(costOfFull(drawn_, counts_)));
    text += figureLine("planned", "{}", costText(plan_.cost));
    text += figureLine("change", "{:.2f}/255, the most of {} pictures that were compared; {:g} is allowed", mostMeasured(),
                       measured_.size(), settings_.plan.change);
    for (size_t a = 0; a < assets_.size(); ++a)
      for (const size_t way : waysOf(a)) {
        const DrawnWay& drawn = drawn_[a][way];
        const bool is_finest = way == waysOf(a).front();
        text += figureLine(is_finest ? assets_[a].name : "", "{:16} {:7} {}, {} bytes",
                           is_finest ? "else" : fmt::format("up to {} pixels", plan_.switch_pixels[a][way]), drawn.vertices,
                           drawn.is_picture ? "vertices (impostor)" : "vertices", drawn.bytes);
      }
    return text;
  }

  static Json costJson(const PlanCost& cost) { return {{"vertices", cost.vertices}, {"draws", cost.draws}, {"bytes", cost.bytes}}; }

  Json json() const {
    Json assets = Json::array();
    for (size_t a = 0; a < assets_.size(); ++a) {
      Json ways = Json::array();
      const std::vector<size_t> used = waysOf(a);
      for (size_t level = 0; level < used.size(); ++level) {
        const DrawnWay& drawn = drawn_[a][used[level]];
        ways.push_back({{"file", fileOf(a, level)},
                        {"vertices", drawn.vertices},
                        {"bytes", drawn.bytes},
                        {"impostor", drawn.is_picture},
                        {"packed", assets_[a].ways[used[level]].mesh.info.density_max > 0},
                        {"switch_pixels", plan_.switch_pixels[a][used[level]]}});
      }
      assets.push_back({{"name", assets_[a].name}, {"from", assets_[a].key}, {"ways", ways}});
    }
    // The largest size of each cloud, and how it is drawn there and where it is smallest.
    Json clouds = Json::array();
    for (size_t i = 0; i < all_.size(); ++i) {
      const auto asset = asset_of_.find(all_[i].mesh);
      if (asset == asset_of_.end()) continue;
      float largest = 0, smallest = INFINITY;
      for (const View& view : views_) {
        if (!isInView(extents_[i].box, view.camera)) continue;
        const float size = sizeIn(view, i);
        largest = std::max(largest, size), smallest = std::min(smallest, size);
      }
      if (largest == 0) continue;
      clouds.push_back({{"asset", assets_[asset->second].name},
                        {"largest_pixels", std::isfinite(largest) ? Json(std::round(largest)) : Json("inside")},
                        {"near", fileAt(asset->second, largest)},
                        {"far", fileAt(asset->second, smallest)}});
    }
    return {{"change_allowed", settings_.plan.change},
            {"change_expected", plan_.change},
            {"change_measured", mostMeasured()},
            {"pictures", views_.size() * hours_.size()},
            {"pictures_measured", measured_.size()},
            {"full", costJson(costOfFull(drawn_, counts_))},
            {"planned", costJson(plan_.cost)},
            {"assets", assets},
            {"clouds", clouds}};
  }

  static constexpr size_t kMostKept = 4 * kPictures;

  const Settings& settings_;
  const Scenery scenery_;
  const SceneFile own_;
  std::vector<Instance> all_;    // full
  std::vector<Extent> extents_;  // of all_
  std::vector<Asset> assets_;
  std::vector<const SceneCloud*> clouds_;  // the first of each asset
  std::map<const BakedMesh*, size_t> asset_of_;
  std::vector<std::vector<DrawnWay>> drawn_;
  std::vector<View> views_;
  std::vector<ViewCounts> counts_;  // of each view
  std::vector<std::optional<double>> hours_;
  PlannedWays plan_;
  std::vector<std::vector<const BakedMesh*>> drawn_meshes_;  // of each asset, from fine to coarse, as plan_ says
  std::vector<double> measured_;
  std::vector<Picture> watched_;
  std::map<Picture, Drawn> full_;
};

}  // namespace

ScenePlan planScene(const Settings& settings, std::span<const Given> given, BakeReport& report, Stopwatch& watch) {
  Planner planner(settings, given, report, watch);
  ScenePlan plan = planner.plan(report, watch);
  watch.lap(report.seconds, "encode");
  return plan;
}

}  // namespace cloudbake
