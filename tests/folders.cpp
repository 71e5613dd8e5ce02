#include "tests/folders.h"

#include <cstdlib>
#include <string_view>

std::filesystem::path sourceFolder() { return CLOUDBAKE_SOURCE_DIR; }
std::filesystem::path glbFolder() { return CLOUDBAKE_GLB_FOLDER; }
std::filesystem::path batchFolder() { return CLOUDBAKE_BATCH_FOLDER; }

bool runsWhole() {
  const char* asked = std::getenv("CLOUDBAKE_TESTS");
  return asked && std::string_view(asked) == "all";
}
