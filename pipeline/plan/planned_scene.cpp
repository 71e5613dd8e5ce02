#include "pipeline/plan/planned_scene.h"

#include <functional>
#include <sstream>
#include <string_view>

#include "core/text/maker.h"
#include "core/text/toml.h"
#include "pipeline/picture/picture.h"
#include "pipeline/scene/scene_file.h"
#include "pipeline/scene/scene_keys.h"

namespace cloudbake {

namespace {

using Visit = std::function<void(toml::table&)>;

// Calls visit for the tables of a name such as "sky.moon"; a table of several is visited once for each.
void forTables(toml::table& table, std::string_view name, const Visit& visit) {
  const size_t dot = name.find('.');
  toml::node* node = table.get(name.substr(0, dot));
  const auto go_on = [&](toml::table& inner) {
    if (dot == std::string_view::npos)
      visit(inner);
    else
      forTables(inner, name.substr(dot + 1), visit);
  };
  if (!node) return;
  if (toml::table* one = node->as_table()) return go_on(*one);
  if (toml::array* several = node->as_array())
    for (toml::node& one : *several)
      if (toml::table* inner = one.as_table()) go_on(*inner);
}

std::string relativeTo(const std::filesystem::path& folder, const std::filesystem::path& file) {
  return std::filesystem::absolute(file)
      .lexically_normal()
      .lexically_relative(std::filesystem::absolute(folder).lexically_normal())
      .generic_string();
}

// A cloud, or a field with its clouds.
void replaceClouds(toml::table& table, std::span<const SceneCloud> clouds, const std::map<std::string, PlannedCloud>& planned,
                   const std::filesystem::path& folder) {
  toml::array files;
  bool levels = false;
  for (const SceneCloud& cloud : clouds) {
    const auto found = planned.find(keyOf(cloud));
    files.push_back(found == planned.end() ? relativeTo(folder, cloud.file) : found->second.file);
    levels = levels || (found != planned.end() && found->second.levels);
  }
  for (const char* key : {"file", "files", "preset", "presets", "lobe", "levels"}) table.erase(key);
  for (const auto& key : growthKeys()) table.erase(key.name);
  if (clouds.size() == 1)
    table.insert("file", *files.get_as<std::string>(0));
  else
    table.insert("files", std::move(files));
  if (levels) table.insert("levels", true);
}

}  // namespace

std::string plannedScene(const std::filesystem::path& file, const std::string& text, const std::filesystem::path& folder,
                         const std::map<std::string, PlannedCloud>& clouds, const PlannedSizes& sizes) {
  const SceneFile scene = readSceneFile(file, text, [](const PictureSettings& view) { return view; });
  toml::table table = parseTomlTable(text, file.string());
  for (const SpecialKey& key : specialKeys())
    if (std::string_view(key.values) == "a file")
      forTables(table, key.table, [&](toml::table& owner) {
        if (const auto name = owner[key.name].value<std::string>())
          owner.insert_or_assign(key.name, relativeTo(folder, file.parent_path() / *name));
      });
  size_t cloud = 0, field = 0;
  forTables(table, "cloud", [&](toml::table& owner) {
    if (owner.contains("scatter"))
      replaceClouds(owner, scene.fields[field].clouds, clouds, folder), ++field;
    else
      replaceClouds(owner, {&scene.clouds[cloud], 1}, clouds, folder), ++cloud;
  });
  const auto tableOf = [&](const char* name) -> toml::table& { return *table.insert(name, toml::table{}).first->second.as_table(); };
  const auto listOf = [](Vec3 v) { return toml::array{double(v.x), double(v.y), double(v.z)}; };
  if (sizes.camera) {
    toml::table& camera = tableOf("camera");
    for (const char* key : {"azimuth", "elevation", "distance"}) camera.erase(key);
    camera.insert_or_assign("position", listOf(sizes.camera->look_from));
    camera.insert_or_assign("target", listOf(sizes.camera->look_at));
  }
  toml::table& chain = tableOf("chain");
  chain.insert("far_distance", sizes.far_distance);
  if (!scene.post.published) chain.insert_or_assign("detail_size", double(scene.post.painted.detail_size) * sizes.detail_factor);
  std::ostringstream out;
  out << "# " << kMaker << ": the plan of a scene; `cloudbake plan` writes it anew.\n";
  out << toml::toml_formatter(table) << "\n";
  return out.str();
}

}  // namespace cloudbake
