// Small batches in a folder of their own.
#pragma once

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <mutex>
#include <string>
#include <vector>

#include "io/file/write_file.h"
#include "pipeline/batch/plan.h"
#include "pipeline/batch/run.h"
#include "pipeline/batch/state.h"
#include "tests/io/io_helpers.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {

/// A folder with sculpts in `in`, which a batch bakes to `out`.
struct BatchFolder : TestFolder {
  std::filesystem::path in = path / "in", out = path / "out";
  BatchFolder() { std::filesystem::create_directories(in); }

  /// A box of this height.
  std::filesystem::path box(const std::string& name, float height = 1) const {
    std::filesystem::create_directories((in / name).parent_path());
    return write("in/" + name, objText(boxMesh({0, 0, 0}, {1, height, 1})));
  }
  /// The settings of a batch of the folder `in`, or of what `input` names.
  Settings settings(const std::filesystem::path& input = {}) const {
    Settings all;
    all.batch.inputs = {input.empty() ? in : input};
    all.output.file = out;
    return all;
  }
  Settings manifest(const std::string& text) const { return settings(write("in/m.toml", text)); }
};

/// The fewest rays and voxels that make a bake.
inline std::vector<Given> fewRays() { return options({"rays=16", "voxels=16"}); }

/// What a batch tells, in order.
class Listener : public BatchListener {
 public:
  size_t assets = 0;
  double cost_seconds = -1;
  std::vector<std::string> events;  // "start a.glb", "finish a.glb"
  std::string lines, told;
  void begin(size_t count, double cost) override { assets = count, cost_seconds = cost; }
  void start(const std::string& name, int) override { add("start " + name); }
  void stage(const std::string&, const std::string&) override {}
  void finish(const std::string& name, double, const std::string& line) override {
    add("finish " + name);
    const std::lock_guard lock(mutex_);
    lines += line + "\n";
  }
  void postpone(const std::string& name) override { add("postpone " + name); }
  void tell(const std::string& text) override {
    const std::lock_guard lock(mutex_);
    told += text;
  }

 private:
  void add(const std::string& event) {
    const std::lock_guard lock(mutex_);
    events.push_back(event);
  }
  std::mutex mutex_;
};

inline std::vector<std::string> namesOf(const std::vector<PlannedAsset>& assets) {
  std::vector<std::string> names;
  for (const PlannedAsset& asset : assets) names.push_back(asset.name);
  return names;
}

/// With this many threads, whatever the machine has.
template <class Body>
void withThreads(int count, const Body& body) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(count));
  tbb::task_arena(count).execute(body);
}

}  // namespace cloudbake
