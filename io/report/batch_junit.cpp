// JUnit XML in the form that Jenkins and GitLab read: github.com/testmoapp/junitxml; jenkinsci/xunit-plugin, junit-10.xsd.
#include "core/text/markup.h"
#include "io/report/batch_parts.h"

namespace cloudbake {

namespace {

std::string attribute(const char* name, std::string_view value) { return " " + std::string(name) + "=\"" + escapedMarkup(value) + "\""; }

std::string seconds(double value) { return numberText(value, std::chars_format::fixed, 3); }

std::string totals(const BatchReport& report) {
  return attribute("tests", std::to_string(report.assets.size())) +
         attribute("failures", std::to_string(assetsIn(report, AssetState::kFailed))) + attribute("errors", "0") +
         attribute("skipped", std::to_string(assetsIn(report, AssetState::kNotRun))) + attribute("time", seconds(report.seconds));
}

std::string outcome(const AssetRecord& asset) {
  if (asset.state == AssetState::kNotRun) return "      <skipped" + attribute("message", "the batch ended before its turn") + "/>\n";
  if (asset.state != AssetState::kFailed) return "";
  return "      <failure" + attribute("message", asset.error) + attribute("type", "exit " + std::to_string(asset.code)) + ">" +
         escapedMarkup(asset.error) + "</failure>\n";
}

std::string warnings(const AssetRecord& asset) {
  std::string lines;
  for (const CountedWarning& warning : warningsOf(asset))
    lines += escapedMarkup(onOneLine(warning.kind + " (" + std::to_string(warning.count) + "): " + warning.first)) + "\n";
  return lines.empty() ? "" : "      <system-out>" + lines + "</system-out>\n";
}

std::string testCase(const AssetRecord& asset) {
  const std::string content = outcome(asset) + warnings(asset);
  const std::string tag =
      "    <testcase" + attribute("classname", asset.source) + attribute("name", asset.name) + attribute("time", seconds(asset.seconds));
  return tag + (content.empty() ? "/>\n" : ">\n" + content + "    </testcase>\n");
}

}  // namespace

std::string batchJunit(const BatchReport& report) {
  std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites" + attribute("name", "cloudbake batch") + totals(report) +
                    ">\n  <testsuite" + attribute("name", report.source) + totals(report) + ">\n";
  for (const AssetRecord& asset : report.assets) xml += testCase(asset);
  return xml + "  </testsuite>\n</testsuites>\n";
}

}  // namespace cloudbake
