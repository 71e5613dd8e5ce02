// cloudbake view --serve, cloudbake view --watch FILE: the page of view on this machine, and a new bake whenever a file is saved.
#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "app/tell.h"
#include "app/view.h"
#include "core/memory_budget.h"
#include "core/text/markup.h"
#include "io/file/file_watch.h"
#include "io/file/write_file.h"
#include "io/http/page_server.h"
#include "io/sculpt/referenced_files.h"
#include "pipeline/page/live_page.h"
#include "pipeline/sources/folder_files.h"

namespace cloudbake {

namespace {

constexpr std::chrono::milliseconds kWatchInterval{25}, kForLong = std::chrono::hours(1);

// A file with those that it refers to, as far as it can be read.
std::vector<std::filesystem::path> withReferencedFiles(const std::filesystem::path& file, const ReadSettings& settings) {
  std::vector<std::filesystem::path> files{file};
  try {
    if (!canReferToFiles(file)) return files;
    for (const std::filesystem::path& other : referencedFiles(file, readFileBytes(file), settings)) files.push_back(other);
  } catch (const std::exception&) {  // the bake will report it
  }
  return files;
}

// The files of the inputs, of which some are folders, with those that they refer to.
std::vector<std::filesystem::path> filesOfInputs(std::span<const std::filesystem::path> inputs, const ReadSettings& settings) {
  std::vector<std::filesystem::path> all;
  const auto add = [&](const std::filesystem::path& file) {
    for (const std::filesystem::path& one : withReferencedFiles(file, settings)) all.push_back(one);
  };
  for (const std::filesystem::path& input : inputs) try {
      if (!std::filesystem::is_directory(input)) {
        add(input);
        continue;
      }
      const FolderFiles found = filesToShow(input);
      for (const std::filesystem::path& file : found.files) add(file);
      all.insert(all.end(), found.folders.begin(), found.folders.end());  // each changes when a file comes or goes
    } catch (const std::exception&) {                                     // the folder has gone, or has nothing to show
      all.push_back(input);
    }
  return all;
}

// Reads or bakes the assets, prints a line about it, and shows them.
void showScenes(const CommandLine& line, const Settings& settings, PageServer& server) {
  BakeReport report;
  report.command = "view";
  report.output = server.address();
  Stopwatch watch;
  const std::vector<LiveScene> scenes = readLiveScenes(line, report).scenes;
  enforceStrict(settings.run.strict, report);
  watch.lap(report.seconds, "read");
  server.show(livePage(scenes, PageKind::kServed), livePageData(scenes));
  RunSettings run = settings.run;
  run.quiet = true;  // warnings, and the file of --json
  tellReport(run, report);
}

// The same again. An error goes to the page and to stderr, and the page that is there stays.
void showScenesAgain(const CommandLine& line, const Settings& settings, PageServer& server) {
  std::string failure;
  try {
    inStage("this bake", "use fewer --voxels, or a smaller input", [&] { showScenes(line, settings, server); });
    return;
  } catch (const std::exception& error) {
    failure = error.what();
  }
  say(stderr, "cloudbake: " + failure + "\n");
  server.fail(Json(onOneLine(failure)).dump());
}

void sayAddress(const PageServer& server) {
  say(stdout, server.address() + "\n");
  if (std::fflush(stdout) != 0) throw IoError("standard output", "cannot be written: it is closed, or the disk is full");
}

}  // namespace

ExitCode serveView(const CommandLine& line, const Settings& settings) {
  const std::unique_ptr<PageServer> server = openPageServer(settings.serve.port.value_or(kServePort));  // before a bake that may take long
  std::optional<FileWatch> watch;  // what changes during the first bake is baked again
  if (settings.serve.watch) watch.emplace([&] { return withReferencedFiles(line.input, settings.source.read); });
  if (std::any_of(line.inputs.begin(), line.inputs.end(), [](const auto& input) { return std::filesystem::is_directory(input); }))
    watch.emplace([&] { return filesOfInputs(line.inputs, settings.source.read); });
  showScenes(line, settings, *server);
  if (!settings.run.quiet) sayAddress(*server);
  for (;;) {
    std::this_thread::sleep_for(watch ? kWatchInterval : kForLong);
    if (watch && watch->changed()) showScenesAgain(line, settings, *server);
  }
}

}  // namespace cloudbake
