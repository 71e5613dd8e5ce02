// Options as JSON, for pages, Python, Blender and the editors of manifests and recipes.
#pragma once

#include "core/text/json.h"
#include "pipeline/options/options.h"

namespace cloudbake {

/// A row of the table: name, label, unit, fallback, help, group, common (of the command), choices; and of its ValueForm kind ("text",
/// "flag", "choice", "whole" or "number"), low and high if there are limits, words, percent (whether a number may be followed by %) and
/// shape.
Json optionJson(const Option& option, Command command);

/// The rows of Blender's panel, with their names in Python, and the names of the options that it refuses.
Json blenderOptions();

/// JSON schemas (draft 2020-12) of a manifest and of a recipe. The limits of numbers in quotes are left to the
/// reader, which also takes names with - for _.
Json manifestSchema();
Json recipeSchema();

}  // namespace cloudbake
