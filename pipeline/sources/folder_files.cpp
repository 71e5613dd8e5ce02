#include "pipeline/sources/folder_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>

#include "core/error.h"
#include "core/text/scan.h"
#include "io/file/find_files.h"
#include "io/file/write_file.h"
#include "io/sculpt/read_mesh.h"
#include "pipeline/options/options.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// What lies beside sculpts and has a use, but is no shape.
constexpr std::string_view kBesideSculpts =
    " .mtl .mat .bin "
    " .png .apng .jpg .jpeg .tga .tif .tiff .exr .hdr .bmp .psd .gif .dds .ktx .ktx2 .basis .webp .tx .tex .svg .ico .clip .kra .xcf "
    " .txt .md .rst .pdf .doc .docx .rtf .html .htm .css .js .json .xml .csv .tsv .log .toml .yaml .yml .ini .cfg .db .lnk .url .py .mel "
    " .sh .bat .zip .7z .rar .gz .tar .mp4 .mov .avi .wav .mp3 .ogg .ttf .otf .meta .import .bak .tmp .blend1 .blend2 .d ";

std::string extensionOf(const fs::path& file) { return lowerCase(file.extension().string()); }

bool isBesideSculpts(const std::string& extension) {
  return extension.size() < 2 || kBesideSculpts.find(" " + extension + " ") != std::string_view::npos;
}

// Whether this is the text of a recipe, and not of a scene, a manifest or settings: its rules come before the first table.
bool isRecipe(const fs::path& file) {
  if (extensionOf(file) != ".toml") return false;
  std::string bytes;
  try {
    bytes = readFileBytes(file);
  } catch (const Error&) {  // its panel says why
    return true;
  }
  LineScanner lines{bytes};
  while (const auto line = lines.next()) {
    if (line->starts_with('[')) return false;
    if (line->starts_with("rules") || line->starts_with("premise")) return true;
  }
  return false;
}

// Whether a file is a level of detail of another one that is shown: "a_lod2.glb" beside "a.glb".
bool isLevelOfOther(const fs::path& file, const std::set<fs::path>& all) {
  const std::string stem = file.stem().string();
  const size_t at = stem.rfind("_lod");
  if (at == std::string::npos || at + 5 != stem.size() || stem.back() < '1' || stem.back() > '9') return false;
  return all.contains(file.parent_path() / (stem.substr(0, at) + file.extension().string()));
}

}  // namespace

std::string FolderFiles::nameOf(const fs::path& file) const { return file.lexically_relative(folder).generic_string(); }

FolderFiles filesToShow(const fs::path& folder) {
  FolderFiles found;
  found.folder = folder;
  std::vector<fs::path> unread;
  const std::vector<fs::path> all = filesBelow(folder, {}, found.folders);
  const std::set<fs::path> names(all.begin(), all.end());
  for (const fs::path& file : all) {
    if (isSculptFile(file) ? !isLevelOfOther(file, names) : isVdbFile(file) || isRecipe(file))
      found.files.push_back(file);
    else if (!isSculptFile(file))
      unread.push_back(file);
  }
  found.unread = linesAboutUnread(unread);
  if (found.files.empty())
    throw InputError(folder.string(), fmt::format("nothing to show in this folder: baked assets, sculpts ({}), volumes (.vdb) and recipes "
                                                  "(.toml) are shown{}{}",
                                                  sculptExtensions(), found.unread.empty() ? "" : "; ", fmt::join(found.unread, "; ")));
  return found;
}

std::vector<std::string> linesAboutUnread(std::span<const fs::path> files) {
  std::map<std::string, std::vector<fs::path>> kinds;
  for (const fs::path& file : files)
    if (const std::string extension = extensionOf(file); !file.filename().string().starts_with('.') && !isBesideSculpts(extension))
      kinds[extension].push_back(file);
  std::vector<std::string> lines;
  for (const auto& [extension, of_kind] : kinds) {
    const std::string which =
        of_kind.size() == 1 ? of_kind.front().string() + " is left out"
                            : fmt::format("{} {} files are left out (first: {})", of_kind.size(), extension, of_kind.front().string());
    const std::string_view format = formatWithoutReader(of_kind.front());
    lines.push_back(format.empty() ? which + ": no reader of sculpts has this ending; if it is a sculpt, export it as glTF, FBX or OBJ"
                                   : fmt::format("{}: {} cannot be read; {}", which, format, cureWithoutReader(of_kind.front())));
  }
  return lines;
}

}  // namespace cloudbake
