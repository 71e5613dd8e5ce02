#include "io/sculpt/referenced_files.h"

#include <algorithm>
#include <array>
#include <set>

#include "core/error.h"
#include "core/text/scan.h"
#include "io/file/neighbour.h"
#include "io/gltf/gltf.h"
#include "io/sculpt/read_mesh.h"
#include "io/sculpt/read_mtl.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> namedByObj(const fs::path& sculpt, std::string_view bytes, bool allow_outside) {
  std::vector<fs::path> named = libraryPaths(sculpt, bytes, allow_outside);
  for (size_t i = 0, libraries = named.size(); i < libraries; ++i) try {
      for (const std::string& texture : texturesOfLibrary(readNeighbour(sculpt, named[i], allow_outside)))
        named.push_back(neighbourNamed(sculpt, texture, allow_outside, named[i]));
    } catch (const Error&) {  // the reader will report it
    }
  return named;
}

// Formats that assimp reads name their textures somewhere in the file, with a length before or a quote or tag around. So every run of
// printable characters that ends like an image is tried, and what lies beside the sculpt counts as named.
std::vector<fs::path> namedAnywhere(const fs::path& sculpt, std::string_view bytes, bool allow_outside) {
  constexpr std::array<std::string_view, 3> kEnds{".png", ".jpg", ".jpeg"};
  const auto is_of_name = [](char c) { return c >= ' ' && c != '"' && c != '<' && c != '>' && c != '|' && c != 127; };
  std::vector<fs::path> named;
  const std::string lower = lowerCase(bytes);
  for (size_t dot = lower.find('.'); dot != lower.npos; dot = lower.find('.', dot + 1))
    for (const std::string_view end : kEnds) {
      if (lower.compare(dot, end.size(), end) != 0) continue;
      size_t begin = dot;
      while (begin > 0 && dot - begin < 1024 && is_of_name(lower[begin - 1])) --begin;
      const fs::path path = neighbourNamed(sculpt, std::string(bytes.substr(begin, dot + end.size() - begin)), allow_outside);
      std::error_code error;
      if (fs::exists(path, error) && std::find(named.begin(), named.end(), path) == named.end()) named.push_back(path);
    }
  return named;
}

}  // namespace

bool canReferToFiles(const fs::path& file) {
  const std::string extension = lowerCase(file.extension().string());
  return isSculptFile(file) && extension != ".stl" && extension != ".off" && extension != ".ply";
}

std::vector<fs::path> referencedFiles(const fs::path& sculpt, std::string_view bytes, bool allow_outside) {
  const std::string extension = lowerCase(sculpt.extension().string());
  std::vector<fs::path> named;
  if (extension == ".gltf" || extension == ".glb")
    named = filesNamedByGltf(sculpt, bytes);
  else if (extension == ".obj")
    named = namedByObj(sculpt, bytes, allow_outside);
  else if (canReferToFiles(sculpt))
    named = namedAnywhere(sculpt, bytes, allow_outside);
  std::erase_if(named, [&](const fs::path& path) { return refusalOfNeighbour(sculpt, path, allow_outside).has_value(); });
  return named;
}

}  // namespace cloudbake
