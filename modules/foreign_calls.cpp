#include "modules/foreign.h"
#include "modules/open_module.h"

namespace cloudbake {

Sculpt readWithAssimp(const std::filesystem::path& file, const std::string& bytes, const std::string& extension,
                      const ReadSettings& settings, Warnings& warnings) {
  static const ForeignModule& module = openModule<ForeignModule>("libcloudbake_foreign.so");
  return module.readWithAssimp(file, bytes, extension, settings, warnings);
}

}  // namespace cloudbake
