// Bakes clouds that change: follows their surface from frame to frame, bakes the lobes of each frame, and keeps the frames that are needed.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bake/sequence/follow_surface.h"
#include "core/sequence.h"
#include "io/report/report.h"
#include "pipeline/fields/stopwatch.h"
#include "pipeline/sequence/frames.h"

namespace cloudbake {

/// What is known of a frame of a sequence.
struct FrameFigures {
  std::string name;
  double frame = 0;
  size_t segment = 0;
  bool is_key = false;
  FollowFigures follow;
  SurfaceTopology topology;
  double change = 0;             ///< of the picture by blending between keys: rms of its 8-bit values where it shows a cloud
  double transmittance_rms = 0;  ///< of T by blending, over vertices and lights from everywhere
  bool was_kept = false;         ///< came from the cache
};

struct BakedSequence {
  CloudSequence sequence;
  std::vector<FrameFigures> frames;
  std::vector<std::string> events;  ///< where parts join or part, and where segments begin
};

/// Frames that were followed and baked before come from `cache_folder`, if there is one. Throws as readCloud does, and InputError for a
/// frame that encloses nothing.
BakedSequence bakeSequence(const std::vector<FrameInput>& frames, const Settings& settings, std::span<const Given> given,
                           BakeReport& report, Stopwatch& watch);

/// What --as keys appends to the stem of -o: segment and frame, as a pattern of RunFile.
inline constexpr const char* kKeyFileEnding = "_[0-9][0-9]_[0-9][0-9][0-9][0-9].glb";

std::string sequenceText(const BakedSequence& baked);
Json sequenceJson(const BakedSequence& baked);

}  // namespace cloudbake
