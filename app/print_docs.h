// The man page, the shells' completions, lists of keys and schemas, made from the tables of commands and options, so that they are always
// up to date.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "app/commands.h"

namespace cloudbake {

inline constexpr const char* kDocs = "man, bash, zsh, fish, scene-keys, manifest-schema, recipe-schema, blender-options";

/// `what`: man (troff, for groff's man macros), bash, zsh or fish (completion scripts), scene-keys (a line for each key of a scene file,
/// for docs/previewer.md), manifest-schema or recipe-schema (JSON schemas, for editors), or blender-options
/// (blender/cloudbake_addon/options.json). Throws UsageError for anything else.
std::string docsText(std::string_view what, std::span<const CommandSpec> commands);

}  // namespace cloudbake
