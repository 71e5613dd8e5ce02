// Converts the options that were given to the settings of a run.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/options/options.h"
#include "pipeline/options/scene_needs.h"

namespace cloudbake {

/// The settings of these options. Later options override earlier ones: a recipe's come first, then a manifest's, then the command line's.
/// `source` says what the cloud is made from. `scene` sets the target error and the fit's sun if no option does. Throws if a value is out
/// of range, if an option does not apply to the kind of source, or if options exclude each other: UsageError for an option of the command
/// line, InputError with file, line and column for an option of a file.
Settings resolve(const SourceSettings& source, std::span<const Given> given, const std::optional<SceneNeeds>& scene = std::nullopt);

/// Options of a command by name and value, as a program or a page gives them (pipeline/library/cloudbake.h). Throws UsageError for one that
/// the command has not, and for files, which are for the command line.
std::vector<Given> givenBy(std::span<const std::pair<std::string, std::string>> options, Command command);

/// A sculpt or a volume, by its name, with the memory limit of this machine.
SourceSettings sourceOfFile(const std::filesystem::path& file);

/// The picture settings of a scene file, overridden by these options. Throws as resolve does.
PictureSettings resolvePicture(const PictureSettings& base, std::span<const Given> given);

/// The kind of source that a path or a name stands for: a preset, a recipe (.toml), a VDB, else a sculpt.
SourceKind sourceKindOf(const std::filesystem::path& input);

/// "a grown cloud", "a file of spheres", "a sculpt", "a VDB".
const char* kindText(SourceKind kind);

}  // namespace cloudbake
