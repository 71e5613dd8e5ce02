#include "io/sculpt/referenced_files.h"

#include <algorithm>
#include <array>
#include <set>

#include "core/error.h"
#include "core/text/scan.h"
#include "io/file/neighbour.h"
#include "io/gltf/named_files.h"
#include "io/sculpt/read_mesh.h"
#include "io/sculpt/read_mtl.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> namedByObj(const fs::path& sculpt, std::string_view bytes, const ReadSettings& settings) {
  std::vector<fs::path> named = libraryPaths(sculpt, bytes, settings.allow_outside);
  for (size_t i = 0, libraries = named.size(); i < libraries; ++i) try {
      for (const std::string& texture : texturesOfLibrary(readNeighbour(sculpt, named[i], settings)))
        named.push_back(neighbourNamed(sculpt, texture, settings.allow_outside, named[i]));
    } catch (const Error&) {  // the reader will report it
    }
  return named;
}

// A text of XML, in which a few characters are written as names.
std::string withoutEntities(std::string_view xml) {
  std::string text(xml);
  for (const auto& [entity, character] : {std::pair{"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&apos;", "'"}, {"&amp;", "&"}})
    for (size_t at = 0; (at = text.find(entity, at)) != text.npos; ++at) text.replace(at, std::string_view(entity).size(), character);
  return text;
}

// Formats that assimp reads name their textures somewhere in the file, with a length before, a quote or tag around, or after a word. So
// every run of printable characters that ends like an image is tried, from each word on, as it is and as a URI in XML, and what lies beside
// the sculpt counts as named.
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
      const std::string_view run = bytes.substr(begin, dot + end.size() - begin);
      for (size_t word = 0; word != run.npos; word = run.find_first_not_of(' ', run.find(' ', word))) {
        const std::string_view written = run.substr(word);
        for (const std::string& name : {std::string(written), percentDecoded(withoutEntities(written))}) {
          const fs::path path = neighbourNamed(sculpt, name, allow_outside);
          std::error_code error;
          if (fs::exists(path, error) && std::find(named.begin(), named.end(), path) == named.end()) named.push_back(path);
        }
      }
    }
  return named;
}

}  // namespace

bool canReferToFiles(const fs::path& file) {
  const std::string extension = lowerCase(file.extension().string());
  constexpr std::array<std::string_view, 6> kAlone{".stl", ".off", ".vdb", ".csv", ".txt", ".toml"};
  return !extension.empty() && std::find(kAlone.begin(), kAlone.end(), extension) == kAlone.end();
}

std::vector<fs::path> referencedFiles(const fs::path& sculpt, std::string_view bytes, const ReadSettings& settings) {
  const std::string extension = lowerCase(sculpt.extension().string());
  std::vector<fs::path> named;
  if (extension == ".gltf" || extension == ".glb")
    named = filesNamedByGltf(sculpt, bytes);
  else if (extension == ".obj")
    named = namedByObj(sculpt, bytes, settings);
  else if (canReferToFiles(sculpt))
    named = namedAnywhere(sculpt, extension == ".ply" ? bytes.substr(0, bytes.find("end_header")) : bytes, settings.allow_outside);
  std::erase_if(named, [&](const fs::path& path) { return refusalOfNeighbour(sculpt, path, settings.allow_outside).has_value(); });
  return named;
}

}  // namespace cloudbake
