// Compares two reports of a batch. Assets are the same if their names are equal in the form that a report can store: a file name that is
// not valid UTF-8 reads back with U+FFFD.
#include <map>

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

void appendChanges(std::vector<std::string>& lines, const AssetRecord& before, const AssetRecord& now) {
  const std::string name = onOneLine(now.name), error = onOneLine(now.error);
  const bool failed = before.state == AssetState::kFailed, fails = now.state == AssetState::kFailed;
  if (fails && !failed) lines.push_back("fails now: " + name + ": " + error);
  if (fails && failed && error != onOneLine(before.error)) lines.push_back("fails with another error: " + name + ": " + error);
  if (failed && !fails && now.state != AssetState::kNotRun) lines.push_back("no longer fails: " + name);
  if (!before.key.empty() && !now.key.empty() && before.key != now.key) lines.push_back("inputs, settings or build changed: " + name);
  const std::string moved = before.figures && now.figures ? movedFigures(*before.figures, *now.figures) : "";
  if (!moved.empty()) lines.push_back("figures moved: " + name + ": " + moved);
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

std::vector<std::string> batchChanges(const BatchReport& before, const BatchReport& now) {
  std::vector<std::string> lines;
  const auto earlier = byName(before), later = byName(now);
  const AssetRecord none;
  const bool same_part = before.shard == now.shard && before.shards == now.shards;
  if (!same_part) lines.push_back("only assets in both reports are compared: now " + shardText(now) + ", before " + shardText(before));

  // In the order of the manifest, then the assets that are no longer in it.
  for (const AssetRecord& asset : now.assets) {
    const auto found = earlier.find(onOneLine(asset.name));
    if (found == earlier.end() && !same_part) continue;
    if (found == earlier.end()) lines.push_back("new: " + onOneLine(asset.name) + ", from " + onOneLine(asset.source));
    appendChanges(lines, found == earlier.end() ? none : *found->second, asset);
  }
  for (const AssetRecord& asset : before.assets)
    if (same_part && !later.contains(onOneLine(asset.name)))
      lines.push_back("gone: " + onOneLine(asset.name) + ", from " + onOneLine(asset.source));
  return lines;
}

}  // namespace cloudbake
