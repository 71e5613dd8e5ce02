// Messages are texts. To a helper: the order of an asset, as JSON. From it: S and a stage, T and lines for the user, or R and the result.
#include "pipeline/batch/make_assets.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "core/parallel.h"
#include "core/text/json.h"
#include "core/wasm/host.h"
#include "io/file/input_files.h"
#include "io/file/wasm/helper.h"

namespace cloudbake {

namespace {

std::string textOf(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string resultText(bool is_done, const AssetInputs& inputs, const AssetRecord& record) {
  BatchReport report;
  report.assets.push_back(record);
  Json files = Json::array();
  for (const std::filesystem::path& file : inputs.files) files.push_back(file.string());
  return textOf({{"done", is_done}, {"key", inputs.key}, {"files", std::move(files)}, {"report", batchJson(report)}});
}

// Whether the asset is done.
bool takeResult(std::string_view text, const AssetSlot& slot) {
  const Json json = parseJson(text).value();
  if (!json.at("done").get<bool>()) return false;
  slot.inputs = {json.at("key"), {}};
  for (const Json& file : json.at("files")) slot.inputs.files.emplace_back(file.get<std::string>());
  AssetRecord record = readBatchJson(json.at("report").get<std::string>(), slot.record.name).assets.at(0);
  record.reason = slot.record.reason;
  slot.record = std::move(record);
  return true;
}

// Tells the copy that started this one.
class FarListener : public BatchListener {
 public:
  void begin(size_t /*assets*/, double /*cost_seconds*/) override {}
  void start(const std::string& /*name*/, int /*stages*/) override {}
  void stage(const std::string& /*name*/, const std::string& finished) override { sendToParent("S" + finished); }
  void finish(const std::string& /*name*/, double /*cost_seconds*/, const std::string& /*line*/) override {}
  void postpone(const std::string& /*name*/) override {}
  void tell(const std::string& lines) override { sendToParent("T" + lines); }
};

class Helpers {
 public:
  Helpers(std::span<const Job> jobs, uint64_t memory, std::atomic<int>& stop, const AssetRun& run, const AssetSteps& steps)
      : jobs_(jobs), memory_(memory), stop_(stop), run_(run), steps_(steps), waiting_(jobs.size()) {
    std::iota(waiting_.begin(), waiting_.end(), 0);
    std::stable_sort(waiting_.begin(), waiting_.end(), [&](size_t a, size_t b) { return jobs_[a].cost_seconds > jobs_[b].cost_seconds; });
  }

  void work() {
    for (startWhatFits(); !running_.empty(); startWhatFits())
      if (const std::optional<HelperMessage> message = receiveMessage()) take(*message);
  }

 private:
  struct Running {
    Helper helper;
    size_t job;
    AssetSlot slot;
  };

  void startWhatFits() {
    int none = 0;
    if (const int signal = cloudbake_noted_signal(); signal != 0) stop_.compare_exchange_strong(none, signal);
    for (auto next = waiting_.begin(); next != waiting_.end() && stop_ == 0 && running_.size() < at_once_;) {
      const size_t job = *next;
      if (!running_.empty() && taken_ + jobs_[job].memory > memory_) {
        ++next;
        continue;
      }
      next = waiting_.erase(next);
      start(job);
    }
  }

  void start(size_t job) {
    taken_ += jobs_[job].memory;
    if (idle_.empty()) idle_.emplace_back();
    Helper helper = std::move(idle_.back());
    idle_.pop_back();
    const AssetSlot slot = steps_.start(job);
    helper.send(textOf({{"name", slot.asset.name},
                        {"threads", threads_},
                        {"memory", std::min(jobs_[job].memory, memory_)},
                        {"may_have_more", jobs_[job].memory < memory_}}));
    const int number = helper.number();
    running_.emplace(number, Running{std::move(helper), job, slot});
  }

  void take(const HelperMessage& message) {
    const auto found = running_.find(message.from);
    if (found == running_.end()) return;
    auto& [helper, job, slot] = found->second;
    const bool is_text = message.kind == HelperMessage::Kind::kBytes;
    const std::string rest = is_text ? message.bytes.substr(1) : "";
    if (is_text && message.bytes.starts_with('S')) return run_.listener.stage(slot.asset.name, rest);
    if (is_text && message.bytes.starts_with('T')) return run_.listener.tell(rest);
    const size_t ended = job;
    taken_ -= jobs_[ended].memory;
    const bool is_done = !is_text || takeResult(rest, slot);
    if (is_text) idle_.push_back(std::move(helper));
    running_.erase(found);
    if (is_done)
      steps_.end(ended, is_text ? "" : (message.kind == HelperMessage::Kind::kCrashed ? "" : "exit code ") + message.bytes);
    else
      steps_.postpone(ended);
  }

  std::span<const Job> jobs_;
  const uint64_t memory_;
  std::atomic<int>& stop_;
  const AssetRun& run_;
  const AssetSteps& steps_;
  const size_t at_once_ = assetsAtOnce(run_.settings);
  const int threads_ = int(std::max(size_t(1), at_once_ / std::max(size_t(1), jobs_.size())));  // for each asset
  std::vector<size_t> waiting_;
  std::map<int, Running> running_;
  std::vector<Helper> idle_;
  uint64_t taken_ = 0;
};

}  // namespace

void makeAssets(std::span<const Job> jobs, uint64_t memory, std::atomic<int>& stop, const AssetRun& run, const AssetSteps& steps) {
  Helpers(jobs, memory, stop, run, steps).work();
}

size_t assetsAtOnce(const Settings& settings) {
  return size_t(std::max(1, settings.run.threads > 0 ? settings.run.threads : cloudbake_processors()));
}

void helpIfHelper(const Settings& settings, std::span<const Given> given) {
  if (cloudbake_is_helper() == 0) return;
  const BatchPlan plan = planBatch(settings, given);
  FarListener listener;
  const AssetRun run{plan, settings, listener};
  for (;;) {
    const Json order = parseJson(receiveMessage().value().bytes).value();
    const std::string name = order.at("name");
    const auto asset = std::find_if(plan.assets.begin(), plan.assets.end(), [&](const PlannedAsset& one) { return one.name == name; });
    if (asset == plan.assets.end()) throw changedWhileRead(name);
    const ThreadLimit limit(order.at("threads"));
    AssetInputs inputs;
    AssetRecord record;
    record.name = name;
    record.source = asset->source;
    const bool is_done = makeAsset(*asset, order.at("memory"), order.at("may_have_more"), run, inputs, record);
    sendToParent("R" + resultText(is_done, inputs, record));
  }
}

}  // namespace cloudbake
