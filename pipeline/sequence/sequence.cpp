#include "pipeline/sequence/sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "io/file/write_file.h"
#include "io/report/figures.h"
#include "pipeline/sequence/choose_keys.h"
#include "pipeline/sequence/follow_frames.h"

namespace cloudbake {

namespace {

std::string counted(int count, const char* one, const char* many) { return fmt::format("{} {}", count, count == 1 ? one : many); }

// What a new segment or another topology means for whoever watches the cloud.
void tellEvents(const FollowedFrames& followed, const std::vector<FrameInput>& inputs, std::vector<std::string>& events) {
  std::vector<SurfaceTopology> topologies(inputs.size());
  for (const FollowedSegment& segment : followed.segments)
    for (const FollowedFrame& frame : segment.frames) topologies[frame.frame] = frame.topology;
  const auto text = [](const SurfaceTopology& t) {
    return counted(t.shells, "part", "parts") + ", " + counted(t.handles, "hole", "holes");
  };
  std::map<size_t, size_t> begins;  // segment by the frame at which it is seen alone
  for (size_t s = 1; s < followed.segments.size(); ++s) begins[followed.segments[s - 1].frames.back().frame] = s;
  for (size_t i = 1; i < inputs.size(); ++i) {
    const bool has_changed = topologies[i] != topologies[i - 1];
    const auto begun = begins.find(i);
    if (!has_changed && begun == begins.end()) continue;
    std::string event = fmt::format("frame {:g}: ", inputs[i].frame);
    if (has_changed) event += text(topologies[i - 1]) + " become " + text(topologies[i]);
    if (begun != begins.end()) {
      const auto& segment = followed.segments[begun->second];
      event += fmt::format("{}segment {} has faded in since frame {:g}", has_changed ? "; " : "", begun->second + 1,
                           segment.frames.front().key.frame);
    } else {
      event += "; the mesh goes on";
    }
    events.push_back(event);
  }
}

}  // namespace

BakedSequence bakeSequence(const std::vector<FrameInput>& frames, const Settings& settings, std::span<const Given> given,
                           BakeReport& report, Stopwatch& watch) {
  FollowedFrames followed = followFrames(frames, settings, given, report, watch);
  BakedSequence baked;
  tellEvents(followed, frames, baked.events);
  CloudSequence& sequence = baked.sequence;
  sequence.info = followed.info;
  sequence.frames_per_second = settings.sequence.frames_per_second.value_or(kFramesPerSecond);
  sequence.loops = settings.sequence.loops;
  sequence.period = periodOf(frames, settings.sequence);
  sequence.pixels = settings.sequence.pixels;
  for (size_t s = 0; s < followed.segments.size(); ++s) {
    FollowedSegment& own = followed.segments[s];
    SequenceSegment all{own.triangles, {}};
    for (FollowedFrame& frame : own.frames) all.keys.push_back(std::move(frame.key));
    std::vector<BlendFigures> blends;
    const std::vector<size_t> keys = chooseKeys(sequence, all, settings.sequence.pixels, settings.sequence.change, blends);
    for (size_t i = 0; i < own.frames.size(); ++i) {
      const FollowedFrame& frame = own.frames[i];
      const bool is_key = std::binary_search(keys.begin(), keys.end(), i);
      baked.frames.push_back({frames[frame.frame].name, frames[frame.frame].frame, s, is_key, frame.figures, frame.topology,
                              blends[i].change, blends[i].transmittance_rms, frame.was_kept});
    }
    SequenceSegment kept{own.triangles, {}};
    for (const size_t key : keys) kept.keys.push_back(std::move(all.keys[key]));
    report.vertices += kept.keys.front().positions.size();
    report.triangles += kept.triangles.size();
    sequence.segments.push_back(std::move(kept));
  }
  report.info = sequence.info;
  watch.lap(report.seconds, "keys");
  return baked;
}

std::string sequenceText(const BakedSequence& baked) {
  const CloudSequence& sequence = baked.sequence;
  size_t keys = 0, kept = 0;
  FrameFigures most;
  for (const SequenceSegment& segment : sequence.segments) keys += segment.keys.size();
  for (const FrameFigures& frame : baked.frames) {
    kept += frame.was_kept;
    most.change = std::max(most.change, frame.change);
    most.transmittance_rms = std::max(most.transmittance_rms, frame.transmittance_rms);
    most.follow.distance.rms = std::max(most.follow.distance.rms, frame.follow.distance.rms);
  }
  std::string text =
      figureLine("sequence", "{} frames at {:g} per second, {} {}, {} keys{}", size_t(sequence.segments.back().last()) + 1,
                 sequence.frames_per_second, sequence.segments.size(), sequence.segments.size() == 1 ? "segment" : "segments", keys,
                 sequence.loops ? fmt::format(", loops after {:g}", sequence.period) : "");
  text += figureLine("errors",
                     "at most {:.2f} of 255 of a picture and {:.4f} of T by blending; {:.2f} % of the longest side to the surface, rms",
                     most.change, most.transmittance_rms, 100 * most.follow.distance.rms);
  if (kept > 0) text += figureLine("kept", "{} of {} frames were baked before", kept, baked.frames.size());
  for (const std::string& event : baked.events) text += figureLine("event", "{}", event);
  return text;
}

Json sequenceJson(const BakedSequence& baked) {
  const CloudSequence& sequence = baked.sequence;
  Json json = {{"frames_per_second", sequence.frames_per_second}, {"loops", sequence.loops}, {"period", sequence.period}};
  json["segments"] = Json::array();
  for (const SequenceSegment& segment : sequence.segments) {
    Json keys = Json::array();
    for (const SequenceKey& key : segment.keys) keys.push_back(key.frame);
    json["segments"].push_back(
        {{"vertices", segment.keys.front().positions.size()}, {"triangles", segment.triangles.size()}, {"keys", keys}});
  }
  json["events"] = baked.events;
  json["frames"] = Json::array();
  for (const FrameFigures& frame : baked.frames)
    json["frames"].push_back({{"name", frame.name},
                              {"frame", frame.frame},
                              {"segment", frame.segment},
                              {"is_key", frame.is_key},
                              {"distance_rms", frame.follow.distance.rms},
                              {"distance_largest", frame.follow.distance.largest},
                              {"missed", frame.follow.missed},
                              {"folded", frame.follow.folded},
                              {"volume", frame.follow.volume},
                              {"parts", frame.topology.shells},
                              {"holes", frame.topology.handles},
                              {"change", frame.change},
                              {"transmittance_rms", frame.transmittance_rms},
                              {"was_kept", frame.was_kept}});
  return json;
}

}  // namespace cloudbake
