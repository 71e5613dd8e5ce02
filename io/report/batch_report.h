// What a batch tells: JSON for tools and for the next run, JUnit XML for build servers, one HTML page for people, a depfile for Make and
// Ninja.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/figures.h"
#include "io/gltf/asset_info.h"

namespace cloudbake {

enum class AssetState {
  kBaked,      ///< baked in this run
  kFromCache,  ///< taken from the shared cache
  kFresh,      ///< its output was already what it should be
  kFailed,     ///< could not be baked, or is over a bound
  kNotRun      ///< the batch ended before its turn
};

/// One asset of a batch.
struct AssetRecord {
  std::string name;    ///< of its output, relative to the output folder, with '/': unique in a batch
  std::string source;  ///< "preset humilis, seed 7", or the path of the sculpt
  AssetState state = AssetState::kNotRun;
  std::string reason;                  ///< why it was baked: "new", "settings changed", "input changed", …; empty where it was not
  std::string key;                     ///< hash of inputs, settings and build: equal keys give equal bytes
  int code = 0;                        ///< exit code that its failure alone would have had
  std::string error;                   ///< of a failed one: FILE:LINE: what is wrong and what to do
  double seconds = 0;                  ///< of this run
  uint64_t bytes = 0;                  ///< of the output
  std::string output_hash;             ///< XXH3-128 of its bytes, hexadecimal
  Json report;                         ///< "cloudbake-report-1" of its bake (io/report/report.h); null where there is none
  std::optional<BakeFigures> figures;  ///< against exact chords; NaN in JSON is null
};

struct BatchReport {
  std::string source;         ///< the manifest, or the folder
  std::string output;         ///< the folder
  int shard = 0, shards = 0;  ///< 1-based; 0: the whole batch
  bool interrupted = false;
  std::vector<AssetRecord> assets;   ///< in the order of the manifest
  std::vector<std::string> removed;  ///< outputs that --prune removed
  double seconds = 0, processor_seconds = 0;
  uint64_t peak_memory = 0;  ///< bytes, resident
  int threads = 0;
};

/// Short name of a state as it stands in reports: "baked", "from-cache", "fresh", "failed", "not-run".
std::string_view stateName(AssetState state);

/// One JSON object, "schema": "cloudbake-batch-1" (docs/batch_report.schema.json). Text that is no UTF-8 has its wrong bytes replaced by
/// U+FFFD.
std::string batchJson(const BatchReport& report);
/// Reads it back; keys that it does not know are passed over. Throws InputError naming `file`, and the line where it is known, where the
/// text is none.
BatchReport readBatchJson(std::string_view text, const std::string& file);

/// JUnit XML: a test case per asset; the failed have their error, those not run are skipped, warnings stand in system-out.
std::string batchJunit(const BatchReport& report);

/// What differs from an earlier report, a line each: new and gone assets, changed keys, failures that came and went, figures that moved in
/// their first three digits. Between different shards assets are neither new nor gone, which a first line says.
std::vector<std::string> batchChanges(const BatchReport& before, const BatchReport& now);

/// A single HTML page without references to other files. `thumbnails` are PNG bytes per asset, empty where there is none;
/// they may end early.
std::string batchHtml(const BatchReport& report, const std::vector<std::string>& changes, const std::vector<std::string>& thumbnails);

/// `target: prerequisite …` as Make and Ninja read it, with blanks, '#', '$', ':' and '\' escaped; then a rule without
/// anything for each prerequisite, so that one that is gone stops nobody. Throws InputError for a name that no
/// depfile can hold: one with a line end, or with '\' at its end.
std::string depfileText(const std::filesystem::path& target, const std::vector<std::filesystem::path>& prerequisites);

}  // namespace cloudbake
