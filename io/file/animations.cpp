#include "io/file/animations.h"

#include "core/error.h"

namespace cloudbake {

namespace {

std::string listOf(std::span<const std::string> names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "'" : ", '") + name + "'";
  return list;
}

}  // namespace

size_t chosenAnimation(const std::filesystem::path& file, std::span<const std::string> names, const std::string& wanted) {
  if (names.empty())
    throw InputError(file.string(),
                     "it has no animation: export it with one, give a folder or a pattern of several files as frames, or bake it as one "
                     "cloud with `cloudbake bake`");
  if (wanted.empty()) return 0;
  for (size_t i = 0; i < names.size(); ++i)
    if (names[i] == wanted) return i;
  throw InputError(file.string(), "it has no animation '" + wanted + "': for --animation, give one of " + listOf(names));
}

void refuseStillAnimation(const std::filesystem::path& file, std::span<const std::string> names, size_t chosen) {
  throw InputError(file.string(), "its animation '" + names[chosen] + "' moves none of the meshes that are baked" +
                                      (names.size() > 1 ? ": for --animation, give one of " + listOf(names) + ", or"
                                                        : std::string(": export it with the animation of the mesh, or")) +
                                      " bake it as one cloud with `cloudbake bake`");
}

}  // namespace cloudbake
