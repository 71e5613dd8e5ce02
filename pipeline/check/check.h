// Checks whether a baked asset is right, and still intact after other programs.
#pragma once

#include <functional>
#include <string>

#include "pipeline/check/report.h"
#include "pipeline/options/settings.h"

namespace cloudbake {

/// Examines settings.source.input, measures a sample of its vertices against exact chords (or against settings.judge.against, the asset
/// before another program), and names the likely cause of what is wrong. `on_stage` is called
/// with the name of every stage when it ends. Throws InputError if the file is not a baked asset.
CheckReport checkAsset(const Settings& settings, const std::function<void(const std::string& stage)>& on_stage = {});

}  // namespace cloudbake
