// The stages of a call in their order, so that its progress (core/parallel.h: LoopProgress) can be shown while it works.
#pragma once

#include <string>
#include <vector>

#include "pipeline/options/settings.h"

namespace cloudbake {

/// Names the stages of a call, and gives each its share of the whole work, which is only an estimate. Nothing happens if nobody asks for
/// the progress of this thread.
class StagePlan {
 public:
  /// Of a bake or of a grown cloud.
  static StagePlan ofBake(const Settings& settings, bool is_grown);
  static StagePlan ofCheck(const Settings& settings);
  /// Call it when a stage ends, with the name that Stopwatch uses: the next stage begins.
  void end(const std::string& stage);

 private:
  struct Stage {
    const char* name;
    double work;  // about a second of a usual processor for 100,000 vertices
  };
  explicit StagePlan(std::vector<Stage> stages);
  void enter();

  std::vector<Stage> stages_;
  size_t now_ = 0;
};

}  // namespace cloudbake
