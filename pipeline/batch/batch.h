// A whole batch: planned, judged, baked, recorded; and the reports of shards, merged.
#pragma once

#include <atomic>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "pipeline/batch/run.h"

namespace cloudbake {

/// Bakes what is stale (settings.batch, output folder settings.output.file) and writes the reports that are asked for, the report for the
/// next run and the depfile. `given` are the options of assets on the command line. `stop` as of runAssets: its value at the end says
/// whether a signal ended the batch. Throws as planBatch and OutputLock do.
BatchReport bakeBatch(const Settings& settings, std::span<const Given> given, std::atomic<int>& stop, BatchListener& listener);

/// What bakeBatch would do, a line per asset and one of the whole.
std::string listWork(const Settings& settings, std::span<const Given> given);

/// One report of all shards, given as settings.batch.inputs; writes the reports that are asked for. Throws InputError for a shard that is
/// missing, there twice, or of another batch.
BatchReport mergeShards(const Settings& settings);

}  // namespace cloudbake
