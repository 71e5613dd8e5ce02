// A copy of the program that makes single assets for a batch of the program for Node.
#pragma once

#include <span>

#include "pipeline/options/options.h"
#include "pipeline/options/settings.h"

namespace cloudbake {

/// Makes the assets that the copy which started this one asks for, until that ends it.
[[noreturn]] void helpBatch(const Settings& settings, std::span<const Given> given);

}  // namespace cloudbake
