// What reads a baked asset as a whole: `check`, `preview` and `view`, on files that are damaged in their JSON, their accessors or their
// floats. Each ends with a result that makes sense, or with an InputError.
#include <cmath>
#include <fstream>

#include "core/error.h"
#include "io/report/report.h"
#include "pipeline/check/check.h"
#include "pipeline/library/cloudbake.h"
#include "pipeline/options/resolve.h"
#include "pipeline/page/live_page.h"
#include "pipeline/picture/picture.h"
#include "tests/fuzz/reader_fuzz.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMemory_bytes = 64 << 20;

// A folder in memory, with the asset as its only file.
fs::path assetFile(const std::string& bytes) {
  static const fs::path folder = [] {
    std::string name = "/dev/shm/cloudbake-fuzz-XXXXXX";
    requirePromise(::mkdtemp(name.data()) != nullptr, "there is no folder in memory");
    return fs::path(name);
  }();
  const fs::path file = folder / (bytes.starts_with("glTF") ? "a.glb" : "a.gltf");
  std::ofstream(file, std::ios::binary) << bytes;
  return file;
}

Settings settingsFor(const std::string& bytes, Command command, const std::vector<std::pair<std::string, std::string>>& options) {
  Settings settings = resolve(sourceOfFile(assetFile(bytes)), givenBy(options, command));
  settings.source.read.memory_limit = kMemory_bytes;
  return settings;
}

template <class Use>
bool usable(const Use& use, std::string& message) {
  try {
    use();
    return true;
  } catch (const Error& error) {
    if (error.code != ExitCode::kInput && error.code != ExitCode::kSystem) throw;  // a buffer beside the file is missing
    message = error.what();
    return false;
  }
}

}  // namespace

bool runCheckTarget(const std::string& bytes, std::string& message) {
  return usable(
      [&] {
        const CheckReport report = checkAsset(settingsFor(bytes, kCheck, {{"truth-vertices", "5"}}));
        requirePromise(!checkText(report).empty() && !checkJson(report).empty(), "a check says nothing");
        if (report.verdict) {
          requirePromise(!report.verdict->cause.empty() && !report.verdict->what.empty() && !report.verdict->cure.empty(),
                         "a verdict gives no reason");
          return;
        }
        requirePromise(report.figures.has_value(), "a sound asset was not measured");
        requirePromise(std::isfinite(report.figures->bake.transmittance.rms), "a sound asset has no error");
        requirePromise(report.figures->agreement.rms <= report.figures->agreement.most, "a sound asset differs from a new bake");
      },
      message);
}

bool runPreviewTarget(const std::string& bytes, std::string& message) {
  return usable(
      [&] {
        for (const char* look : {"painted", "plain"}) {
          BakeReport report;
          Stopwatch watch;
          const std::vector<std::pair<std::string, std::string>> options{{"look", look}, {"size", "24x16"}};
          const Settings settings = settingsFor(bytes, kPreview, options);
          std::string png;
          const PictureSink sink{[&](std::string_view bytes_of_picture) { png += bytes_of_picture; }};
          drawPictures(readScenery(settings, givenBy(options, kPreview), report), sink, report, watch);
          requirePromise(png.starts_with("\x89PNG"), "there is no picture");
        }
      },
      message);
}

bool runViewTarget(const std::string& bytes, std::string& message) {
  return usable(
      [&] {
        BakeReport report;
        const Settings settings = settingsFor(bytes, kView, {});
        const LiveScene scenes[] = {liveScene(readScenery(settings, {}, report), "a")};
        requirePromise(livePage(scenes).find("</html>") != std::string::npos, "there is no page");
      },
      message);
}

}  // namespace cloudbake
