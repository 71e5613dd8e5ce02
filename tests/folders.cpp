#include "tests/folders.h"

std::filesystem::path sourceFolder() { return CLOUDBAKE_SOURCE_DIR; }
std::filesystem::path glbFolder() { return CLOUDBAKE_GLB_FOLDER; }
std::filesystem::path batchFolder() { return CLOUDBAKE_BATCH_FOLDER; }
