// A batch runs in a child process, so that an asset that crashes the process does not end the batch.
#pragma once

#include <string>
#include <vector>

#include "core/error.h"
#include "pipeline/batch/run.h"
#include "pipeline/options/settings.h"

namespace cloudbake {

/// First word of the command line of such a process.
inline constexpr const char* kBatchWorker = "batch-worker";

/// Runs `cloudbake WORDS…` as a worker. If a signal ends the worker, another one goes on: the asset that was running is reported as failed.
/// If several were running, the next workers run each of them alone. SIGINT, SIGTERM and SIGHUP are passed on. Returns the
/// exit code of the last worker. With `reads_input` every worker gets the whole standard input. Throws IoError if no worker can be started,
/// and an internal Error for a crash that no asset caused.
ExitCode superviseBatch(const std::vector<std::string>& words, bool reads_input);

/// The orders that this worker was started with. Throws UsageError if there are none.
BatchOrders takeOrders();

/// Tells the supervisor what runs, and passes everything on.
class JournalListener : public BatchListener {
 public:
  explicit JournalListener(BatchListener& next) : next_(next) {}
  void begin(size_t assets, double cost_seconds) override { next_.begin(assets, cost_seconds); }
  void start(const std::string& name, int stages) override;
  void stage(const std::string& name, const std::string& finished) override { next_.stage(name, finished); }
  void finish(const std::string& name, double cost_seconds, const std::string& line) override;
  void postpone(const std::string& name) override;
  void tell(const std::string& lines) override { next_.tell(lines); }

 private:
  BatchListener& next_;
};

}  // namespace cloudbake
