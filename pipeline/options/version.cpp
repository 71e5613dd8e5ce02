// CMakeLists.txt passes the versions that it found, so that no heavy header has to be included for them.
#include "pipeline/options/version.h"

#ifndef __EMSCRIPTEN__
#include <tbb/version.h>
#endif

#include "io/file/own_library.h"
#include "io/file/process.h"
#include "io/file/write_file.h"

namespace cloudbake {

namespace {

struct Library {
  const char* name;
  std::string built_with;
  std::string runs_with;  // empty: the same, because it is compiled in, loaded later or does not report its version
};

}  // namespace

std::string versionText() {
  const Library libraries[] = {
      {"OpenVDB", CLOUDBAKE_OPENVDB_VERSION, ""},
#ifndef __EMSCRIPTEN__
      {"oneTBB", TBB_VERSION_STRING, TBB_runtime_version()},
#endif
#ifndef CLOUDBAKE_PORTABLE
      {"Embree", CLOUDBAKE_EMBREE_VERSION, ""},
#endif
      {"assimp", CLOUDBAKE_ASSIMP_VERSION, ""},
      {"Draco", CLOUDBAKE_DRACO_VERSION, ""},
#ifdef CLOUDBAKE_CGAL
      {"CGAL", CLOUDBAKE_CGAL_VERSION " (this binary is under GPL-3)", ""},
#endif
      {"meshoptimizer", CLOUDBAKE_MESHOPTIMIZER_VERSION, ""},
      {"tinyobjloader", CLOUDBAKE_TINYOBJLOADER_VERSION, ""},
      {"Highway", CLOUDBAKE_HWY_VERSION, ""},
      {"nlohmann_json", CLOUDBAKE_NLOHMANN_JSON_VERSION, ""},
      {"toml++", CLOUDBAKE_TOMLPLUSPLUS_VERSION, ""},
      {"{fmt}", CLOUDBAKE_FMT_VERSION, ""},
      {"CLI11", CLOUDBAKE_CLI11_VERSION, ""},
#ifndef __EMSCRIPTEN__
      {"cpp-httplib", CLOUDBAKE_HTTPLIB_VERSION, ""},
#endif
      {"xxHash", CLOUDBAKE_XXHASH_VERSION, ""},
  };
  std::string text = "cloudbake " CLOUDBAKE_VERSION;
  for (const auto& [name, built_with, runs_with] : libraries) {
    text += std::string("\n") + name + " " + built_with;
    if (!runs_with.empty() && runs_with != built_with) text += ", runs with " + runs_with;
  }
#ifdef CLOUDBAKE_PORTABLE
  text += "\nrays by cloudbake's own tree";
#endif
#ifdef __EMSCRIPTEN__
  text += "\nin WebAssembly: one thread per asset, no view --serve and --watch";
#endif
#ifndef CLOUDBAKE_CGAL
  text += "\nwithout CGAL";
#endif
  return text;
}

std::vector<std::filesystem::path> bakeLibraries() {
  std::vector<std::filesystem::path> libraries;
#ifndef CLOUDBAKE_PORTABLE
  for (const char* name : {"libcloudbake_volumes.so", "libcloudbake_foreign.so"})
    if (const auto library = ownLibrary(name)) libraries.push_back(*library);
#endif
  return libraries;
}

const std::string& buildHash() {
  static const std::string hash = [] {
    std::string text = hashBytes(readFileBytes(thisProgram()));
    for (const std::filesystem::path& library : bakeLibraries()) text += hashBytes(readFileBytes(library));
    return hashBytes(text + versionText());
  }();
  return hash;
}

}  // namespace cloudbake
