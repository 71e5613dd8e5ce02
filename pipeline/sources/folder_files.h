// The files of a folder that a command takes: what is read from it, and lines about what no reader takes.
#pragma once

#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace cloudbake {

/// A line per kind of file that nothing reads: "12 .ztl files are left out (first: a/b.ztl): a ZBrush project is not supported; export …".
/// Hidden files, materials, textures, buffers, thumbnails, documents and settings are no sculpts and get no line.
std::vector<std::string> linesAboutUnread(std::span<const std::filesystem::path> files);

/// The files of a folder, and of those below it, that `preview` and `view` show.
struct FolderFiles {
  std::vector<std::filesystem::path> files;  ///< baked assets, sculpts, volumes and recipes, sorted by their bytes
  std::vector<std::string> unread;           ///< linesAboutUnread
  std::set<std::filesystem::path> folders;   ///< that were searched
  std::filesystem::path folder;
  std::string nameOf(const std::filesystem::path& file) const;  ///< relative to the folder, with '/'
};

/// Lists a folder. Levels of detail are left out beside the asset that they belong to. Throws IoError for a folder that cannot be read, and
/// InputError if it has nothing to show.
FolderFiles filesToShow(const std::filesystem::path& folder);

}  // namespace cloudbake
