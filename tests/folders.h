#pragma once
#include <filesystem>

/** Where tests read and write. The paths stand in one object file, so that all others are the same bytes in every checkout, and ccache has them. */
std::filesystem::path sourceFolder();  // the checkout
std::filesystem::path glbFolder();     // what gltf_validator reads
std::filesystem::path batchFolder();   // what batch_files reads
