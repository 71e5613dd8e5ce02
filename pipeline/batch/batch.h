// Runs a whole batch: plans, judges, bakes and records it. Also merges the reports of shards.
#pragma once

#include <atomic>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "pipeline/batch/run.h"

namespace cloudbake {

/// Bakes what is stale (settings.batch, output folder settings.output.file) and writes the requested reports, the report for the next run
/// and the depfile. `given` are the options for assets on the command line. `stop` is as for runAssets; its final value tells whether a
/// signal ended the batch. Throws as planBatch and OutputLock do.
BatchReport bakeBatch(const Settings& settings, std::span<const Given> given, std::atomic<int>& stop, BatchListener& listener);

/// What bakeBatch would do: a line per asset, a summary, and lines for live views and for what --prune removes.
std::string listWork(const Settings& settings, std::span<const Given> given);

/// Merges the reports of all shards, settings.batch.inputs, and writes the requested reports. Throws InputError for a shard that is
/// missing, given twice, or from another batch.
BatchReport mergeShards(const Settings& settings, BatchListener& listener);

}  // namespace cloudbake
