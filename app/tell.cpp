#include "app/tell.h"

#include <nlohmann/json.hpp>

#include "core/text/json.h"
#include "core/text/markup.h"
#include "io/file/write_file.h"

namespace cloudbake {

namespace {

void printReport(const RunSettings& settings, const BakeReport& report) {
  say(stderr, warningLines(report));
  if (!settings.quiet) say(stdout, findingLines(report) + reportText(report));
}

}  // namespace

void say(std::FILE* stream, std::string_view lines) { std::fputs(onOwnLines(lines).c_str(), stream); }

void tellReport(const RunSettings& settings, const BakeReport& report) {
  if (settings.json) writeFileAtomically(*settings.json, reportJson(report));
  printReport(settings, report);
}

void tellReport(const RunSettings& settings, const BakeReport& report, const Json& more, const std::string& text) {
  if (settings.json) {
    Json json = parseJson(reportJson(report)).value();
    json.update(more);
    writeFileAtomically(*settings.json, reportJsonText(std::move(json)));
  }
  printReport(settings, report);
  if (!settings.quiet) say(stdout, text);
}

}  // namespace cloudbake
