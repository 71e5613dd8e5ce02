// The commands: each takes its settings (input and output set) and runs to its exit code; errors are thrown.
#pragma once

#include <functional>

#include "app/options.h"
#include "core/error.h"

namespace cloudbake {

/// Sets on Settings what the command line gave: applied last, over a recipe's own [bake] table.
using ApplyCommandLine = std::function<void(Settings&)>;

ExitCode runGrow(Settings settings, const ApplyCommandLine& apply_command_line);
ExitCode runBake(Settings settings, const ApplyCommandLine& apply_command_line);
ExitCode runPreview(Settings settings, const ApplyCommandLine& apply_command_line);
ExitCode runMeasure(Settings settings, const ApplyCommandLine& apply_command_line);

struct AssetOption;
/// `given` are the options of assets on the command line.
ExitCode runBatch(Settings settings, const std::vector<AssetOption>& given);

}  // namespace cloudbake
