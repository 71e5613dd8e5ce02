// The man page, the shells' completions, the reference of scene files, and schemas, made from the tables of commands, options and keys, so
// that they are always up to date.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "app/commands.h"

namespace cloudbake {

inline constexpr const char* kDocs = "man, bash, zsh, fish, scene-keys, manifest-schema, recipe-schema, blender-options";

/// `what`: man (troff, for groff's man macros), bash, zsh or fish (completion scripts), scene-keys (docs/scene_reference.md),
/// manifest-schema or recipe-schema (JSON schemas, for editors), or blender-options (blender/cloudbake_addon/options.json). Throws
/// UsageError for anything else.
std::string docsText(std::string_view what, std::span<const CommandSpec> commands);

}  // namespace cloudbake
