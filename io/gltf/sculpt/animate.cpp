// glTF 2.0, section 3.11: animations, and appendix C: interpolation. Between the keys k and k + 1 at t_k and t_k+1, with
// t_d = t_k+1 − t_k and t = (now − t_k) / t_d, a value is
//   STEP         v_k
//   LINEAR       (1 − t) v_k + t v_k+1, and slerp of rotations
//   CUBICSPLINE  (2t³ − 3t² + 1) v_k + t_d (t³ − 2t² + t) b_k + (−2t³ + 3t²) v_k+1 + t_d (t³ − t²) a_k+1, with a in-tangent a and an
//                out-tangent b per key; rotations are then made unit
// Before the first key it is the first value, after the last key the last.
#include "io/gltf/sculpt/animate.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "core/quaternion.h"
#include "io/file/animations.h"
#include "io/gltf/accessor.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

constexpr const char* kExportAgain = "; the file is damaged, export it again";

enum class Interpolation { kStep, kLinear, kCubic };

// The keys of a channel. A cubic one has an in-tangent, a value and an out-tangent per key.
struct Track {
  Interpolation interpolation = Interpolation::kLinear;
  bool is_rotation = false;
  size_t width = 0;           // numbers of a value
  std::vector<float> times;   // #K seconds, rising
  std::vector<float> values;  // #K×width, or #K×3×width

  std::span<const float> row(size_t key, size_t of_three = 1) const {
    const size_t index = interpolation == Interpolation::kCubic ? 3 * key + of_three : key;
    return std::span(values).subspan(index * width, width);
  }
};

// What a channel moves.
struct Channel {
  int node = 0;
  std::string path;  // "translation", "rotation", "scale" or "weights"
  Track track;
};

std::vector<std::string> namesOf(const Json& animations) {
  std::vector<std::string> names;
  for (const Json& one : animations) {
    names.push_back(one.value("name", ""));
    if (names.back().empty()) names.back() = "animation " + std::to_string(names.size() - 1);
  }
  return names;
}

// Reads one animation of a file.
class AnimationReader {
 public:
  AnimationReader(const fs::path& file, const Json& json, const tinygltf::Model& model, size_t index)
      : file_(file),
        document_(json),
        json_(json.at("animations").at(index)),
        model_(model),
        place_("animations[" + std::to_string(index) + "]") {}

  std::vector<Channel> read(Warnings& warnings) const {
    std::vector<Channel> read;
    std::set<std::pair<int, std::string>> met;
    const Json channels = json_.value("channels", Json::array());
    for (size_t i = 0; i < channels.size(); ++i) {
      const std::string place = place_ + ".channels[" + std::to_string(i) + "]";
      const Json target = channels[i].value("target", Json::object());
      const std::string path = target.value("path", "");
      const bool is_known = path == "translation" || path == "rotation" || path == "scale" || path == "weights";
      if (!target.contains("node") || !is_known) {
        warnings.add(WarningKind::kPoseIgnored, file_.string() + ": " + place + " is not the transform or the weights of a node; ignored");
        continue;
      }
      const int node = target["node"];
      if (node < 0 || size_t(node) >= model_.nodes.size()) fail(place, "moves node " + std::to_string(node) + ", which does not exist");
      if (!met.emplace(node, path).second) fail(place, "is the second one that moves the " + path + " of " + nodeLabel(model_, node));
      if (path != "weights" && document_.at("nodes").at(size_t(node)).contains("matrix"))
        fail(place, "moves " + nodeLabel(model_, node) + ", which has a matrix instead of a translation, rotation and scale");
      read.push_back({node, path, trackOf(place, channels[i].value("sampler", -1), node, path)});
    }
    return read;
  }

 private:
  [[noreturn]] void fail(const std::string& place, const std::string& what) const {
    throw InputError(file_.string(), place + " " + what + kExportAgain);
  }

  size_t widthOf(const std::string& place, int node, const std::string& path) const {
    if (path != "weights") return path == "rotation" ? 4 : 3;
    const int mesh = model_.nodes[size_t(node)].mesh;
    size_t targets = 0;
    if (mesh >= 0 && size_t(mesh) < model_.meshes.size())
      for (const tinygltf::Primitive& primitive : model_.meshes[size_t(mesh)].primitives)
        targets = std::max(targets, primitive.targets.size());
    if (targets == 0) fail(place, "moves the morph weights of " + nodeLabel(model_, node) + ", which has no morph targets");
    return targets;
  }

  Track trackOf(const std::string& channel, int sampler_index, int node, const std::string& path) const {
    const Json samplers = json_.value("samplers", Json::array());
    if (sampler_index < 0 || size_t(sampler_index) >= samplers.size()) fail(channel, "uses a sampler that does not exist");
    const std::string place = place_ + ".samplers[" + std::to_string(sampler_index) + "]";
    const Json& sampler = samplers[size_t(sampler_index)];
    Track track;
    track.width = widthOf(channel, node, path);
    track.is_rotation = path == "rotation";
    const std::string how = sampler.value("interpolation", "LINEAR");
    if (how == "STEP")
      track.interpolation = Interpolation::kStep;
    else if (how == "CUBICSPLINE")
      track.interpolation = Interpolation::kCubic;
    else if (how != "LINEAR")
      fail(place, "has the unknown interpolation '" + how + "'");
    const GltfAccessors accessors{file_, model_};
    track.times = accessors.readFloats(sampler.value("input", -1), 1, place + ".input");
    track.values = accessors.readFloats(sampler.value("output", -1), path == "weights" ? 1 : int(track.width), place + ".output");
    checkTrack(place, track);
    return track;
  }

  void checkTrack(const std::string& place, const Track& track) const {
    if (track.times.empty()) fail(place, "has no keys");
    for (size_t k = 0; k < track.times.size(); ++k)
      if (!std::isfinite(track.times[k]) || (k > 0 && !(track.times[k] > track.times[k - 1])))
        fail(place + ".input", "has a time that is not finite or not after the one before, at key " + std::to_string(k));
    const size_t rows = track.times.size() * (track.interpolation == Interpolation::kCubic ? 3 : 1);
    if (track.values.size() != rows * track.width)
      fail(place + ".output", "has " + std::to_string(track.values.size()) + " numbers for " + std::to_string(track.times.size()) +
                                  " keys, which need " + std::to_string(rows * track.width));
    for (size_t i = 0; i < track.values.size(); ++i)
      if (!std::isfinite(track.values[i]))
        fail(place + ".output", "has a value that is not finite, at key " + std::to_string(i / (rows / track.times.size() * track.width)));
    for (size_t k = 0; track.is_rotation && k < track.times.size(); ++k) {
      const std::span<const float> q = track.row(k);
      if (q[0] == 0 && q[1] == 0 && q[2] == 0 && q[3] == 0) fail(place + ".output", "has a rotation of zeros, at key " + std::to_string(k));
    }
  }

  const fs::path& file_;
  const Json &document_, &json_;
  const tinygltf::Model& model_;
  std::string place_;
};

Quaternion rotationAt(const Track& track, size_t key) {
  const std::span<const float> q = track.row(key);
  return normalized(Quaternion{q[0], q[1], q[2], q[3]}).value();
}

// Between two keys, at `t` of 0 to 1.
std::vector<double> blendedRows(const Track& track, size_t key, double t) {
  std::vector<double> blended(track.width);
  const std::span<const float> from = track.row(key), to = track.row(key + 1);
  if (track.interpolation == Interpolation::kCubic) {
    const std::span<const float> out = track.row(key, 2), in = track.row(key + 1, 0);
    const double seconds = double(track.times[key + 1]) - double(track.times[key]), t2 = t * t, t3 = t2 * t;
    for (size_t i = 0; i < blended.size(); ++i)
      blended[i] =
          (2 * t3 - 3 * t2 + 1) * from[i] + seconds * (t3 - 2 * t2 + t) * out[i] + (3 * t2 - 2 * t3) * to[i] + seconds * (t3 - t2) * in[i];
  } else {
    for (size_t i = 0; i < blended.size(); ++i) blended[i] = (1 - t) * from[i] + t * to[i];
  }
  return blended;
}

std::vector<double> valueAt(const Track& track, double seconds) {
  const auto after = std::upper_bound(track.times.begin(), track.times.end(), seconds, [](double now, float time) { return now < time; });
  const size_t key = after == track.times.begin() ? 0 : size_t(after - track.times.begin()) - 1;
  const bool is_between = after != track.times.begin() && after != track.times.end() && track.interpolation != Interpolation::kStep;
  const double t = is_between ? (seconds - track.times[key]) / (double(track.times[key + 1]) - double(track.times[key])) : 0;
  if (!track.is_rotation) {
    if (is_between) return blendedRows(track, key, t);
    const std::span<const float> row = track.row(key);
    return {row.begin(), row.end()};
  }
  Quaternion rotation = rotationAt(track, key);
  if (is_between && track.interpolation == Interpolation::kLinear) rotation = slerp(rotation, rotationAt(track, key + 1), t);
  if (is_between && track.interpolation == Interpolation::kCubic) {
    const std::vector<double> row = blendedRows(track, key, t);
    rotation = normalized(Quaternion{row[0], row[1], row[2], row[3]}).value_or(rotation);
  }
  return {rotation.begin(), rotation.end()};
}

bool isConstant(const Track& track) {
  if (track.times.size() == 1) return true;
  for (size_t k = 0; k < track.times.size(); ++k) {
    const auto row = track.row(k), first = track.row(0);
    if (!std::equal(row.begin(), row.end(), first.begin(), first.end())) return false;
    if (track.interpolation != Interpolation::kCubic) continue;
    for (const size_t tangent : {0, 2})
      if (std::ranges::any_of(track.row(k, tangent), [](float x) { return x != 0; })) return false;
  }
  return true;
}

// The nodes whose transforms place what the scene draws: those of meshes, joints, and all above them.
std::vector<bool> placingNodes(std::span<const PlacedNode> placed, const tinygltf::Model& model) {
  std::vector<int> parents(model.nodes.size(), -1), stack;
  for (size_t i = 0; i < model.nodes.size(); ++i)
    for (const int child : model.nodes[i].children)
      if (child >= 0 && size_t(child) < parents.size()) parents[size_t(child)] = int(i);
  for (const PlacedNode& one : placed) {
    const tinygltf::Node& node = model.nodes[size_t(one.node)];
    if (one.hidden || node.mesh < 0) continue;
    stack.push_back(one.node);
    if (node.skin >= 0 && size_t(node.skin) < model.skins.size())
      stack.insert(stack.end(), model.skins[size_t(node.skin)].joints.begin(), model.skins[size_t(node.skin)].joints.end());
  }
  std::vector<bool> places(model.nodes.size());
  while (!stack.empty()) {
    const int node = stack.back();
    stack.pop_back();
    if (node < 0 || size_t(node) >= places.size() || places[size_t(node)]) continue;
    places[size_t(node)] = true;
    stack.push_back(parents[size_t(node)]);
  }
  return places;
}

}  // namespace

double poseByAnimation(const fs::path& file, const AnimationMoment& moment, std::span<const PlacedNode> placed, Json& json,
                       tinygltf::Model& model, Warnings& warnings) {
  const std::vector<std::string> names = namesOf(json.value("animations", Json::array()));
  const size_t index = chosenAnimation(file, names, moment.animation);
  const std::vector<Channel> channels = AnimationReader(file, json, model, index).read(warnings);
  const std::vector<bool> places = placingNodes(placed, model);
  if (std::ranges::none_of(channels, [&](const Channel& one) { return places[size_t(one.node)] && !isConstant(one.track); }))
    refuseStillAnimation(file, names, index);
  double start = channels.front().track.times.front(), end = start;
  for (const Channel& channel : channels) {
    start = std::min(start, double(channel.track.times.front()));
    end = std::max(end, double(channel.track.times.back()));
  }
  for (const Channel& channel : channels) {
    const std::vector<double> value = valueAt(channel.track, start + moment.seconds);
    tinygltf::Node& node = model.nodes[size_t(channel.node)];
    (channel.path == "translation" ? node.translation
     : channel.path == "rotation"  ? node.rotation
     : channel.path == "scale"     ? node.scale
                                   : node.weights) = value;
    json["nodes"][size_t(channel.node)][channel.path] = value;
  }
  return end - start;
}

}  // namespace cloudbake
