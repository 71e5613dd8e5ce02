// The functions of the module: a call is JSON that names a function and its arguments, the answer is JSON with the result or the error.
// Bytes are passed as [address, count] in the module's memory. cloudbake.js is the other side.
#include <emscripten.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <list>
#include <map>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/text/json.h"
#include "core/text/markup.h"
#include "core/text/numbers.h"
#include "core/text/toml.h"
#include "io/file/write_file.h"
#include "io/report/report.h"
#include "io/volume/spheres.h"
#include "lsystem/recipe.h"
#include "pipeline/library/cloud_light.h"
#include "pipeline/library/cloudbake.h"
#include "pipeline/options/option_json.h"
#include "pipeline/options/presets.h"
#include "pipeline/options/resolve.h"
#include "pipeline/sources/grown.h"
#include "web/refusals.h"

// clang-format off
EM_JS(void, tellStage, (const char* stage), { Module["onStage"](UTF8ToString(stage)); });
// clang-format on

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// What an answer refers to, until the next call.
struct Answer {
  std::list<std::string> bytes;
  std::list<std::vector<float>> floats;
  std::string json;
  Json pass(std::string some) {
    bytes.push_back(std::move(some));
    return {uintptr_t(bytes.back().data()), bytes.back().size()};
  }
  Json pass(std::vector<float> some) {
    floats.push_back(std::move(some));
    return {uintptr_t(floats.back().data()), floats.back().size()};
  }
};

Options optionsOf(const Json& call) {
  Options options;
  for (const Json& one : call.at("options")) {
    if (one.at(0) == "threads") throw UsageError("--threads: the module has one thread: leave it out");
    options.emplace_back(one.at(0), one.at(1));
  }
  return options;
}

// A name of a file in the folder of a call: a path from its root stays below it.
fs::path nameInFolder(const std::string& name) {
  const fs::path path = fs::path(name).relative_path().lexically_normal();
  if (!path.has_filename() || path == "." || *path.begin() == "..")
    throw UsageError("'" + name + "' is not the name of a file in a folder");
  return path;
}

// The files of a call in the module's own file system, in a folder that is empty before and after.
class CallFiles {
 public:
  explicit CallFiles(const Json& call) {
    clear();
    fs::create_directory(kFolder);
    fs::current_path(kFolder);
    for (const Json& file : call.at("files")) {
      const fs::path path = nameInFolder(file.at("name"));
      if (path.has_parent_path()) createFolder(path.parent_path());
      const auto& [address, size] = file.at("bytes").get<std::pair<uintptr_t, size_t>>();
      std::FILE* opened = std::fopen(path.c_str(), "wb");
      const bool is_written = opened && std::fwrite(reinterpret_cast<const char*>(address), 1, size, opened) == size;
      if (!opened || std::fclose(opened) != 0 || !is_written) throw IoError(path.string(), "cannot be passed to the module");
    }
  }
  CallFiles(const CallFiles&) = delete;
  CallFiles& operator=(const CallFiles&) = delete;
  ~CallFiles() { clear(); }

 private:
  static constexpr const char* kFolder = "/files";
  static void clear() {
    fs::current_path("/");
    fs::remove_all(kFolder);
  }
};

void onStage(const std::string& stage) { tellStage(stage.c_str()); }

Json assetJson(BakeResult result, Answer& answer) {
  return {
      {"glb", answer.pass(std::move(result.glb))}, {"report", parseJson(result.report).value()}, {"summary", onOwnLines(result.summary)}};
}

Json bakeCall(const Json& call, Answer& answer) {
  const CallFiles files(call);
  return assetJson(bake(nameInFolder(call.at("name")), optionsOf(call), onStage), answer);
}

// A preset, or a recipe or a list of rules among the files.
fs::path grownSource(const Json& call) {
  return call.at("files").empty() ? fs::path(call.at("name").get<std::string>()) : nameInFolder(call.at("name"));
}

#ifdef CLOUDBAKE_WHOLE
Json growCall(const Json& call, Answer& answer) {
  const CallFiles files(call);
  return assetJson(grow(grownSource(call), optionsOf(call), onStage), answer);
}
#endif

// The presets with what their recipes set, and the table of options of `grow`.
Json presetsCall(const Json&, Answer&) {
  Json all = Json::array(), table = Json::array();
  for (const Preset& preset : presets()) {
    SourceSettings source;
    source.input = preset.name;
    source.kind = SourceKind::kPreset;
    Json values = Json::object();
    const toml::table recipe = parseTomlTable(preset.toml, preset.name);
    for (const RecipeKey& key : recipeKeys()) {
      const auto node = *key.table ? recipe[key.table][key.name] : recipe[key.name];
      if (const auto number = node.value<double>(); number && *key.unit) values[key.name] = shortestText(*number);
    }
    for (const Given& given : readGrownSource(source).given) values[given.option->name] = given.value;
    std::string_view about = preset.toml;
    about.remove_prefix(about.find_first_not_of("# "));
    all.push_back({{"name", preset.name}, {"about", about.substr(0, about.find('\n'))}, {"values", values}});
  }
  for (const Option& option : optionTable()) {
    if (!(option.commands & kGrow) || option.files.kind != FileUse::kNone) continue;
    table.push_back(optionJson(option, kGrow));
    table.back()["offered"] = !(option.bits & kNotOnPage);
  }
  return {{"presets", all}, {"options", table}};
}

// The clouds of transmittance(), by number.
std::map<int, CloudLight>& lights() {
  static std::map<int, CloudLight> all;
  return all;
}

const CloudLight& lightOf(const Json& call) {
  const auto found = lights().find(call.at("light"));
  if (found == lights().end()) throw UsageError("this light was closed: open another one with transmittance()");
  return found->second;
}

Json openLightCall(const Json& call, Answer&) {
  const CallFiles files(call);
  static int last_number = 0;  // is not used again, so that a closed one stays closed
  const int number = ++last_number;
  const auto light = lights().try_emplace(number, nameInFolder(call.at("name")), optionsOf(call)).first;
  return {{"light", number}, {"vertices", light->second.vertexCount()}};
}

Json lengthsCall(const Json& call, Answer& answer) {
  const std::array<float, 3> direction = call.at("direction");
  return {{"lengths", answer.pass(lightOf(call).lengths({direction[0], direction[1], direction[2]}))}};
}

Json lobesCall(const Json& call, Answer& answer) {
  const CloudLight::Lobes baked = lightOf(call).lobes(optionsOf(call));
  std::vector<float> floats;
  for (const Lobe& lobe : baked.lobes) floats.insert(floats.end(), {lobe.direction.x, lobe.direction.y, lobe.direction.z, lobe.thickness});
  Json fit = Json::array();
  for (const FitError& error : baked.fit)
    fit.push_back({{"extinction", error.extinction}, {"mean_rms", error.mean_rms}, {"fitted_rms", error.fitted_rms}});
  return {{"lobes", answer.pass(std::move(floats))},
          {"exponent", baked.shape.exponent},
          {"bias", baked.shape.bias},
          {"extinction", baked.extinction},
          {"fit", fit}};
}

Json closeLightCall(const Json& call, Answer&) {
  lights().erase(call.at("light").get<int>());
  return Json::object();
}

// Up to its spheres.
Json expandCall(const Json& call, Answer& answer) {
  const CallFiles files(call);
  SourceSettings source;
  source.memory_limit = defaultMemoryLimit();
  source.input = grownSource(call);
  source.kind = sourceKindOf(source.input);
  if (!isGrown(source.kind)) source.kind = call.at("files").empty() ? SourceKind::kPreset : SourceKind::kRules;
  GrownSource grown = readGrownSource(source);
  std::vector<Given> given = grown.given;
  for (Given& one : givenBy(optionsOf(call), kGrow)) given.push_back(std::move(one));
  Settings settings = resolve(source, given);
  settings.source.spheres_only = true;
  BakeReport report;
  report.command = "grow";
  report.input = source.input.string();
  Stopwatch watch;
  const Cloud cloud = growCloud(std::move(grown), settings, std::nullopt, report, watch);
  enforceStrict(settings.run.strict, report);
  std::vector<float> spheres;
  for (const Sphere& s : cloud.spheres) spheres.insert(spheres.end(), {s.center.x, s.center.y, s.center.z, s.radius});
  return {{"spheres", answer.pass(std::move(spheres))},
          {"ply", answer.pass(encodeSpheres(cloud.spheres, SphereFormat::kPly))},
          {"report", parseJson(reportJson(report)).value()},
          {"summary", onOwnLines(warningLines(report) + reportText(report))}};
}

// The table of options of a bake, as --help-all shows it, and the sculpts that can be read.
Json optionsCall(const Json&, Answer&) {
  Json table = Json::array();
  for (const Option& option : optionTable()) {
    if (!(option.commands & kBake) || option.files.kind != FileUse::kNone) continue;
    table.push_back(optionJson(option, kBake));
    table.back()["offered"] = !(option.bits & kNotOnPage);
  }
  return {{"options", table}, {"sculpts", ".gltf, .glb, .obj, .stl, .ply, .off"}, {"version", version()}};
}

std::string jsonText(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

// As the program prints it: what a file has in it may not break a line.
std::string errorText(const Error& error) {
  return "{\"refused\": " + std::string(has_refused ? "true" : "false") +
         ", \"error\": " + errorJson(Error(error.code, onOneLine(error.file), error.line, error.column, onOneLine(error.message))) + "}";
}

}  // namespace

}  // namespace cloudbake

extern "C" EMSCRIPTEN_KEEPALIVE const char* cloudbake_call(const char* request) {
  using namespace cloudbake;
  static Answer answer;
  answer = {};
  static const std::map<std::string, Json (*)(const Json&, Answer&)> kCalls = {
#ifdef CLOUDBAKE_WHOLE
      {"grow", growCall},
#endif
      {"bake", bakeCall},     {"openLight", openLightCall}, {"lengths", lengthsCall}, {"lobes", lobesCall}, {"closeLight", closeLightCall},
      {"expand", expandCall}, {"presets", presetsCall},     {"options", optionsCall}};
  has_refused = false;
  try {
    const Json call = parseJson(request).value();
    answer.json = jsonText(kCalls.at(call.at("call"))(call, answer));
  } catch (const Error& error) {
    answer.json = errorText(error);
  } catch (const std::bad_alloc&) {
    answer.json =
        errorText(MemoryError("", "the module's memory ran out: use fewer --voxels or a smaller input, or the program `cloudbake`"));
  } catch (const std::exception& error) {
    answer.json = errorText(Error(ExitCode::kInternal, "", 0, 0, std::string("internal error: ") + error.what()));
  }
  return answer.json.c_str();
}
