// Without records, the names depend on the files alone: all assets of one name get the first words that tell them apart, so that no order
// of reading decides. With records, an asset keeps its name when files are added beside its own or removed.
#include "pipeline/batch/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/text/scan.h"
#include "pipeline/batch/state.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

std::string withEnding(const std::string& name, const std::string& ending) {
  if (ending.empty()) return name;
  const fs::path path = name;
  return (path.parent_path() / (path.stem().string() + "_" + ending + path.extension().string())).generic_string();
}

// How many components two paths share at their ends. Paths of one file differ at their beginnings if the working folders do.
size_t sharedEnd(const fs::path& a, const fs::path& b) {
  const std::vector<fs::path> of_a(a.begin(), a.end()), of_b(b.begin(), b.end());
  const auto [end, ignored] = std::mismatch(of_a.rbegin(), of_a.rend(), of_b.rbegin(), of_b.rend());
  return size_t(end - of_a.rbegin());
}

using Group = std::vector<PlannedAsset*>;
constexpr size_t kOtherNames = 3;

// Names are compared without case, because some file systems do not know it.
class Names {
 public:
  explicit Names(const fs::path& output) : output_(output) {}

  bool isFree(const std::string& name) const { return !taken_.contains(lowerCase(name)); }
  void give(PlannedAsset& asset, const std::string& name) {
    taken_.insert(lowerCase(name));
    asset.name = name;
  }

  // Gives the name to that one of the assets whose output it was, if the output folder has a record of one of them alone.
  void giveToOwner(const std::string& name, Group& assets) {
    const auto record = isFree(name) ? readRecord(recordFile(output_, name)) : std::nullopt;
    if (!record) return;
    size_t most = 0;
    std::vector<PlannedAsset*> owners;
    for (PlannedAsset* asset : assets) {
      const size_t shared = sharedEnd(asset->source, record->source);
      if (shared > most) owners.clear(), most = shared;
      if (shared == most && most > 0) owners.push_back(asset);
    }
    if (owners.size() != 1) return;
    give(*owners.front(), name);
    std::erase(assets, owners.front());
  }

  // Gives the assets their other names of this number, unless two of `all` have the same or one is taken.
  void giveOthers(Group& assets, const Group& all, size_t number) {
    std::set<std::string> names;
    for (const PlannedAsset* asset : all)
      if (asset->is_named_by_file && !names.insert(lowerCase(asset->other_names[number])).second) return;
    for (const PlannedAsset* asset : assets)
      if (!isFree(asset->other_names[number])) return;
    for (PlannedAsset* asset : assets) give(*asset, asset->other_names[number]);
    assets.clear();
  }

 private:
  const fs::path& output_;
  std::set<std::string> taken_;
};

// Whether one file makes two of the assets: which is which, only their author can say.
bool isNamedTwice(const Group& assets) {
  std::set<std::string> sources;
  return !std::all_of(assets.begin(), assets.end(), [&](const PlannedAsset* asset) { return sources.insert(asset->source).second; });
}

// A number tells apart what has no other difference, such as two files whose names differ in case.
void number(Group& assets, Names& names) {
  for (PlannedAsset* asset : assets) {
    int n = 1;
    while (!names.isFree(withEnding(asset->name, std::to_string(n)))) ++n;
    names.give(*asset, withEnding(asset->name, std::to_string(n)));
  }
}

}  // namespace

std::vector<std::string> namesWith(const std::string& name, const std::string& extension, const std::string& folder) {
  return {withEnding(name, extension), withEnding(name, folder), withEnding(withEnding(name, folder), extension)};
}

std::vector<std::string> separateNames(std::vector<PlannedAsset>& assets, const fs::path& output) {
  std::map<std::string, Group> all, waiting;
  Names names(output);
  for (PlannedAsset& asset : assets) all[lowerCase(asset.name)].push_back(&asset);
  for (const auto& [name, group] : all)
    for (PlannedAsset* asset : group)
      if (asset->is_named_by_file && !isNamedTwice(group))
        waiting[name].push_back(asset);
      else
        names.give(*asset, asset->name);
  // The names that a file has had, then its stem, if only one file has it.
  for (auto& [name, group] : waiting) {
    std::vector<std::string> before{group.front()->name};
    for (const PlannedAsset* asset : group) before.insert(before.end(), asset->other_names.begin(), asset->other_names.end());
    if (group.size() > 1)
      for (size_t n = 1; n <= group.size(); ++n) before.push_back(withEnding(group.front()->name, std::to_string(n)));
    for (const std::string& one : before) names.giveToOwner(one, group);
  }
  for (auto& [name, group] : waiting)
    if (all[name].size() == 1 && !group.empty() && names.isFree(name)) names.give(*group.front(), group.front()->name), group.clear();
  for (auto& [name, group] : waiting) {
    for (size_t i = 0; i < kOtherNames && !group.empty(); ++i) names.giveOthers(group, all[name], i);
    number(group, names);
  }

  std::vector<std::string> lines;
  for (const auto& [name, group] : all) {
    if (group.size() < 2) continue;
    std::string line = fmt::format("{} files are named '{}':", group.size(), fs::path(name).stem().string());
    for (const PlannedAsset* asset : group)
      line += fmt::format("{} {} <- {}", asset == group.front() ? "" : ",", asset->name, asset->source);
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace cloudbake
