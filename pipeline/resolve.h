// What was asked for → the settings of a run: the one place where options become settings.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pipeline/options.h"
#include "pipeline/scene_needs.h"

namespace cloudbake {

/// The settings that the options give, later ones over earlier ones: a recipe's first, then a manifest's, the command line's last.
/// `source` says what the cloud is made from. `scene`: what a camera needs; it sets the target error and the fit's sun where no option
/// does. Throws UsageError for options of the command line, InputError with file, line and column for those of a file: a value out of
/// range, an option that means nothing to the kind of source, options that do not go together.
Settings resolve(const SourceSettings& source, std::span<const Given> given, const std::optional<SceneNeeds>& scene = std::nullopt);

/// The picture that options give over one that a scene file gives. Throws as resolve.
PictureSettings resolvePicture(const PictureSettings& base, std::span<const Given> given);

/// The kind of source that a path or a name means: a preset, a recipe (.toml), a VDB, else a sculpt.
SourceKind sourceKindOf(const std::filesystem::path& input);

/// "a cloud that grows", "a file of spheres", "a sculpt", "a VDB".
const char* kindText(SourceKind kind);

}  // namespace cloudbake
