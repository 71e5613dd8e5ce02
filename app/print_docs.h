// The man page, the shells' completions and a list of keys, made from the tables of commands and options, so that they are always up to
// date.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "app/commands.h"

namespace cloudbake {

/// `what`: man (troff, for groff's man macros), bash, zsh or fish (completion scripts), or scene-keys (a line for each key of a scene file,
/// for docs/previewer.md). Throws UsageError for anything else.
std::string docsText(std::string_view what, std::span<const CommandSpec> commands);

}  // namespace cloudbake
