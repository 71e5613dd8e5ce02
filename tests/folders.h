// Where tests read and write. These paths stand in one object file. So all others are the same bytes in every checkout, and ccache shares
// them.
#pragma once

#include <filesystem>

std::filesystem::path sourceFolder();  ///< the checkout
std::filesystem::path glbFolder();     ///< what gltf_validator reads
std::filesystem::path batchFolder();   ///< what batch_files reads

/// Whether tests run at their full size, as `scripts/test --all` asks. Otherwise they run at the least size that shows what they test.
bool runsWhole();
