// Shards are parts of about equal cost, by the longest-processing-time rule (R. L. Graham, "Bounds on Multiprocessing Timing Anomalies",
// SIAM J. Appl. Math. 17, 1969, section 5), which is within 4/3 of the best.
#include "pipeline/batch/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <iterator>
#include <map>
#include <numeric>

#include "core/error.h"
#include "core/text/plain_text.h"
#include "core/text/scan.h"
#include "io/file/find_files.h"
#include "io/file/write_file.h"
#include "io/sculpt/read_mesh.h"
#include "pipeline/asset/levels.h"
#include "pipeline/batch/manifest.h"
#include "pipeline/batch/names.h"
#include "pipeline/batch/state.h"
#include "pipeline/options/presets.h"
#include "pipeline/options/resolve.h"
#include "pipeline/scene/scene_file.h"
#include "pipeline/sources/folder_files.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// What has no line stands on the command line.
[[noreturn]] void refuseAt(const ManifestValue& place, const std::string& file, const std::string& what) {
  if (file.empty() || place.line == 0) throw UsageError(what);
  throw InputError(file, place.line, place.column, what);
}

// The place of a request, and the options that belong to it.
struct Request {
  std::string file;
  ManifestValue place;
  std::vector<Given> defaults, own, given;
  ReadSettings read;
  std::optional<ManifestValue> name;
};

// --- Names ---

using Words = std::map<std::string, std::string>;

// Fills in the words of a template such as "{folder}/{stem}.glb". An empty folder leaves no '/'.
std::string fillTemplate(const std::string& pattern, const Words& words, const Request& request, const ManifestValue& place) {
  std::string name;
  for (size_t i = 0; i < pattern.size(); ++i) {
    if (pattern[i] != '{') {
      name += pattern[i];
      continue;
    }
    const size_t end = pattern.find('}', i);
    const auto word = end == pattern.npos ? words.end() : words.find(pattern.substr(i + 1, end - i - 1));
    if (word == words.end())
      refuseAt(place, request.file,
               "name '" + pattern + "': the words in braces are {stem}, {ext}, {folder} and, for grown clouds, {seed}");
    name += word->second;
    i = end;
  }
  name = fs::path(name).lexically_normal().generic_string();
  while (name.starts_with('/') && !pattern.starts_with('/')) name.erase(0, 1);
  if (fs::path(name).has_root_path() || name.starts_with("..") || name.starts_with(".cloudbake"))
    refuseAt(place, request.file, "name '" + name + "': an output must be inside the output folder: leave out '..' and a leading '/'");
  if (lowerCase(fs::path(name).extension().string()) != ".glb" || fs::path(name).stem().empty())
    refuseAt(place, request.file, "name '" + name + "': outputs are GLB files: end the name in .glb");
  return name;
}

std::string lexicalFolder(const fs::path& file, const fs::path& root) {
  const std::string folder = file.parent_path().lexically_relative(root.empty() ? "." : root).generic_string();
  return folder == "." || folder.starts_with("..") ? "" : folder;
}

// --- Options ---

// An option that only sequences have, or one of the bake of their frames.
const Option* sequenceOption(std::string_view name) {
  const Option* option = findOption(name, kSequence);
  return option && !(option->bits & kOfRun) ? option : nullptr;
}

std::vector<Given> optionsOf(const std::vector<ManifestValue>& values, const Manifest& manifest, bool of_sequence = false) {
  const std::string file = manifest.file.string();
  std::vector<Given> options;
  for (const ManifestValue& value : values) {
    const Option* option = of_sequence ? sequenceOption(value.key) : findAssetOption(value.key);
    if (!option)
      refuseAt(value, file,
               fmt::format("unknown key '{}': give an option of `cloudbake {}`, with _ for -", value.key,
                           of_sequence ? "sequence" : "grow` or `bake"));
    Given set{option, value.value, file, value.line, value.column};
    if (value.key == "scene" && !fs::path(value.value).is_absolute()) set.value = (manifest.file.parent_path() / value.value).string();
    options.push_back(std::move(set));
  }
  return options;
}

bool suits(const Given& given, const PlannedAsset& asset) {
  return (given.option->inputs & inputBit(asset.from.kind)) != 0 && (!asset.is_sequence || (given.option->commands & kSequence) != 0);
}

bool isOfFrame(const Given& given) {
  const std::string_view name = given.option->name;
  return name == "units" || name == "up";
}

// Defaults and options of the command line are used if they apply to the asset; a cloud's own options must apply. A frame that is for all
// sculpts is for those whose files state none.
void chooseOptions(PlannedAsset& asset, const Request& request) {
  const bool has_own_frame = std::any_of(request.own.begin(), request.own.end(), isOfFrame);
  const auto addSuiting = [&](const std::vector<Given>& options) {
    for (const Given& option : options) {
      if (!suits(option, asset)) continue;
      if (isOfFrame(option) && !has_own_frame) asset.from.read.frame_if_unstated = true;
      asset.given.push_back(option);
    }
  };
  addSuiting(request.defaults);
  for (const Given& option : request.own) {
    if (!suits(option, asset))
      throw InputError(option.file, option.line, option.column,
                       std::string("'") + option.option->name + "' does not apply to " + kindText(asset.from.kind) + ": remove it");
    asset.given.push_back(option);
  }
  addSuiting(request.given);
}

// --- Estimates ---

// Estimates the seconds on one thread, and the peak bytes beyond the program itself as an upper limit. The limit was compared with the peak
// memory of twelve clouds and sculpts at 50 to 400 voxels, and of 5 million triangles. A cell needs a sweep's field and its turned copies;
// a grown cloud needs the vertices of its surface; a glTF may have instances, which need more than the file; a reader in a child process
// has its own copies. Levels are compared in pictures.
void estimate(PlannedAsset& asset, const Settings& settings) {
  const double voxels = settings.field.bake_voxels.value_or(settings.field.voxels), cells = voxels * voxels * voxels;
  std::error_code error;
  const auto size = double(asset.from.kind == SourceKind::kPreset ? 0 : fs::file_size(asset.from.input, error));
  const double bytes = error ? 0 : size;
  const double rays = settings.lobe.bake.rays / 100.0 * (settings.lobe.bake.method == Method::kRays ? 40 : 1);
  const bool grown = isGrown(asset.from.kind);
  asset.cost_seconds =
      0.04 + (grown ? 3e-7 * cells : 1e-7 * bytes + 2e-8 * cells) + rays * (0.01 + (grown ? 4e-6 * voxels * voxels : 2e-9 * bytes));
  if (settings.lobe.target_error) asset.cost_seconds += 2;
  if (settings.lobe.fit) asset.cost_seconds *= 4;
  asset.cost_seconds += 0.5 * double(asset.levels);
  const std::string extension = lowerCase(asset.from.input.extension().string());
  const double instances = extension == ".glb" || extension == ".gltf" ? 60e6 : 0;
  const double child = isReadByChild(asset.from.input) && asset.from.kind == SourceKind::kSculpt ? 30e6 + 20 * bytes : 0;
  const auto frames = double(!asset.is_sequence     ? 1
                             : asset.frames.empty() ? size_t(settings.sequence.frames.value_or(kGrownFrames))
                                                    : asset.frames.size());
  asset.cost_seconds *= frames;
  const double at_once = asset.is_sequence ? std::min(frames, double(settings.sequence.fade) + 4) : 1;
  asset.memory = uint64_t(
      at_once * (12e6 + 15 * cells + (grown ? 2000 * voxels * voxels : 8 * bytes + instances + child) + (asset.levels > 0 ? 150e6 : 0)));
}

// --- Assets ---

Settings checkedSettings(const PlannedAsset& asset, BatchPlan& plan) {
  try {
    return resolve(asset.from, asset.given, sceneOf(asset, plan));
  } catch (const UsageError& error) {
    throw InputError(asset.file.empty() ? asset.source : asset.file, asset.line, asset.column, error.message);
  }
}

void addAsset(BatchPlan& plan, PlannedAsset asset, const Request& request) {
  asset.file = request.file;
  asset.line = request.place.line;
  asset.column = request.place.column;
  asset.from.read = request.read;
  chooseOptions(asset, request);
  const Settings settings = checkedSettings(asset, plan);
  asset.from.read.allow_outside = settings.source.read.allow_outside;
  asset.levels = settings.mesh.levels.size();
  if (!asset.frames.empty() && (settings.sequence.frames || !settings.sequence.animation.empty()))
    refuseAt(request.place, request.file, "frame_count and animation do not apply to frames that are files: leave them out");
  if (asset.is_sequence && settings.sequence.output == SequenceOutput::kKeys)
    refuseAt(request.place, request.file, "a batch writes a sequence to one file: give as = 'morph' or 'picture'");
  estimate(asset, settings);
  plan.assets.push_back(std::move(asset));
}

std::string templateOf(const Request& request, const char* fallback) { return request.name ? request.name->value : fallback; }

// A folder as a part of a name: "a/b" becomes "a_b".
std::string folderWord(const fs::path& folder) {
  std::string word;
  for (const fs::path& part : folder.lexically_normal().relative_path())
    if (part != "." && part != "..") word += (word.empty() || part.empty() ? "" : "_") + part.string();
  return word;
}

// Sets the name, and the names that take its place if several files have the same. Those have the words that the template does not have;
// `folder` is the one that tells files apart, which for the files of a list, without a common root, is not {folder}.
void nameByFile(PlannedAsset& asset, const std::string& pattern, const Words& words, const fs::path& folder, const Request& request) {
  const auto has = [&](const char* word) { return pattern.find(word) != pattern.npos; };
  asset.name = fillTemplate(pattern, words, request, request.name.value_or(request.place));
  asset.is_named_by_file = has("{stem}");
  if (!asset.is_named_by_file) return;
  const bool has_folder = has("{folder}") && folder == words.at("folder");
  asset.other_names = namesWith(asset.name, has("{ext}") ? "" : words.at("ext"), has_folder ? "" : folderWord(folder));
}

// A sculpt below the folder `root`, or one of a list, which has none.
void addSculpt(BatchPlan& plan, const fs::path& file, const std::optional<fs::path>& root, const Request& request) {
  PlannedAsset asset;
  const std::string folder = root ? lexicalFolder(file, *root) : "";
  const Words words{{"stem", file.stem().string()},
                    {"ext", lowerCase(file.extension().string()).substr(file.has_extension() ? 1 : 0)},
                    {"folder", folder}};
  nameByFile(asset, templateOf(request, "{folder}/{stem}.glb"), words, root ? fs::path(folder) : file.parent_path(), request);
  asset.source = file.string();
  asset.from.kind = isVdbFile(file) ? SourceKind::kVolume : SourceKind::kSculpt;
  asset.from.input = file;
  addAsset(plan, std::move(asset), request);
}

void addGrown(BatchPlan& plan, const ManifestCloud& cloud, SourceKind kind, const fs::path& input, Request request) {
  const bool is_preset = kind == SourceKind::kPreset;
  const std::string stem = is_preset ? input.string() : input.stem().string();
  const std::vector<Given> own = request.own;
  for (size_t i = 0; i < std::max<size_t>(1, cloud.seeds.size()); ++i) {
    PlannedAsset asset;
    asset.is_sequence = cloud.is_sequence;
    asset.from.kind = kind;
    asset.from.input = input;
    asset.source = is_preset ? "preset " + stem : input.string();
    Words words{{"stem", stem}, {"ext", is_preset ? "" : input.extension().string().substr(1)}, {"folder", ""}};
    if (!cloud.seeds.empty()) {
      const std::string seed = std::to_string(cloud.seeds[i]);
      words["seed"] = seed;
      asset.source += ", seed " + seed;
      request.own = own;
      request.own.push_back({findAssetOption("seed"), seed, request.file, request.place.line, request.place.column});
    }
    const char* fallback = cloud.seeds.empty() ? "{stem}.glb" : "{stem}_{seed}.glb";
    nameByFile(asset, templateOf(request, fallback), words, is_preset ? "" : lexicalFolder(input, fs::path(request.file).parent_path()),
               request);
    if (is_preset) asset.is_named_by_file = false;
    addAsset(plan, std::move(asset), request);
  }
}

// The frames of a pattern, a folder or an animation: "smoke.####.vdb" makes "smoke.glb", and so does "smoke/".
void addFrames(BatchPlan& plan, const fs::path& input, const Request& request) {
  PlannedAsset asset;
  asset.is_sequence = true;
  const bool is_animated = mayBeAnimated(input);
  if (!is_animated) asset.frames = frameFiles(input);
  std::string stem = (input.has_filename() ? input : input.parent_path()).filename().string();
  stem.erase(is_animated ? input.stem().string().size() : std::min(stem.find_first_of("#%*?["), stem.size()));
  stem.erase(stem.find_last_not_of("._- ") + 1);
  const Words words{{"stem", stem.empty() ? "sequence" : stem}, {"ext", ""}, {"folder", ""}};
  nameByFile(asset, templateOf(request, "{stem}.glb"), words, input.parent_path(), request);
  asset.source = input.string();
  asset.from.input = is_animated ? input : asset.frames.front().file;
  asset.from.kind = isVdbFile(asset.from.input) ? SourceKind::kVolume : SourceKind::kSculpt;
  addAsset(plan, std::move(asset), request);
}

// Whether this batch or another one writes the file, so that a folder or a pattern does not mean it.
bool isWritten(const BatchPlan& plan, const fs::path& file) {
  std::error_code error;
  return plan.reports.contains(fs::weakly_canonical(file, error)) || isBatchOutput(file);
}

fs::path besideManifest(const Manifest& manifest, const std::string& named) {
  return fs::path(named).is_absolute() ? fs::path(named) : manifest.file.parent_path() / named;
}

void addCloud(BatchPlan& plan, const Manifest& manifest, const ManifestCloud& cloud, Request request, std::set<fs::path>& folders) {
  const std::string file = manifest.file.string();
  request.own = optionsOf(cloud.options, manifest, cloud.is_sequence);
  if (cloud.name) request.name = cloud.name;
  for (const ManifestValue& source : cloud.sources) {
    request.place = source;
    const SourceKind kind = cloud.is_sequence ? sourceKindOf(source.value) : cloud.kind;
    if (cloud.is_sequence && !isGrown(kind)) {
      if (!cloud.seeds.empty()) refuseAt(source, file, "'seeds' are for clouds that grow from rules: remove it");
      const fs::path path = besideManifest(manifest, source.value);
      addFrames(plan, path, request);
      folders.insert(fs::is_directory(path) ? path : path.parent_path());
      continue;
    }
    if (kind == SourceKind::kPreset) {
      if (!findPreset(source.value)) refuseAt(source, file, "no preset '" + source.value + "': the presets are " + presetNames());
      addGrown(plan, cloud, kind, source.value, request);
      continue;
    }
    const fs::path path = besideManifest(manifest, source.value);
    if (kind != SourceKind::kSculpt) {
      if (!fs::is_regular_file(path))
        refuseAt(source, file, "no file '" + path.string() + "': check its name; paths are relative to the manifest");
      addGrown(plan, cloud, kind, path, request);
      continue;
    }
    std::vector<fs::path> sculpts = filesMatching(path, folders);
    const size_t written =
        isPattern(source.value) ? std::erase_if(sculpts, [&](const fs::path& sculpt) { return isWritten(plan, sculpt); }) : 0;
    if (sculpts.empty() && written > 0)
      refuseAt(source, file, "only files that a batch has written match '" + path.string() + "': name the sculpts");
    if (sculpts.empty())
      refuseAt(source, file,
               "no file " + std::string(isPattern(source.value) ? "matches '" : "'") + path.string() +
                   "': check the name; paths are relative to the manifest");
    for (const fs::path& sculpt : sculpts) addSculpt(plan, sculpt, fixedFolder(path), request);
  }
}

void planManifest(BatchPlan& plan, const fs::path& file, Request request) {
  const Manifest manifest = readManifest(file);
  plan.scene = manifest.scene;
  plan.watched.push_back(file);
  request.file = file.string();
  request.defaults = optionsOf(manifest.defaults, manifest);
  if (!request.name) request.name = manifest.name;
  std::set<fs::path> folders;
  for (const ManifestCloud& cloud : manifest.clouds) addCloud(plan, manifest, cloud, request, folders);
  plan.watched.insert(plan.watched.end(), folders.begin(), folders.end());
}

void planFolder(BatchPlan& plan, const fs::path& folder, const fs::path& output, const Request& request) {
  std::error_code error;
  if (fs::equivalent(folder, output, error)) throw UsageError("-o is the folder of the sculpts: choose another folder for the assets");
  std::set<fs::path> folders;
  std::vector<fs::path> unread;
  for (const fs::path& file : filesBelow(folder, output, folders)) {
    if (isWritten(plan, file)) continue;
    if (isSculptFile(file) || isVdbFile(file))
      addSculpt(plan, file, folder, request);
    else
      unread.push_back(file);
  }
  plan.notes = linesAboutUnread(unread);
  if (plan.assets.empty())
    throw InputError(folder.string(), fmt::format("no sculpt in this folder: {} or .vdb{}{}", sculptExtensions(),
                                                  plan.notes.empty() ? "" : "; ", fmt::join(plan.notes, "; ")));
  plan.watched.assign(folders.begin(), folders.end());
}

void planList(BatchPlan& plan, const fs::path& list, const Request& request) {
  const bool from_stdin = list == "-";
  const std::string bytes = from_stdin ? std::string(std::istreambuf_iterator<char>(std::cin), {}) : readFileOrPipe(list);
  std::string mended;
  LineScanner lines{plainText(bytes, list.string(), mended)};
  while (const auto line = lines.next()) {
    if (line->empty()) continue;
    const fs::path file(*line);
    if (!fs::is_regular_file(file))
      throw InputError(list.string(), lines.line,
                       "no file '" + file.string() + "': the list has a path per line, relative to the working folder");
    addSculpt(plan, file, std::nullopt, request);
  }
  if (plan.assets.empty()) throw InputError(list.string(), "the list names no file: give a path per line");
  if (!from_stdin) plan.watched.push_back(list);
}

// Throws if two assets have the same name, also if only the case differs, or if an output would replace an input.
void checkNames(const BatchPlan& plan, const fs::path& output) {
  const auto fail = [](const PlannedAsset& asset, const std::string& what) {
    if (asset.file.empty()) throw UsageError(what);
    throw InputError(asset.file, asset.line, asset.column, what);
  };
  const auto namesOf = [](const PlannedAsset& asset) {
    std::vector<std::string> names = levelNames(asset.name, asset.levels);
    names.insert(names.begin(), asset.name);
    return names;
  };
  std::map<std::string, const PlannedAsset*> by_name;
  for (const PlannedAsset& asset : plan.assets)
    for (const std::string& name : namesOf(asset)) {
      const auto [found, is_new] = by_name.emplace(lowerCase(name), &asset);
      if (!is_new)
        fail(asset, "'" + name + "' is the output of " + found->second->source + " and of " + asset.source +
                        ": give a name that differs, such as '{stem}_{ext}.glb' or '{stem}_{seed}.glb'");
    }
  std::map<fs::path, const PlannedAsset*> inputs;
  for (const PlannedAsset& asset : plan.assets) {
    if (asset.from.kind != SourceKind::kPreset) inputs.emplace(fs::weakly_canonical(asset.from.input), &asset);
    for (const FrameInput& frame : asset.frames) inputs.emplace(fs::weakly_canonical(frame.file), &asset);
  }
  for (const PlannedAsset& asset : plan.assets)
    for (const std::string& name : namesOf(asset))
      if (const auto found = inputs.find(fs::weakly_canonical(output / name)); found != inputs.end())
        fail(asset, "'" + name + "' would replace the sculpt " + found->second->source + ": choose another output folder");
}

}  // namespace

std::vector<std::string> levelNames(const std::string& name, size_t levels) {
  std::vector<std::string> names;
  for (size_t level = 1; level <= levels; ++level) names.push_back(levelFile(name, level).generic_string());
  return names;
}

std::optional<fs::path> sceneFileOf(const PlannedAsset& asset) {
  std::optional<fs::path> file;
  for (const Given& given : asset.given)
    if (std::string_view(given.option->name) == "scene") file = given.value;
  return file;
}

std::optional<SceneNeeds> sceneOf(const PlannedAsset& asset, const BatchPlan& plan) {
  const auto file = sceneFileOf(asset);
  return file ? readSceneNeeds(*file, asset.from.read.read_file) : plan.scene;
}

BatchPlan planBatch(const Settings& settings, std::span<const Given> given) {
  const BatchSettings& batch = settings.batch;
  BatchPlan plan;
  Request request;
  request.given.assign(given.begin(), given.end());
  request.read.child_program = settings.source.read.child_program;  // a run gives each asset its part of the memory
  request.read.read_file = settings.source.read.read_file;
  for (const auto& report : {settings.run.json, batch.html, batch.junit, batch.depfile})
    if (report) plan.reports.insert(fs::weakly_canonical(*report));
  if (batch.name) request.name = ManifestValue{"name", *batch.name, 0, 0};
  if (batch.inputs.size() + (batch.input_list ? 1 : 0) != 1)
    throw UsageError(batch.inputs.empty() ? "MANIFEST.toml or FOLDER is needed, or --input-list: what to bake"
                                          : "one manifest, one folder or one --input-list is needed, not several");
  const fs::path input = batch.input_list ? *batch.input_list : batch.inputs.front();
  plan.source = input.string();
  if (batch.input_list)
    planList(plan, input, request);
  else if (fs::is_directory(input))
    planFolder(plan, input, settings.output.file, request);
  else if (lowerCase(input.extension().string()) == ".toml")
    planManifest(plan, input, request);
  else if (fs::exists(input))
    throw InputError(plan.source, "a manifest (.toml) or a folder is needed: bake one sculpt with `cloudbake bake`");
  else
    throw IoError(plan.source, "no such manifest (.toml) or folder: check the name");
  for (std::string& line : separateNames(plan.assets, settings.output.file)) plan.notes.push_back(std::move(line));
  checkNames(plan, settings.output.file);
  return plan;
}

std::vector<PlannedAsset> shardOf(const std::vector<PlannedAsset>& assets, int shard, int shards) {
  std::vector<size_t> order(assets.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return assets[a].cost_seconds != assets[b].cost_seconds ? assets[a].cost_seconds > assets[b].cost_seconds
                                                            : assets[a].name < assets[b].name;
  });
  std::vector<double> load(size_t(shards), 0);
  std::vector<size_t> mine;
  for (const size_t i : order) {
    const auto least = std::min_element(load.begin(), load.end());
    *least += assets[i].cost_seconds;
    if (least - load.begin() == shard - 1) mine.push_back(i);
  }
  std::sort(mine.begin(), mine.end());
  std::vector<PlannedAsset> part;
  for (const size_t i : mine) part.push_back(assets[i]);
  return part;
}

std::string exampleManifest() {
  return R"toml(# A batch of clouds:  cloudbake batch clouds.toml -o baked
# Paths are relative to this file. Options are those of `cloudbake grow --help-all` and `cloudbake bake --help-all`, with _ for -.

# Names of the outputs: {stem}, {ext}, {folder} and, for grown clouds, {seed}.
# name = '{folder}/{stem}.glb'

# Options for every cloud that they apply to.
[defaults]
rays = 100

# The scene that the clouds are made for. It sets the target error of the bakes and the vertices of grown clouds.
# [scene.camera]
# distance = 200             # world units, to the clouds
# fov = 50                   # degrees, vertical
# [scene.picture]
# height = 1080              # pixels
# [scene.sun]
# elevation = [5, 60]        # degrees; for `lobe = 'fit'`

# Twelve clouds from one preset. Instead of `preset`: recipe = 'FILE.toml', rules = 'FILE', from_spheres = 'FILE.csv'.
[[cloud]]
preset = 'humilis'
seeds = '1-12'               # or [1, 5, 9]
name = 'humilis/{seed}.glb'
vertices = 8000

[[cloud]]
preset = 'hero'
lobe = 'fit'

# Sculpts: a path, a glob, or a list of them; ** matches any folders.
# [[cloud]]
# sculpt = ['sculpts/**/*.fbx', 'sculpts/*.obj']
# target_error = 0.5
# repair = 'orient,fill'
)toml";
}

}  // namespace cloudbake
