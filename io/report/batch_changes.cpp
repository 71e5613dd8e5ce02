// Compares two reports of a batch. Assets are the same if their names are equal in the form that a report can store: a file name that is
// not valid UTF-8 reads back with U+FFFD.
#include <algorithm>
#include <map>
#include <set>

#include "core/text/markup.h"
#include "io/report/batch_parts.h"
#include "io/report/figures.h"

namespace cloudbake {

namespace {

std::string movedFigures(const BakeFigures& before, const BakeFigures& now) {
  std::string moved;
  for (const FigureField& field : figureFields()) {
    const std::string was = figureText(field, field.of(before)), is = figureText(field, field.of(now));
    if (was != is) moved += (moved.empty() ? "" : ", ") + figureName(field) + " from " + was + " to " + is;
  }
  return moved;
}

// An error begins with the file that it is about, and often a line and column.
std::string withoutFile(const AssetRecord& asset, const std::string& error) {
  for (const std::string& file : {onOneLine(asset.source), onOneLine(asset.name)})
    if (!file.empty() && error.starts_with(file)) return ":" + error.substr(std::min(error.size(), error.find(' ', file.size())));
  return ": " + error;
}

void appendChanges(std::vector<BatchChange>& changes, const AssetRecord& before, const AssetRecord& now) {
  const std::string name = onOneLine(now.name), error = onOneLine(now.error);
  const bool failed = before.state == AssetState::kFailed, fails = now.state == AssetState::kFailed;
  const auto fail = [&](const char* what) { changes.push_back({what, name, ": " + error, withoutFile(now, error)}); };
  if (fails && !failed) fail("fails now");
  if (fails && failed && error != onOneLine(before.error)) fail("fails with another error");
  if (failed && !fails && now.state != AssetState::kNotRun) changes.push_back({"no longer fails", name});
  if (!before.key.empty() && !now.key.empty() && before.key != now.key) changes.push_back({"inputs, settings or build changed", name});
  const std::string moved = before.figures && now.figures ? movedFigures(*before.figures, *now.figures) : "";
  if (!moved.empty()) changes.push_back({"figures moved", name, ": " + moved, ": " + moved});
}

std::map<std::string, const AssetRecord*> byName(const BatchReport& report) {
  std::map<std::string, const AssetRecord*> assets;
  for (const AssetRecord& asset : report.assets) assets.emplace(onOneLine(asset.name), &asset);
  return assets;
}

std::string shardText(const BatchReport& report) {
  return report.shards == 0 ? "the whole batch" : "shard " + std::to_string(report.shard) + " of " + std::to_string(report.shards);
}

}  // namespace

std::vector<BatchChange> batchChanges(const BatchReport& before, const BatchReport& now) {
  std::vector<BatchChange> changes;
  const auto earlier = byName(before), later = byName(now);
  std::set<std::string> removed;
  for (const std::string& name : now.removed) removed.insert(onOneLine(name));
  const AssetRecord none;
  const bool same_part = before.shard == now.shard && before.shards == now.shards;
  if (!same_part) changes.push_back({"only assets in both reports are compared: now " + shardText(now) + ", before " + shardText(before)});

  // In the order of the manifest, then the assets that are no longer in it.
  for (const AssetRecord& asset : now.assets) {
    const auto found = earlier.find(onOneLine(asset.name));
    if (found == earlier.end() && !same_part) continue;
    if (found == earlier.end()) changes.push_back({"new", onOneLine(asset.name), ", from " + onOneLine(asset.source)});
    appendChanges(changes, found == earlier.end() ? none : *found->second, asset);
  }
  for (const AssetRecord& asset : before.assets) {
    const std::string name = onOneLine(asset.name);
    if (same_part && !later.contains(name))
      changes.push_back({removed.contains(name) ? "removed" : "gone", name, ", from " + onOneLine(asset.source)});
  }
  return changes;
}

}  // namespace cloudbake
