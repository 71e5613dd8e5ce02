#include "pipeline/sequence/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <regex>
#include <set>

#include "core/error.h"
#include "core/memory_budget.h"
#include "core/text/numbers.h"
#include "core/text/scan.h"
#include "io/file/find_files.h"
#include "io/sculpt/read_mesh.h"
#include "pipeline/asset/asset.h"
#include "pipeline/options/resolve.h"
#include "pipeline/sources/grown.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

bool canBeBaked(const fs::path& file) { return isVdbFile(file) || isSculptFile(file); }

// The last number in the stem of a name; nothing if there is none or it is too large.
std::optional<int64_t> numberIn(const fs::path& file) {
  const std::string stem = file.stem().string();
  const auto isDigit = [](char c) { return c >= '0' && c <= '9'; };
  const auto end = std::find_if(stem.rbegin(), stem.rend(), isDigit).base();
  auto begin = end;
  while (begin != stem.begin() && isDigit(*(begin - 1))) --begin;
  int64_t number = 0;
  const auto read = std::from_chars(&*begin, &*begin + (end - begin), number);
  if (begin == end || read.ec != std::errc() || number > (int64_t(1) << 52)) return std::nullopt;
  return number;
}

// A name with "####" or "%04d" as a regular expression; nothing if it has neither.
std::optional<std::regex> numberedName(const std::string& name) {
  std::string expression;
  bool has_number = false;
  for (size_t i = 0; i < name.size(); ++i) {
    size_t digits = 0, end = i;
    if (name[i] == '#') {
      while (end < name.size() && name[end] == '#') ++end, ++digits;
    } else if (name[i] == '%') {
      const size_t d = name.find_first_not_of("0123456789", i + 1);
      if (d != name.npos && name[d] == 'd') {
        std::from_chars(name.data() + i + 1, name.data() + d, digits);
        digits = std::max<size_t>(1, digits), end = d + 1;
      }
    }
    if (end > i) {
      expression += fmt::format("[0-9]{{{},}}", std::min<size_t>(digits, 20));
      has_number = true;
      i = end - 1;
    } else {
      if (std::string_view("\\^$.|?*+()[]{}").find(name[i]) != std::string_view::npos) expression += '\\';
      expression += name[i];
    }
  }
  if (!has_number) return std::nullopt;
  return std::regex(expression);
}

std::vector<fs::path> filesIn(const fs::path& folder, const std::function<bool(const fs::path&)>& isWanted) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (isWanted(entry->path())) files.push_back(entry->path());
  if (error) throw IoError(folder.string(), error.message() + "; check the path and its permissions");
  return files;
}

std::vector<fs::path> filesOfInput(const fs::path& input) {
  if (fs::is_directory(input)) {
    std::map<std::string, fs::path> kinds;
    std::vector<fs::path> files = filesIn(input, [&](const fs::path& file) {
      const bool is_wanted = canBeBaked(file) && !file.filename().string().starts_with('.');
      if (is_wanted) kinds.emplace(lowerCase(file.extension().string()), file);
      return is_wanted;
    });
    if (kinds.size() > 1)
      throw InputError(input.string(), fmt::format("has frames of several kinds ({}, {}): name those of one, such as '{}'",
                                                   kinds.begin()->second.filename().string(), kinds.rbegin()->second.filename().string(),
                                                   (input / ("*" + kinds.begin()->first)).string()));
    return files;
  }
  const fs::path folder = input.has_parent_path() ? input.parent_path() : fs::path(".");
  const auto numbered = numberedName(input.filename().string());
  if (!numbered) {
    std::set<fs::path> searched;
    return filesMatching(input, searched);
  }
  std::vector<fs::path> files =
      filesIn(folder, [&](const fs::path& file) { return std::regex_match(file.filename().string(), *numbered); });
  if (!input.has_parent_path())
    for (fs::path& file : files) file = file.filename();
  return files;
}

// b, c and d are variables of every recipe.
bool isVariable(const std::string& name, const GrownSource& source) {
  if (!source.recipe) return false;
  const auto& declared = source.recipe->grammar.variables;
  return name == "b" || name == "c" || name == "d" ||
         std::any_of(declared.begin(), declared.end(), [&](const auto& variable) { return variable.first == name; });
}

// Reads a frame. Errors of its file name the frame, which may be a moment of that file.
template <class Read>
Cloud namingFrame(const FrameInput& frame, const Read& read) {
  const std::string file = frame.file.string();
  try {
    return read();
  } catch (const MemoryError& error) {
    if (error.file != file) throw;
    throw MemoryError(frame.name, error.message);
  } catch (const InputError& error) {
    if (error.file != file) throw;
    throw InputError(frame.name, error.line, error.column, error.message);
  }
}

}  // namespace

std::vector<FrameInput> frameFiles(const fs::path& input) {
  const std::vector<fs::path> files = filesOfInput(input);
  if (files.size() < 2)
    throw InputError(
        input.string(),
        fmt::format("{} found, and a sequence has at least two: give a folder, a pattern in quotes such as 'smoke.####.vdb', or one glTF, "
                    "GLB or FBX with an animation",
                    files.empty() ? "no frame was" : "only one frame was"));
  std::vector<std::pair<int64_t, fs::path>> numbered;
  for (const fs::path& file : files) {
    const auto number = numberIn(file);
    if (!number)
      throw InputError(file.string(),
                       "has no number in its name, so that its place among the frames is not known: rename it, or name the others by a "
                       "pattern such as 'smoke.####.vdb'");
    numbered.emplace_back(*number, file);
  }
  std::sort(numbered.begin(), numbered.end());
  std::vector<FrameInput> frames;
  for (size_t i = 0; i < numbered.size(); ++i) {
    const auto& [number, file] = numbered[i];
    if (i > 0 && number == numbered[i - 1].first)
      throw InputError(file.string(),
                       fmt::format("has the same number as {}: name the frames of one sequence by a pattern such as 'smoke.####.vdb'",
                                   numbered[i - 1].second.filename().string()));
    if (!canBeBaked(file)) throw InputError(file.string(), "is neither a volume (VDB) nor a sculpt that can be baked");
    frames.push_back({double(number - numbered.front().first), file.string(), file});
  }
  return frames;
}

bool mayBeAnimated(const fs::path& input) {
  const std::string extension = lowerCase(input.extension().string());
  std::error_code error;
  return (extension == ".gltf" || extension == ".glb" || extension == ".fbx") && fs::is_regular_file(input, error);
}

AnimationFrames animationFrames(const Settings& settings) {
  constexpr double kMostFrames = 10000;
  const fs::path& file = settings.source.input;
  ReadSettings first = settings.source.read;
  first.moment = {settings.sequence.animation, 0};
  Warnings again;  // come again with the frames
  const auto read = [&] { return readMesh(file, first, again).animation_seconds; };
  const double seconds = namingFile(file.string(), [&] { return inStage("reading this sculpt", "use one with fewer vertices", read); });
  AnimationFrames animation{{}, settings.sequence.frames_per_second.value_or(kFramesPerSecond)};
  const double count = settings.sequence.frames ? *settings.sequence.frames : std::round(seconds * animation.frames_per_second) + 1;
  if (count < 2 || count > kMostFrames)
    throw UsageError(
        fmt::format("{}: at {:g} frames per second, its animation of {:.4g} seconds makes {:.0f}, and a sequence has 2 to {:.0f}: give "
                    "another --fps, or --frame-count",
                    file.string(), animation.frames_per_second, seconds, count, kMostFrames));
  if (settings.sequence.frames && !settings.sequence.frames_per_second) animation.frames_per_second = (count - 1) / seconds;
  for (int i = 0; i < int(count); ++i) {
    const double at = settings.sequence.frames ? seconds * i / (count - 1) : i / animation.frames_per_second;
    animation.frames.push_back(
        {double(i), fmt::format("{}, frame {}", file.string(), i), file, {}, AnimationMoment{settings.sequence.animation, at}});
  }
  return animation;
}

double periodOf(const std::vector<FrameInput>& frames, const SequenceSettings& settings) {
  const double last = frames.back().frame;
  return settings.loops ? last - std::min(double(settings.fade), last / 2) : last;
}

std::vector<Given> withRecipe(const GrownSource& source, std::span<const Given> line) {
  std::vector<Given> given = source.given;
  for (const Given& one : source.of_sequence)
    if (!(one.option->bits & kRepeats) || !isGiven(line, one.option->name)) given.push_back(one);
  given.insert(given.end(), line.begin(), line.end());
  return given;
}

std::vector<FrameInput> grownFrames(const SequenceSettings& settings, const GrownSource& source) {
  if (settings.varied.empty())
    throw UsageError(
        "this cloud does not change: give --vary OPTION=A:B, such as size=0.5:1, or take sprouting, fairweather or stormtower");
  const int steps = settings.frames.value_or(kGrownFrames) - 1, fade = settings.loops ? std::min(settings.fade, steps / 2) : 0;
  std::vector<FrameInput> frames;
  for (int i = 0; i <= steps; ++i) {
    FrameInput frame{double(i), fmt::format("{}, frame {}", source.file, i), {}, {}};
    for (const auto& [name, from, to] : settings.varied) {
      const double value = from + (to - from) * i / (steps - fade);
      const Option* option = findOption(name, kGrow);
      if (!option && isVariable(name, source)) {
        frame.varied.push_back({findOption("variable", kGrow), name + "=" + shortestText(value), "", 0, 0});
        continue;
      }
      if (!option || option->bits & kOfRun)
        throw UsageError(
            fmt::format("--vary: grow has no option '{}', and {} has no variable of this name: "
                        "`cloudbake grow --help-all` lists the options",
                        name, source.file));
      const bool is_whole = option->value.form.kind == ValueForm::kWhole;
      frame.varied.push_back({option, is_whole ? fmt::format("{:.0f}", value) : shortestText(float(value)), "", 0, 0});
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

std::vector<FrameInput> madeFrames(Settings& settings, const std::optional<GrownSource>& source) {
  if (source) return grownFrames(settings.sequence, *source);
  AnimationFrames animation = animationFrames(settings);
  settings.sequence.frames_per_second = animation.frames_per_second;
  return std::move(animation.frames);
}

FrameCloud readFrame(const FrameInput& frame, const Settings& settings, std::span<const Given> given, BakeReport& report) {
  Stopwatch watch;
  if (frame.file.empty()) {
    GrownSource source = readGrownSource(settings.source);
    std::vector<Given> all(given.begin(), given.end());
    all.insert(all.end(), frame.varied.begin(), frame.varied.end());
    Settings own = resolve(settings.source, all);
    own.mesh.vertices.reset();
    return {growCloud(std::move(source), own, std::nullopt, report, watch), own.field};
  }
  Settings own = settings;
  own.source.input = frame.file;
  own.source.read.moment = frame.moment;
  own.mesh.vertices.reset();
  return {namingFrame(frame, [&] { return readCloud(own, report, watch); }), own.field};
}

}  // namespace cloudbake
