#include "io/sculpt/referenced_files.h"

#include "core/text/scan.h"
#include "io/gltf/gltf.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// mtllib NAME, to the end of the line.
std::vector<fs::path> namedByObj(const fs::path& sculpt, std::string_view bytes) {
  constexpr std::string_view kKeyword = "mtllib ";
  std::vector<fs::path> named;
  for (size_t at = bytes.find(kKeyword); at != bytes.npos; at = bytes.find(kKeyword, at + 1)) {
    if (at > 0 && bytes[at - 1] != '\n' && bytes[at - 1] != '\r') continue;
    std::string_view name = bytes.substr(at + kKeyword.size());
    name = name.substr(0, name.find_first_of("\r\n"));
    if (!name.empty()) named.push_back(sculpt.parent_path() / name);
  }
  return named;
}

}  // namespace

std::vector<fs::path> referencedFiles(const fs::path& sculpt, std::string_view bytes) {
  const std::string extension = lowerCase(sculpt.extension().string());
  if (extension == ".gltf" || extension == ".glb") return filesNamedByGltf(sculpt, bytes);
  if (extension == ".obj") return namedByObj(sculpt, bytes);
  return {};
}

}  // namespace cloudbake
