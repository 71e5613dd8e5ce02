#include "app/tell.h"

#include <fmt/format.h>

#include "io/file/write_file.h"

namespace cloudbake {

namespace {

void printReport(const RunSettings& settings, const BakeReport& report) {
  fmt::print(stderr, "{}", warningLines(report));
  if (!settings.quiet) fmt::print("{}{}", findingLines(report), reportText(report));
}

}  // namespace

void tellReport(const RunSettings& settings, const BakeReport& report) {
  if (settings.json) writeFileAtomically(*settings.json, reportJson(report));
  printReport(settings, report);
}

void tellReport(const RunSettings& settings, const BakeReport& report, const char* key, const Json& more, const std::string& text) {
  if (settings.json) {
    Json json = Json::parse(reportJson(report));
    json[key] = more;
    writeFileAtomically(*settings.json, json.dump(2) + "\n");
  }
  printReport(settings, report);
  if (!settings.quiet) fmt::print("{}", text);
}

}  // namespace cloudbake
