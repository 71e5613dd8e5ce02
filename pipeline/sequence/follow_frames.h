// Follows a cloud through the frames of a sequence, and bakes the lobes of each frame on its own volume.
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

/// A frame that a segment has been followed to.
struct FollowedFrame {
  size_t frame = 0;  ///< index into the inputs
  SequenceKey key;
  FollowFigures figures;
  SurfaceTopology topology;  ///< of the frame's own surface
  bool was_kept = false;     ///< came from the cache
};

struct FollowedSegment {
  std::vector<Triangle> triangles;
  std::vector<FollowedFrame> frames;  ///< one after the other
};

struct FollowedFrames {
  AssetInfo info;
  std::vector<FollowedSegment> segments;
};

/// Each segment begins with the surface of the frame at which the one before lost it (FollowFigures::isLost), and is also followed back
/// over settings.sequence.fade frames, during which it takes the place of that one. Fades do not overlap, also not with that of a loop. σ,
/// k, b and the value of a fog's surface are the same for all frames. Frames that are in the cache are not read again.
FollowedFrames followFrames(const std::vector<FrameInput>& frames, const Settings& settings, std::span<const Given> given,
                            BakeReport& report, Stopwatch& watch);

}  // namespace cloudbake
