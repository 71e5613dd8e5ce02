// The fuzz targets of the readers: what the drivers (reader_driver.cpp, reader_libfuzzer.cpp) call.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cloudbake {

/// Damages bytes a little.
using Damage = std::function<std::string(std::string)>;

struct ReaderTarget {
  std::string_view name;
  /// Reads any bytes; false for an InputError, whose text goes to `message`. Other exceptions pass. Aborts with a message where what was
  /// read breaks a promise of the reader's header.
  bool (*run)(const std::string& bytes, std::string& message);
  /// Small sound files in every syntax.
  std::vector<std::string> (*seeds)();
  /// Pieces of the syntax to damage with.
  std::vector<std::string> tokens;
  /// Damage that leaves a container whole; nothing: `damage` on all bytes. `draw` is random.
  std::string (*mutate)(std::string bytes, uint64_t draw, const Damage& damage) = nullptr;
  double cost = 1;  ///< how many times the work of reading an input may take
};

/// Aborts with a message if a promise is broken.
void requirePromise(bool holds, const char* what);

// Targets that use a baked asset as a whole (asset_fuzz.cpp).
bool runCheckTarget(const std::string& bytes, std::string& message);
bool runPreviewTarget(const std::string& bytes, std::string& message);
bool runViewTarget(const std::string& bytes, std::string& message);

/// obj, mtl, stl, off, ply, fbx, 3mf, spheres_ply, spheres_csv, gltf, check, preview, view, vdb, lattice, scene, toml, manifest,
/// batch_report.
std::span<const ReaderTarget> readerTargets();
/// The one of that name, or nothing.
const ReaderTarget* findReaderTarget(std::string_view name);

// Seeds, per format (reader_seeds.cpp).
std::vector<std::string> objSeeds();
std::vector<std::string> mtlSeeds();
std::vector<std::string> stlSeeds();
std::vector<std::string> offSeeds();
std::vector<std::string> plySeeds();
std::vector<std::string> fbxSeeds();
std::vector<std::string> printedSeeds();
std::vector<std::string> spherePlySeeds();
std::vector<std::string> sphereCsvSeeds();
std::vector<std::string> gltfSeeds();
std::vector<std::string> assetSeeds();
std::vector<std::string> vdbSeeds();
std::vector<std::string> latticeSeeds();
std::vector<std::string> sceneSeeds();
std::vector<std::string> tomlSeeds();
std::vector<std::string> manifestSeeds();
std::vector<std::string> batchReportSeeds();

}  // namespace cloudbake
