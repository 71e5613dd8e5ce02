// glibc keeps the folder of every library as it was when it loaded that (dlinfo(3), RTLD_DI_ORIGIN), an absolute path. The program has no
// name in its list of libraries; the kernel knows its path.
#include "io/file/own_library.h"

#include <dlfcn.h>
#include <link.h>

#include <array>
#include <climits>

#include "io/file/process.h"

namespace cloudbake {

namespace fs = std::filesystem;

std::optional<fs::path> ownLibrary(std::string_view name) {
  static const char here = 0;  // its address is in the program or the library that this code is linked into
  Dl_info info{};
  link_map* map = nullptr;
  std::array<char, PATH_MAX> origin{};
  std::error_code error;
  if (::dladdr1(&here, &info, reinterpret_cast<void**>(&map), RTLD_DL_LINKMAP) == 0 || !map) return std::nullopt;
  const bool is_program = *map->l_name == '\0';
  if (!is_program && ::dlinfo(map, RTLD_DI_ORIGIN, origin.data()) != 0) return std::nullopt;
  const fs::path folder = is_program ? fs::read_symlink(thisProgram(), error).parent_path() : fs::path(origin.data());
  // An installed program has its libraries in ../lib; a Python module has them above the folder of its package.
  for (const char* where : {"", is_program ? "../lib" : "../..", is_program ? "" : "../../.."}) {
    const fs::path library = (folder / where / name).lexically_normal();
    if (library.is_absolute() && fs::is_regular_file(library, error)) return library;
  }
  return std::nullopt;
}

}  // namespace cloudbake
