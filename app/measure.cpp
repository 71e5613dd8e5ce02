// cloudbake measure INPUT: measures the errors of docs/lobe_math.md against an independent truth for the given settings, and the seconds.
// With -o DIR it writes the speed–error curve of all methods.
#include "app/commands.h"
#include "app/progress.h"

#include <nlohmann/json.hpp>

#include "app/tell.h"
#include "io/file/write_file.h"
#include "pipeline/asset/asset.h"
#include "pipeline/measure/curve.h"
#include "pipeline/measure/figures.h"

namespace cloudbake {

namespace {

ExitCode writeCurve(const Cloud& cloud, const Settings& settings, const BakeParameters& parameters, BakeReport& report, Stopwatch& watch) {
  enforceStrict(settings.run.strict, report);
  const std::filesystem::path& folder = settings.output.file;
  createFolder(folder);  // a folder that cannot be made is an error before the minutes of measuring
  const std::vector<CurveRow> rows = measureCurve(cloud, settings, parameters);
  watch.lap(report.seconds, "curve");
  say(stderr, warningLines(report));
  if (!settings.run.quiet) say(stdout, curveMarkdown(rows));
  writeFileAtomically(folder / "curve.csv", curveCsv(rows));
  writeFileAtomically(folder / "curve.json", curveJson(rows));
  writeFileAtomically(folder / "curve.svg", curveSvg(rows, settings.source.input.filename().string()));
  report.output = folder.string();
  if (settings.run.json) writeFileAtomically(*settings.run.json, reportJson(report));
  return ExitCode::kDone;
}

// How exact a method is shows in mean lobes, whose truth is exact, unless others are asked for.
CommandLine ofMeanLobes(CommandLine line) {
  if (!isGiven(line.given, "lobe") && !isGiven(line.given, "fit-to"))
    line.given.insert(line.given.begin(), {findOption("lobe", kMeasure), "mean", "", 0, 0});
  return line;
}

}  // namespace

ExitCode runMeasure(const CommandLine& line) {
  BakeReport report;
  report.command = "measure";
  Stopwatch watch = watchOnTerminal(line.quiet);
  const auto [settings, cloud] = resolveCloud(ofMeanLobes(line), report, watch);
  const BakeParameters parameters = resolveParameters(cloud, settings, report, watch);
  if (!settings.output.file.empty()) return writeCurve(cloud, settings, parameters, report, watch);
  const IntegrationField field = fieldOfCloud(cloud, settings, parameters, report, watch);
  const BakedLobes baked = lobesOfCloud(cloud, field, settings.lobe, parameters, report, watch);
  const MeasuredFigures figures = measureBake(cloud, field, baked, settings, parameters);
  watch.lap(report.seconds, "truth");
  enforceStrict(settings.run.strict, report);
  tellReport(settings.run, report, {{"error", figuresJson(figures)}}, figuresText(figures));
  return ExitCode::kDone;
}

}  // namespace cloudbake
