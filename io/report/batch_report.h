// The reports of a batch: JSON for tools and for the next run, JUnit XML for build servers, an HTML page for people, and a depfile for Make
// and Ninja.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
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
  kFresh,      ///< its output was already up to date
  kFailed,     ///< could not be baked, or exceeds a bound
  kNotRun      ///< the batch ended before its turn
};

/// One asset of a batch.
struct AssetRecord {
  std::string name;    ///< name of its output, relative to the output folder, with '/'; unique in a batch
  std::string source;  ///< "preset humilis, seed 7", or the path of the sculpt
  AssetState state = AssetState::kNotRun;
  std::string reason;                     ///< why it was baked: "new", "settings changed", "input changed", …; empty if it was not
  std::string key;                        ///< hash of inputs, settings and build; equal keys give equal bytes
  int code = 0;                           ///< the exit code that its failure alone would have
  std::string error;                      ///< if it failed: FILE:LINE: what is wrong and how to cure it
  double seconds = 0;                     ///< time in this run
  uint64_t bytes = 0;                     ///< size of the output
  std::string output_hash;                ///< XXH3-128 of the output's bytes, hexadecimal
  std::vector<std::string> level_hashes;  ///< the same of its levels of detail
  Json report;                            ///< "cloudbake-report-1" of its bake (io/report/report.h), or null
  std::optional<BakeFigures> figures;     ///< error figures, compared with exact chords; a NaN is null in JSON
};

struct BatchReport {
  std::string source;         ///< the manifest, or the folder of sculpts
  std::string output;         ///< the output folder
  int shard = 0, shards = 0;  ///< 1-based; 0 = the whole batch
  bool interrupted = false;
  std::vector<AssetRecord> assets;   ///< in the order of the manifest
  std::vector<std::string> removed;  ///< outputs that --prune removed
  std::string frames;                ///< for people: which sculpts got the unit and the axis that were given for all; not in JSON
  double seconds = 0, processor_seconds = 0;
  uint64_t peak_memory = 0;  ///< resident memory, bytes
  int threads = 0;
};

/// Short name of a state, as reports show it: "baked", "from-cache", "fresh", "failed", "not-run".
std::string_view stateName(AssetState state);

/// One JSON object, "schema": "cloudbake-batch-1" (docs/batch_report.schema.json). Bytes that are not valid UTF-8 are replaced by U+FFFD.
std::string batchJson(const BatchReport& report);
/// Reads such an object. Unknown keys are ignored. Throws InputError with `file`, and the line if it is known, if the text is not such a
/// report.
BatchReport readBatchJson(std::string_view text, const std::string& file);

/// JUnit XML with a test case per asset. Failed assets have their error, assets that were not run are skipped, and warnings are in
/// system-out.
std::string batchJunit(const BatchReport& report);

/// Something that is not as in an earlier report.
struct BatchChange {
  std::string what;      ///< its kind: "new", "removed", "fails now", …; without an asset, a remark
  std::string asset{};   ///< name, on one line
  std::string detail{};  ///< what follows the name, such as ", from bear.off"
  std::string shared{};  ///< the part of the detail that does not depend on the asset, such as an error without the name of the file
  /// "new: bear.glb, from bear.off"
  std::string line() const { return what + (asset.empty() ? "" : ": " + asset + detail); }
};

/// The differences from an earlier report: new, removed and missing assets, changed keys, failures that appeared or disappeared, and
/// figures that changed in their first three digits. For different shards, assets of only one of them are not listed; a remark says so.
std::vector<BatchChange> batchChanges(const BatchReport& before, const BatchReport& now);

/// How the HTML page shows an asset; either may be empty.
struct AssetPicture {
  std::string jpeg{};       ///< bytes of a small picture of kThumbnailWidth × kThumbnailHeight
  std::string live_view{};  ///< the page that the picture links to: its path from the folder of the HTML page, with '/'
};
inline constexpr int kThumbnailWidth = 180, kThumbnailHeight = 120;

/// A single HTML page that loads nothing. `pictures` are in the order of the assets; the last ones may be missing. Changes that say the
/// same of several assets are one line with a count, and so are the outputs that --prune removed.
std::string batchHtml(const BatchReport& report, const std::vector<BatchChange>& changes, const std::vector<AssetPicture>& pictures);

/// `target: prerequisite …` in the form that Make and Ninja read, with blanks, '#', '$', ':' and '\' escaped. An empty rule for each
/// prerequisite follows, so that a missing one is not an error. Throws InputError for a name that a depfile cannot contain: one with a line
/// break, or with '\' at its end.
std::string depfileText(const std::filesystem::path& target, const std::vector<std::filesystem::path>& prerequisites);

}  // namespace cloudbake
