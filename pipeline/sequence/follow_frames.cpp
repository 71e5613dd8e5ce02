#include "pipeline/sequence/follow_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "bake/field/level_set.h"
#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/smooth_lobes.h"
#include "bake/mesh/surface.h"
#include "core/error.h"
#include "core/parallel.h"
#include "io/file/input_files.h"
#include "io/file/write_file.h"
#include "io/sculpt/referenced_files.h"
#include "pipeline/asset/asset.h"
#include "pipeline/options/version.h"
#include "pipeline/picture/cloud_cache.h"
#include "pipeline/sources/grown.h"

namespace cloudbake {

namespace {

constexpr size_t kDefaultVertices = 3000;

// --- Records: what is kept of a frame ---

struct Record {
  std::vector<Triangle> triangles;
  std::vector<Vec3> positions;
  std::vector<Lobe> lobes;
  FollowFigures figures;
  SurfaceTopology topology;
  Warnings warnings;
  bool was_kept = false;
};

template <class T>
void append(std::string& bytes, const std::vector<T>& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

std::string bytesOf(const Record& record) {
  const FollowFigures& f = record.figures;
  Json head = {{"triangles", record.triangles.size()},
               {"vertices", record.positions.size()},
               {"figures", {f.distance.rms, f.distance.largest, f.missed, f.folded, f.volume}},
               {"topology", {record.topology.shells, record.topology.handles}},
               {"warnings", Json::array()}};
  for (const auto& [kind, entry] : record.warnings.entries()) head["warnings"].push_back({int(kind), entry.count, entry.first});
  std::string bytes = head.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
  append(bytes, record.triangles);
  append(bytes, record.positions);
  append(bytes, record.lobes);
  return bytes;
}

// The cache has hashes of its files, so that the bytes are those of bytesOf.
Record recordOf(const std::string& bytes) {
  const size_t line = bytes.find('\n');
  const Json head = Json::parse(bytes.substr(0, line));
  Record record;
  record.triangles.resize(head.at("triangles").get<size_t>());
  record.positions.resize(head.at("vertices").get<size_t>());
  record.lobes.resize(record.positions.size());
  const char* at = bytes.data() + line + 1;
  const auto take = [&at](auto& values) {
    const size_t size = values.size() * sizeof(values.front());
    if (size > 0) std::memcpy(values.data(), at, size);
    at += size;
  };
  take(record.triangles), take(record.positions), take(record.lobes);
  const Json& f = head.at("figures");
  record.figures = {{f.at(0), f.at(1)}, f.at(2), f.at(3), f.at(4)};
  record.topology = {head.at("topology").at(0), head.at("topology").at(1)};
  for (const Json& warning : head.at("warnings"))
    record.warnings.add(WarningKind(warning.at(0).get<int>()), warning.at(2).get<std::string>(), warning.at(1).get<uint64_t>());
  record.was_kept = true;
  return record;
}

// --- Frames as they are read ---

struct LoadedFrame {
  Cloud cloud;
  Settings settings;
  SurfaceMesh outer;
  SurfaceTopology topology;
  Warnings warnings;
  std::string hash;                       // of the file
  std::optional<IntegrationField> field;  // once lobes are baked on it
};

class Frames {
 public:
  /// `is_followed`: with the surfaces that a mesh follows.
  Frames(const std::vector<FrameInput>& inputs, const Settings& settings, std::span<const Given> given, bool is_followed)
      : inputs_(inputs), settings_(settings), given_(given.begin(), given.end()), is_followed_(is_followed) {}

  LoadedFrame& at(size_t i) {
    prefetch({&i, 1});
    return *loaded_.at(i);
  }

  // Reads several frames at a time.
  void prefetch(std::span<const size_t> wanted) {
    std::vector<size_t> missing;
    for (const size_t i : wanted)
      if (!loaded_.contains(i)) missing.push_back(i);
    std::vector<std::unique_ptr<LoadedFrame>> fresh(missing.size());
    parallelForAll(missing.size(), [&](size_t k) { fresh[k] = load(inputs_[missing[k]]); });
    for (size_t k = 0; k < missing.size(); ++k) {
      if (const auto known = hashes_.find(missing[k]);
          known != hashes_.end() && !inputs_[missing[k]].file.empty() && known->second.own != fresh[k]->hash)
        throw changedWhileRead(inputs_[missing[k]].file);
      loaded_.emplace(missing[k], std::move(fresh[k]));
    }
  }

  void dropBefore(size_t i) { loaded_.erase(loaded_.begin(), loaded_.lower_bound(i)); }

  // Of all that a frame is made of.
  const std::string& hashOf(size_t i) {
    const auto found = hashes_.find(i);
    return (found != hashes_.end() ? found->second : hashes_.emplace(i, hashed(inputs_[i])).first->second).all;
  }

 private:
  struct Hashes {
    std::string own, all;
  };

  std::unique_ptr<LoadedFrame> load(const FrameInput& input) const {
    auto frame = std::make_unique<LoadedFrame>();
    BakeReport report;
    Settings reading = settings_;
    reading.source.read.read_file = [&](const std::filesystem::path& file) {
      std::string bytes = settings_.source.read.read_file(file);
      if (file == input.file) frame->hash = hashBytes(bytes);
      return bytes;
    };
    auto [cloud, field] = readFrame(input, reading, given_, report);
    frame->cloud = std::move(cloud);
    frame->settings = settings_;
    frame->settings.field = field;
    if (!frame->cloud.solid())
      throw InputError(input.name, "the mesh encloses nothing, so that it cannot be followed: close it, or give --close wrap");
    if (is_followed_) takeSurface(input, *frame, report.warnings);
    frame->warnings = report.warnings;
    return frame;
  }

  void takeSurface(const FrameInput& input, LoadedFrame& frame, Warnings& warnings) const {
    const double size = boundingBox(*frame.cloud.solid()).longestSide();
    const LevelSet whole = levelSetOf(frame.cloud, frame.settings.field, Lattice::kSurface, warnings);
    const LevelSet plain = withoutDetail(whole, settings_.sequence.detail.resolve(float(size)) / whole.frame.voxel_size);
    frame.outer = outerShells(meshFromLevelSet(plain, {}, warnings));
    if (frame.outer.triangles.empty())
      throw InputError(input.name, "nothing is left of it without thin parts: give a smaller --detail, or leave the frame out");
    frame.topology = topologyOf(frame.outer);
  }

  Hashes hashed(const FrameInput& input) {
    if (input.file.empty()) {
      std::string made_from = readGrownSource(settings_.source).bytes;
      for (const Given& one : input.varied) made_from += fmt::format("\n{}={}", one.option->name, one.value);
      const std::string hash = hashBytes(made_from);
      return {hash, hash};
    }
    const auto found = of_files_.find(input.file);
    Hashes hashes = found != of_files_.end() ? found->second : of_files_.emplace(input.file, hashedFile(input.file)).first->second;
    if (input.moment) hashes.all = hashBytes(fmt::format("{} {} {}", hashes.all, input.moment->seconds, input.moment->animation));
    return hashes;
  }

  Hashes hashedFile(const std::filesystem::path& file) const {
    const std::string bytes = settings_.source.read.read_file(file);
    Hashes hashes{hashBytes(bytes), ""};
    std::string all = hashes.own;
    if (canReferToFiles(file))
      for (const auto& named : referencedFiles(file, bytes, settings_.source.read)) {
        std::error_code error;
        if (std::filesystem::is_regular_file(named, error)) all += hashBytes(settings_.source.read.read_file(named));
      }
    hashes.all = hashBytes(all);
    return hashes;
  }

  const std::vector<FrameInput>& inputs_;
  const Settings& settings_;
  std::vector<Given> given_;
  bool is_followed_;
  std::map<size_t, std::unique_ptr<LoadedFrame>> loaded_;
  std::map<size_t, Hashes> hashes_;
  std::map<std::filesystem::path, Hashes> of_files_;
};

// --- What is the same for all frames ---

struct Held {
  Settings settings;
  AssetInfo info;
  std::string text;  // for the keys of records
};

SurfaceMesh reduced(const SurfaceMesh& outer, const Settings& settings, Warnings& warnings) {
  SurfaceMesh mesh = outer;
  const size_t vertices = settings.mesh.vertices.value_or(kDefaultVertices);
  if (mesh.positions.size() > vertices) reduceVertices(mesh, vertices, warnings);
  return mesh;
}

// Whether an option only counts once the frames have been followed and baked.
bool isAfterFollowing(const Option& option) {
  constexpr std::string_view kNames[] = {"fps", "change", "pixels", "fade", "loop", "as"};
  return isOfSequence(option) && std::find(std::begin(kNames), std::end(kNames), option.name) != std::end(kNames);
}

// The largest of the first, the middle and the last frame decides.
Held heldSettings(const std::vector<FrameInput>& inputs, const Settings& settings, std::span<const Given> given, BakeReport& report,
                  Stopwatch& watch) {
  Frames frames(inputs, settings, given, false);
  const std::vector<size_t> probes{0, inputs.size() / 2, inputs.size() - 1};
  frames.prefetch(probes);
  size_t largest = 0;
  Held held{settings, {}, {}};
  for (const size_t probe : probes) {
    const LoadedFrame& frame = frames.at(probe);
    if (boundingBox(frame.cloud.surface).longestSide() > boundingBox(frames.at(largest).cloud.surface).longestSide()) largest = probe;
    auto& iso = held.settings.source.volume.iso;
    if (frame.cloud.iso && !settings.source.volume.iso) iso = std::min(iso.value_or(*frame.cloud.iso), *frame.cloud.iso);
  }
  watch.lap(report.seconds, "read");
  LoadedFrame& frame = frames.at(largest);
  BakeReport probe_report;
  probe_report.input = inputs[largest].name;
  BakeParameters parameters = resolveParameters(frame.cloud, frame.settings, probe_report, watch);
  Warnings not_of_the_sequence;
  Cloud points;
  points.surface = reduced(outerShells(*frame.cloud.solid()), settings, not_of_the_sequence);
  const IntegrationField field = fieldOfCloud(frame.cloud, frame.settings, parameters, probe_report, watch);
  parameters.shape = lobesAt(points.surface, field, settings.lobe, parameters, not_of_the_sequence).shape;
  held.info = probe_report.info;
  held.info.field = field.kind;
  held.info.shape = parameters.shape;
  LobeSettings& lobe = held.settings.lobe;
  lobe.fit_exponent = lobe.fit_bias = false;
  lobe.exponent = parameters.shape.exponent, lobe.bias = Length{parameters.shape.bias, false};
  lobe.extinction_range =
      lobe.fit ? std::pair(parameters.extinction_low, parameters.extinction_high) : std::pair(parameters.extinction, parameters.extinction);
  held.text = buildHash() + writeInfo(held.info).dump() +
              fmt::format(" {} {}", points.surface.positions.size(), held.settings.source.volume.iso.value_or(0));
  for (const Given& one : given)
    if (!(one.option->bits & kOfRun) && !isAfterFollowing(*one.option)) held.text += fmt::format("\n{}={}", one.option->name, one.value);
  watch.lap(report.seconds, "parameters");
  return held;
}

// --- Following ---

class Follower {
 public:
  Follower(const std::vector<FrameInput>& inputs, const Held& held, std::span<const Given> given, BakeReport& report, Stopwatch& watch)
      : inputs_(inputs),
        held_(held),
        frames_(inputs, held.settings, given, true),
        cache_(cloudCacheFolder()),
        report_(report),
        watch_(watch) {}

  std::vector<FollowedSegment> follow() {
    begin(0, 0);
    const size_t together = std::max<size_t>(2, threadCount());
    for (size_t first = 0; first < inputs_.size(); first += together) {
      const size_t end = std::min(inputs_.size(), first + together);
      prefetchUnkept(std::max<size_t>(first, 1), end);
      for (size_t i = std::max<size_t>(first, 1); i < end; ++i) step(i);
      bakeLobes();
      frames_.dropBefore(end - std::min(end, size_t(held_.settings.sequence.fade) + 1));
    }
    return std::move(segments_);
  }

  std::string hashOfAll() {
    std::string all;
    for (size_t i = 0; i < inputs_.size(); ++i) all += frames_.hashOf(i);
    return hashBytes(all);
  }

 private:
  // A segment and where its last frame came from.
  struct Front {
    FollowingMesh mesh;
    std::string key;
    size_t began = 0;  // at this frame
  };
  struct Place {
    size_t segment = 0, at = 0;
    std::string key;
  };

  // Reads frames that will be followed, if the segment goes on.
  void prefetchUnkept(size_t first, size_t end) {
    std::vector<size_t> unkept;
    std::string key = front_->key;
    for (size_t i = first; i < end; ++i) {
      key = keyAfter(key, i);
      if (!cache_.find(key)) unkept.push_back(i);
    }
    frames_.prefetch(unkept);
    watch_.lap(report_.seconds, "read");
  }

  std::string keyAfter(const std::string& key, size_t i) { return hashBytes(key + frames_.hashOf(i)); }

  void keep(size_t segment, size_t i, Record record, bool at_front, const std::string& key) {
    for (const auto& [kind, entry] : record.warnings.entries())
      report_.warnings.add(kind, inputs_[i].name + ": " + entry.first, entry.count);
    FollowedFrame frame{
        i, {inputs_[i].frame, std::move(record.positions), {}, std::move(record.lobes)}, record.figures, record.topology, record.was_kept};
    std::vector<FollowedFrame>& all = segments_[segment].frames;
    const auto at = at_front ? all.insert(all.begin(), std::move(frame)) : all.insert(all.end(), std::move(frame));
    if (at_front)
      for (Place& place : unbaked_) place.at += place.segment == segment;
    if (!record.was_kept) unbaked_.push_back({segment, size_t(at - all.begin()), key});
  }

  // Starts a segment with the surface of a frame, and follows it back to the frames before.
  void begin(size_t i, size_t fade) {
    const std::string key = hashBytes(held_.text + frames_.hashOf(i));
    Record record;
    if (const auto kept = cache_.find(key)) {
      record = recordOf(*kept);
    } else {
      LoadedFrame& frame = frames_.at(i);
      SurfaceMesh mesh = reduced(frame.outer, held_.settings, frame.warnings);
      FollowingMesh start(std::move(mesh));
      record.figures = start.follow(frame.outer);
      record.triangles = start.mesh().triangles;
      record.positions = start.mesh().positions;
      record.topology = frame.topology;
      record.warnings = frame.warnings;
    }
    segments_.push_back({record.triangles, {}});
    FollowingMesh mesh({record.positions, {}, record.triangles});
    FollowingMesh back = mesh;
    front_ = {std::move(mesh), key, i};
    keep(segments_.size() - 1, i, std::move(record), false, key);
    std::string back_key = hashBytes(key + "back");
    for (size_t k = 1; k <= fade; ++k) {
      back_key = keyAfter(back_key, i - k);
      keep(segments_.size() - 1, i - k, followed(back, back_key, i - k), true, back_key);
    }
  }

  Record followed(FollowingMesh& mesh, const std::string& key, size_t i) {
    Record record;
    if (const auto kept = cache_.find(key)) {
      record = recordOf(*kept);
      mesh.place(record.positions);
      return record;
    }
    LoadedFrame& frame = frames_.at(i);
    record.figures = mesh.follow(frame.outer);
    record.positions = mesh.mesh().positions;
    record.topology = frame.topology;
    record.warnings = frame.warnings;
    return record;
  }

  void step(size_t i) {
    front_->key = keyAfter(front_->key, i);
    Record record = followed(front_->mesh, front_->key, i);
    const bool is_lost = record.figures.isLost();
    keep(segments_.size() - 1, i, std::move(record), false, front_->key);
    if (is_lost) beginAfter(i);
    watch_.lap(report_.seconds, "follow");
  }

  // Begins a segment at a frame at which the one before has lost the surface. Two fades at a time cannot be shown, so that none reaches
  // into the frames over which a loop's end fades into its beginning: a mesh that is lost at the end goes on, and one that is lost at the
  // beginning is replaced by the next one, which is followed back to the first frame.
  void beginAfter(size_t i) {
    const SequenceSettings& settings = held_.settings.sequence;
    const double period = periodOf(inputs_, settings), faded = inputs_.back().frame - period, frame = inputs_[i].frame;
    if (settings.loops && frame > period) return;
    const bool replaces = settings.loops && frame <= faded;
    size_t back = replaces ? i : std::min(size_t(settings.fade), i - front_->began);
    while (settings.loops && !replaces && inputs_[i - back].frame < faded) --back;
    begin(i, back);
    if (!replaces) return;
    const size_t earlier = segments_.size() - 1;
    segments_.erase(segments_.begin(), segments_.begin() + ptrdiff_t(earlier));
    std::erase_if(unbaked_, [&](const Place& place) { return place.segment < earlier; });
    for (Place& place : unbaked_) place.segment -= earlier;
  }

  // Of all frames that have none. Those of one frame share its field.
  void bakeLobes() {
    std::map<size_t, std::vector<Place>> by_frame;
    for (Place& place : unbaked_) by_frame[segments_[place.segment].frames[place.at].frame].push_back(std::move(place));
    unbaked_.clear();
    std::vector<std::pair<LoadedFrame*, std::vector<Place>*>> work;
    for (auto& [i, places] : by_frame) work.emplace_back(&frames_.at(i), &places);
    parallelForAll(work.size(), [&](size_t k) {
      for (const Place& place : *work[k].second) bakeAt(*work[k].first, place);
    });
    watch_.lap(report_.seconds, "bake");
  }

  void bakeAt(LoadedFrame& loaded, const Place& place) {
    FollowedSegment& segment = segments_[place.segment];
    FollowedFrame& frame = segment.frames[place.at];
    BakeReport report;
    report.input = inputs_[frame.frame].name;
    Stopwatch watch;
    const BakeParameters parameters = resolveParameters(loaded.cloud, loaded.settings, report, watch);
    if (!loaded.field) loaded.field = fieldOfCloud(loaded.cloud, loaded.settings, parameters, report, watch);
    FollowingMesh mesh({frame.key.positions, {}, segment.triangles});
    frame.key.lobes = lobesAt(mesh.mesh(), *loaded.field, held_.settings.lobe, parameters, report.warnings).lobes;
    if (held_.settings.lobe.smooth > 0) smoothLobes(frame.key.lobes, mesh.mesh(), held_.settings.lobe.smooth);
    cache_.add(place.key,
               bytesOf({segment.triangles, frame.key.positions, frame.key.lobes, frame.figures, frame.topology, loaded.warnings, false}));
  }

  const std::vector<FrameInput>& inputs_;
  const Held& held_;
  Frames frames_;
  CloudCache cache_;
  BakeReport& report_;
  Stopwatch& watch_;
  std::vector<FollowedSegment> segments_;
  std::optional<Front> front_;
  std::vector<Place> unbaked_;
};

}  // namespace

FollowedFrames followFrames(const std::vector<FrameInput>& frames, const Settings& settings, std::span<const Given> given,
                            BakeReport& report, Stopwatch& watch) {
  const Held held = heldSettings(frames, settings, given, report, watch);
  Follower follower(frames, held, given, report, watch);
  FollowedFrames followed{held.info, follower.follow()};
  followed.info.input_hash = follower.hashOfAll();
  for (FollowedSegment& segment : followed.segments)
    for (FollowedFrame& frame : segment.frames) {
      FollowingMesh mesh({frame.key.positions, {}, segment.triangles});
      frame.key.normals = mesh.mesh().normals;
    }
  return followed;
}

}  // namespace cloudbake
