#include "pipeline/plan/ways.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/error.h"
#include "core/parallel.h"
#include "core/text/json.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/decode.h"
#include "io/gltf/asset/own_colors.h"
#include "io/gltf/asset/write.h"
#include "io/gltf/impostor/impostor_file.h"
#include "io/sculpt/read_mesh.h"
#include "pipeline/asset/asset.h"
#include "pipeline/asset/levels.h"
#include "pipeline/impostor/impostor.h"
#include "pipeline/options/version.h"
#include "pipeline/picture/cloud_cache.h"
#include "pipeline/sources/sculpt.h"

namespace cloudbake {

namespace {

constexpr double kLevelShares[] = {0.5, 0.25, 0.1, 0.04, 0.015};  // of the vertices
constexpr size_t kFewestVertices = 40;                            // of a level
constexpr int kImpostorViews = 9, kImpostorFrame = 32;

Settings settingsOf(const std::filesystem::path& file, const WaysSettings& ways, bool is_packed) {
  Settings settings;
  settings.source.input = file;
  settings.source.memory_limit = settings.mesh.memory_limit = settings.source.read.memory_limit = ways.memory_limit;
  settings.output.gltf.pack = is_packed;
  settings.output.file = "way.glb";  // names levels in messages
  settings.impostor.of = ImpostorOf::kMesh;
  settings.impostor.views = kImpostorViews, settings.impostor.frame = kImpostorFrame;
  settings.impostor.half_lambert = ways.half_lambert;
  return settings;
}

BakedMesh meshOf(const std::filesystem::path& file, const std::string& glb, uint64_t memory_limit) {
  if (isImpostor(glb)) return boxWithImpostor(decodeImpostor(file, glb, memory_limit));
  ReadSettings read;
  read.memory_limit = memory_limit;
  Warnings told_for_the_asset;
  return decodeColoredGlb(file, glb, told_for_the_asset, read);
}

bool isWhite(const BakedMesh& mesh) {
  const std::vector<Vec3> colors = ownColors(mesh);
  return std::all_of(colors.begin(), colors.end(), [](const Vec3& color) { return color == Vec3{1, 1, 1}; });
}

class Maker {
 public:
  Maker(const std::filesystem::path& file, const std::string& glb, const WaysSettings& settings)
      : file_(file),
        glb_(glb),
        settings_(settings),
        full_(meshOf(file, glb, settings.memory_limit)),
        popping_(full_, settings.half_lambert) {
    ReadSettings read;
    read.memory_limit = settings.memory_limit;
    Sculpt sculpt = readMesh(file, glb, read, told_.warnings);
    told_.info = full_.info;
    cloud_ = cloudOfSculpt(std::move(sculpt), settingsOf(file, settings, false).mesh, told_, watch_);
    told_.info = full_.info;
    if (cloud_.surface.positions.size() != full_.lobes.size())
      throw InputError(file.string(), "its meshes are not those that its lobes are of: bake it again");
  }

  std::vector<MadeWay> all() {
    std::vector<MadeWay> ways{finest()};
    const bool is_packed = ways.front().mesh.info.density_max > 0;
    const auto add = [&](MadeWay way) {
      if (way.drawn().vertices < ways.back().drawn().vertices) ways.push_back(std::move(way));
    };
    for (LevelAsset& level : levels(is_packed)) {
      BakedMesh mesh = meshOf(file_, level.glb, settings_.memory_limit);
      add({std::move(level.glb), std::move(mesh), std::move(level.changes)});
    }
    if (auto glb = impostor()) add(compared(std::move(*glb)));
    return ways;
  }

 private:
  MadeWay compared(std::string glb) const {
    MadeWay way{std::move(glb), {}, {}};
    way.mesh = meshOf(file_, way.glb, settings_.memory_limit);
    way.changes = popping_.changesBy(way.mesh);
    return way;
  }

  MadeWay finest() {
    if (full_.info.density_max > 0 || !settings_.packs) return {glb_, full_, {}};
    const GltfSettings gltf = settingsOf(file_, settings_, true).output.gltf;
    MadeWay packed =
        compared(encodeGlb(cloud_.sculpt, lobesPerPart(cloud_.sculpt, full_.lobes), full_.info, gltf, told_.warnings, full_.harmonics));
    const auto is_slight = [&](const SizeChange& change) { return change.rms <= kMostPackedChange; };
    if (std::all_of(packed.changes.begin(), packed.changes.end(), is_slight)) return packed;
    return {glb_, full_, {}};
  }

  std::vector<LevelAsset> levels(bool is_packed) {
    Settings settings = settingsOf(file_, settings_, is_packed);
    for (const double share : kLevelShares)
      if (share * double(full_.lobes.size()) >= kFewestVertices) settings.mesh.levels.push_back({share, true});
    if (settings.mesh.levels.empty()) return {};
    return makeLevels(cloud_, full_.lobes, full_.harmonics, settings, told_, watch_);
  }

  std::optional<std::string> impostor() {
    if (!settings_.impostors || !isWhite(full_)) return std::nullopt;
    const ImpostorSubject subject{full_, cloud_, hashBytes(glb_)};
    const BakedImpostor baked = bakeImpostor(subject, settingsOf(file_, settings_, false), told_, watch_);
    return encodeImpostor(baked.impostor, billboardOf(baked.impostor)).glb;
  }

  const std::filesystem::path& file_;
  const std::string& glb_;
  const WaysSettings& settings_;
  BakedMesh full_;
  Popping popping_;
  Cloud cloud_;
  BakeReport told_;  // the asset's own bake has told all of it
  Stopwatch watch_;
};

// What the cache keeps: a line of JSON with the changes and the sizes of the files, then the files.
std::string packedWays(const std::vector<MadeWay>& ways) {
  Json json = Json::array();
  std::string bytes;
  for (const MadeWay& way : ways) {
    Json changes = Json::array();
    for (const SizeChange& change : way.changes) changes.push_back({change.pixels, change.rms});
    json.push_back({{"bytes", way.glb.size()}, {"changes", changes}});
    bytes += way.glb;
  }
  return json.dump() + "\n" + bytes;
}

std::vector<MadeWay> unpackedWays(const std::filesystem::path& file, const std::string& kept, uint64_t memory_limit) {
  const size_t line = kept.find('\n');
  const Json json = parseJson(std::string_view(kept).substr(0, line)).value();
  std::vector<MadeWay> ways;
  for (size_t first = line + 1; const Json& one : json) {
    const auto size = one.at("bytes").get<size_t>();
    MadeWay& way = ways.emplace_back(MadeWay{kept.substr(first, size), {}, {}});
    for (const Json& change : one.at("changes")) way.changes.push_back({change.at(0).get<float>(), change.at(1).get<float>()});
    first += size;
  }
  parallelFor(ways.size(), [&](size_t i) { ways[i].mesh = meshOf(file, ways[i].glb, memory_limit); });
  return ways;
}

}  // namespace

DrawnWay MadeWay::drawn() const {
  return {mesh.impostor ? 4 : mesh.surface.positions.size(), glb.size(), changes, mesh.impostor != nullptr};
}

std::vector<MadeWay> makeWays(const std::filesystem::path& file, const std::string& glb, const WaysSettings& settings) {
  const CloudCache cache(cloudCacheFolder());
  const std::string key =
      hashBytes(fmt::format("{}ways {} {} {} {}", buildHash(), hashBytes(glb), settings.packs, settings.half_lambert, settings.impostors));
  if (const auto kept = cache.find(key)) return unpackedWays(file, *kept, settings.memory_limit);
  std::vector<MadeWay> ways = Maker(file, glb, settings).all();
  cache.add(key, packedWays(ways));
  return ways;
}

}  // namespace cloudbake
