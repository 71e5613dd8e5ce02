// This file defines the keys of "cloudbake-batch-1" (docs/batch_report.schema.json) and their order.
#include "io/report/batch_report.h"

#include <algorithm>
#include <limits>

#include "core/error.h"
#include "core/text/json.h"
#include "io/report/batch_parts.h"
#include "io/report/figures.h"

namespace cloudbake {

namespace {

constexpr const char* kSchema = "cloudbake-batch-1";
constexpr const char* kAssetSchema = "cloudbake-report-1";

Json countsJson(const BatchReport& report) {
  Json json = Json::object();
  for (const AssetState state : kAssetStates) json[std::string(stateName(state))] = assetsIn(report, state);
  return json;
}

Json figuresJson(const BakeFigures& figures) {
  Json json = {{"truth", figures.truth}, {"vertices", figures.vertices}};
  for (const FigureField& field : figureFields()) json[field.key] = field.of(figures);  // null if it is not finite
  return json;
}

Json assetJson(const AssetRecord& asset) {
  Json json = {{"name", asset.name},
               {"source", asset.source},
               {"state", std::string(stateName(asset.state))},
               {"reason", asset.reason},
               {"key", asset.key},
               {"code", asset.code},
               {"error", asset.error},
               {"seconds", asset.seconds},
               {"bytes", asset.bytes},
               {"output_hash", asset.output_hash}};
  if (!asset.level_hashes.empty()) json["level_hashes"] = asset.level_hashes;
  if (asset.figures) json["figures"] = figuresJson(*asset.figures);
  if (!asset.report.is_null()) json["report"] = asset.report;
  return json;
}

/// A value in the JSON being read, and its path for messages, e.g. "assets[3].figures".
struct Place {
  const std::string& file;
  const Json& json;
  std::string path;
};

[[noreturn]] void refuse(const std::string& file, int line, const std::string& why) {
  throw InputError(file, line, "is not a report of a batch (" + std::string(kSchema) + "): " + why + "; run the batch again to rewrite it");
}

[[noreturn]] void refuse(const Place& at, const char* key, const char* expected) {
  refuse(at.file, 0, "\"" + (at.path.empty() ? "" : at.path + ".") + key + "\" is not " + expected);
}

bool has(const Place& at, const char* key) {
  const auto found = at.json.find(key);
  return found != at.json.end() && !found->is_null();
}

Place member(const Place& at, const char* key, bool (Json::*is_right)() const noexcept, const char* expected) {
  const auto found = at.json.find(key);
  if (found == at.json.end() || !((*found).*is_right)()) refuse(at, key, expected);
  return {at.file, *found, (at.path.empty() ? "" : at.path + ".") + key};
}

std::string textOf(const Place& at, const char* key) { return member(at, key, &Json::is_string, "text").json.get<std::string>(); }
bool flagOf(const Place& at, const char* key) { return member(at, key, &Json::is_boolean, "true or false").json.get<bool>(); }

uint64_t countOf(const Place& at, const char* key, int64_t most = std::numeric_limits<int64_t>::max()) {
  const int64_t count = wholeNumber(member(at, key, &Json::is_number_integer, "a whole number").json);
  if (count < 0 || count > most) refuse(at, key, "a whole number in the allowed range");
  return uint64_t(count);
}

int smallCountOf(const Place& at, const char* key) { return int(countOf(at, key, std::numeric_limits<int>::max())); }

double amountOf(const Place& at, const char* key) {
  const double amount = member(at, key, &Json::is_number, "a number").json.get<double>();
  if (!(amount >= 0)) refuse(at, key, "a number of 0 or more");
  return amount;
}

// The elements of an array of objects.
std::vector<Place> objectsOf(const Place& at, const char* key) {
  const Place list = member(at, key, &Json::is_array, "an array of objects");
  std::vector<Place> objects;
  for (size_t i = 0; i < list.json.size(); ++i) {
    if (!list.json[i].is_object()) refuse(at, key, "an array of objects");
    objects.push_back({at.file, list.json[i], list.path + "[" + std::to_string(i) + "]"});
  }
  return objects;
}

AssetState readState(const Place& at) {
  const std::string name = textOf(at, "state");
  for (const AssetState state : kAssetStates)
    if (stateName(state) == name) return state;
  refuse(at, "state", "a state of an asset");
}

BakeFigures readFigures(const Place& at) {
  BakeFigures figures;
  figures.truth = textOf(at, "truth");
  figures.vertices = countOf(at, "vertices");
  for (const FigureField& field : figureFields()) {
    const bool undefined = at.json.contains(field.key) && at.json[field.key].is_null();
    double& value = field.value(figures);
    if (undefined)
      value = std::numeric_limits<double>::quiet_NaN(), figures.is_fit |= field.key == std::string_view("direction_rms_degrees");
    else if (field.may_be_negative)
      value = member(at, field.key, &Json::is_number, "a number").json.get<double>();
    else
      value = amountOf(at, field.key);
  }
  return figures;
}

// The parts of an asset's own report that other reports use must have the right types.
Json readAssetReport(const Place& at) {
  if (textOf(at, "schema") != kAssetSchema) refuse(at, "schema", kAssetSchema);
  if (at.json.contains("vertices")) countOf(at, "vertices");
  if (at.json.contains("warnings"))
    for (const Place& entry : objectsOf(at, "warnings")) textOf(entry, "kind"), countOf(entry, "count"), textOf(entry, "first");
  return at.json;
}

AssetRecord readAsset(const Place& at) {
  AssetRecord asset;
  asset.name = textOf(at, "name");
  asset.source = textOf(at, "source");
  asset.state = readState(at);
  asset.reason = textOf(at, "reason");
  asset.key = textOf(at, "key");
  asset.code = int(countOf(at, "code", 255));
  asset.error = textOf(at, "error");
  asset.seconds = amountOf(at, "seconds");
  asset.bytes = countOf(at, "bytes");
  asset.output_hash = textOf(at, "output_hash");
  if (has(at, "level_hashes"))
    for (const Json& hash : member(at, "level_hashes", &Json::is_array, "a list").json) {
      if (!hash.is_string()) refuse(at, "level_hashes", "a list of texts");
      asset.level_hashes.push_back(hash);
    }
  if (has(at, "figures")) asset.figures = readFigures(member(at, "figures", &Json::is_object, "an object"));
  if (has(at, "report")) asset.report = readAssetReport(member(at, "report", &Json::is_object, "an object"));
  return asset;
}

BatchReport readReport(const Place& at) {
  BatchReport report;
  report.source = textOf(at, "source");
  report.output = textOf(at, "output");
  report.shard = smallCountOf(at, "shard");
  report.shards = smallCountOf(at, "shards");
  if (report.shard > report.shards || (report.shard == 0) != (report.shards == 0)) refuse(at, "shard", "one of \"shards\"");
  report.interrupted = flagOf(at, "interrupted");
  report.threads = smallCountOf(at, "threads");
  report.seconds = amountOf(at, "seconds");
  report.processor_seconds = amountOf(at, "processor_seconds");
  report.peak_memory = countOf(at, "peak_memory_bytes");
  for (const Json& name : member(at, "removed", &Json::is_array, "an array of text").json) {
    if (!name.is_string()) refuse(at, "removed", "an array of text");
    report.removed.push_back(name);
  }
  for (const Place& asset : objectsOf(at, "assets")) report.assets.push_back(readAsset(asset));
  const Place counts = member(at, "counts", &Json::is_object, "an object");
  for (const AssetState state : kAssetStates)
    if (countOf(counts, stateName(state).data()) != assetsIn(report, state))
      refuse(counts, stateName(state).data(), "the number of its assets");
  return report;
}

}  // namespace

std::string_view stateName(AssetState state) {
  switch (state) {
    case AssetState::kBaked: return "baked";
    case AssetState::kFromCache: return "from-cache";
    case AssetState::kFresh: return "fresh";
    case AssetState::kFailed: return "failed";
    case AssetState::kNotRun: return "not-run";
  }
  return "unknown";
}

std::string batchJson(const BatchReport& report) {
  Json json = {
      {"schema", kSchema}, {"source", report.source}, {"output", report.output}, {"shard", report.shard}, {"shards", report.shards}};
  json["interrupted"] = report.interrupted;
  json["threads"] = report.threads;
  json["seconds"] = report.seconds;
  json["processor_seconds"] = report.processor_seconds;
  json["peak_memory_bytes"] = report.peak_memory;
  json["counts"] = countsJson(report);
  json["removed"] = report.removed;
  json["assets"] = Json::array();
  for (const AssetRecord& asset : report.assets) json["assets"].push_back(assetJson(asset));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

BatchReport readBatchJson(std::string_view text, const std::string& file) {
  JsonFault fault;
  const std::optional<Json> json = parseJson(text, &fault);
  if (!json) refuse(file, fault.line, "the JSON " + fault.why);
  if (!json->is_object()) refuse(file, 0, "it does not contain an object");
  const Place root{file, *json, ""};
  if (textOf(root, "schema") != kSchema) refuse(root, "schema", kSchema);
  return readReport(root);
}

}  // namespace cloudbake
