// One page that loads nothing: style, script and thumbnails (base64: RFC 4648; data URIs: RFC 2397) are embedded. It may link to the live
// views of assets. The script only sorts tables; CSS hides states. Text from reports is escaped where it is inserted.
#include <algorithm>
#include <cmath>

#include "core/text/base64.h"
#include "core/text/markup.h"
#include "io/report/batch_parts.h"
#include "io/report/figures.h"

namespace cloudbake {

namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: light dark; --page: #f5f6f8; --card: #fff; --ink: #1c2127; --faint: #5d6773; --line: #dde1e6; --sky: #8fb4dc;
  --baked: #1b6fc2; --from-cache: #6a4fb3; --fresh: #23793f; --failed: #bd2c2c; --not-run: #66707b; --warn: #8a5a00; }
@media (prefers-color-scheme: dark) { :root { --page: #15181c; --card: #1e2227; --ink: #e4e7eb; --faint: #9aa4af; --line: #343a41;
  --sky: #34506e; --baked: #6cb0f5; --from-cache: #b39df0; --fresh: #6cc88a; --failed: #ff8f8a; --not-run: #a3adb8; --warn: #e3b341; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 110rem; padding: 1.5rem; background: var(--page); color: var(--ink);
  font: 15px/1.45 system-ui, sans-serif; }
h1 { margin: 0 0 .3rem; font-size: 1.5rem; } h2 { margin: 2rem 0 .6rem; font-size: 1.15rem; }
h1, p, li, td, dd { overflow-wrap: anywhere; }
.faint { color: var(--faint); } p { margin: 0 0 .3rem; }
.notice { padding: .6rem .9rem; border-left: 4px solid var(--warn); background: var(--card); }
dl { display: flex; flex-wrap: wrap; gap: .6rem; margin: 1rem 0 0; }
dl div { padding: .5rem .9rem; border: 1px solid var(--line); border-radius: .5rem; background: var(--card); }
dt { color: var(--faint); font-size: .8rem; } dd { margin: 0; font-size: 1.2rem; font-variant-numeric: tabular-nums; }
.scroll { overflow-x: auto; border: 1px solid var(--line); border-radius: .5rem; background: var(--card); }
table { width: 100%; border-collapse: collapse; }
th, td { padding: .45rem .7rem; border-bottom: 1px solid var(--line); text-align: left; vertical-align: top; }
tbody tr:last-child td { border-bottom: 0; }
th { white-space: nowrap; font-size: .8rem; color: var(--faint); }
th button { all: unset; cursor: pointer; } th button:focus-visible { outline: 2px solid var(--baked); }
th[aria-sort=ascending] button::after { content: " ↑"; } th[aria-sort=descending] button::after { content: " ↓"; }
.number { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
.picture { width: 136px; } .picture img { display: block; width: 120px; height: auto; border-radius: .3rem; background: var(--sky); }
.picture a { color: var(--baked); font-size: .8rem; }
.asset { min-width: 14rem; } .asset b, .asset .faint { display: block; } .state { min-width: 9rem; }
.error { margin: .4rem 0 0; white-space: pre-wrap; font: .85rem/1.4 ui-monospace, monospace; color: var(--failed); }
.pill { display: inline-block; padding: 0 .6rem; border: 1px solid currentColor; border-radius: 1rem; font-size: .8rem; font-weight: 600;
  white-space: nowrap; }
.baked { color: var(--baked); } .from-cache { color: var(--from-cache); } .fresh { color: var(--fresh); }
.failed { color: var(--failed); } .not-run { color: var(--not-run); }
.warnings { min-width: 12rem; } .warnings summary { color: var(--warn); cursor: pointer; }
.warnings ul { margin: .3rem 0 0; padding-left: 1.1rem; }
body:has(#show-baked:not(:checked)) .is-baked, body:has(#show-from-cache:not(:checked)) .is-from-cache,
body:has(#show-fresh:not(:checked)) .is-fresh, body:has(#show-not-run:not(:checked)) .is-not-run { display: none; }
.show { margin: 0 0 .6rem; } .show label { margin-right: 1rem; white-space: nowrap; }
)";

constexpr const char* kScript = R"(
for (const button of document.querySelectorAll("th button")) button.addEventListener("click", () => {
  const head = button.parentNode, body = head.closest("table").tBodies[0];
  const sign = head.getAttribute("aria-sort") === "descending" ? 1 : -1;
  for (const other of head.parentNode.cells) other.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", sign > 0 ? "ascending" : "descending");
  const key = row => row.cells[head.cellIndex].dataset.sort;
  const compare = (a, b) => head.className === "asset" || head.className === "state" ? a.localeCompare(b) : a - b;
  body.append(...[...body.rows].sort((a, b) =>
    key(a) === "" || key(b) === "" ? (key(a) === "") - (key(b) === "") : sign * compare(key(a), key(b))));
});
)";

constexpr const char* kToldFigures[] = {"direction_rms_degrees", "direction_p95_degrees", "transmittance_rms", "density_rms"};

// 13,826
std::string grouped(uint64_t count) {
  std::string text = std::to_string(count);
  for (size_t end = text.size(); end > 3; end -= 3) text.insert(end - 3, ",");
  return text;
}

std::string secondsText(double seconds) {
  if (seconds < 100) return numberText(seconds, std::chars_format::fixed, seconds < 10 ? 2 : 1) + " s";
  const auto whole = uint64_t(std::llround(seconds));
  if (whole < 6000) return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  return std::to_string(whole / 3600) + " h " + std::to_string(whole / 60 % 60) + " min";
}

std::string bytesText(uint64_t bytes) {
  if (bytes < 1000) return std::to_string(bytes) + " B";
  double value = double(bytes);
  const char* unit = "B";
  for (const char* larger : {"kB", "MB", "GB", "TB"}) {
    if (value < 1000) break;
    value /= 1000;
    unit = larger;
  }
  return numberText(value, std::chars_format::fixed, value < 10 ? 2 : value < 100 ? 1 : 0) + " " + unit;
}

std::string cell(const char* kind, const std::string& content, const std::string& sort) {
  return "<td class=\"" + std::string(kind) + "\" data-sort=\"" + sort + "\">" + content + "</td>";
}

std::string numberCell(const std::string& content, double sort) {
  return cell("number", content, numberText(sort, std::chars_format::general, 12));
}

std::string head(const char* kind, const std::string& label) {
  return "<th class=\"" + std::string(kind) + "\"><button>" + label + "</button></th>";
}

std::string pill(AssetState state) {
  return "<span class=\"pill " + std::string(stateName(state)) + "\">" + std::string(stateLabel(state)) + "</span>";
}

std::string tile(const std::string& label, const std::string& value) { return "<div><dt>" + label + "</dt><dd>" + value + "</dd></div>\n"; }

// The path as a relative URL (RFC 3986, section 4.2). A colon in its first part would end a scheme.
std::string urlOf(std::string_view path) {
  constexpr std::string_view kPlain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~/", kDigits = "0123456789ABCDEF";
  std::string url;
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    url += kPlain.find(c) != kPlain.npos ? std::string(1, c) : std::string{'%', kDigits[byte / 16], kDigits[byte % 16]};
  }
  return url;
}

std::string pictureCell(const AssetRecord& asset, const AssetPicture& picture) {
  std::string content;
  if (!picture.png.empty())
    content = "<img alt=\"" + escapedMarkup(asset.name) + "\" src=\"data:image/png;base64," + encodeBase64(picture.png) + "\">";
  if (!picture.live_view.empty()) content = "<a href=\"" + urlOf(picture.live_view) + "\">" + content + "live view</a>";
  return "<td class=\"picture\">" + content + "</td>";
}

std::string assetCell(const AssetRecord& asset) {
  std::string content = "<b>" + escapedMarkup(asset.name) + "</b><span class=\"faint\">" + escapedMarkup(asset.source) + "</span>";
  if (!asset.error.empty()) content += "<p class=\"error\">" + escapedMarkup(asset.error) + "</p>";
  return cell("asset", content, escapedMarkup(asset.name));
}

std::string stateCell(const AssetRecord& asset) {
  std::string content = pill(asset.state);
  if (asset.state == AssetState::kFailed) content += " <span class=\"faint\">exit " + std::to_string(asset.code) + "</span>";
  if (!asset.reason.empty()) content += "<p class=\"faint\">" + escapedMarkup(asset.reason) + "</p>";
  return cell("state", content, std::string(stateName(asset.state)));
}

std::string verticesCell(const AssetRecord& asset) {
  if (!asset.report.is_object() || !asset.report.contains("vertices")) return cell("number", "", "");
  const auto vertices = uint64_t(wholeNumber(asset.report["vertices"]));
  return numberCell(grouped(vertices), double(vertices));
}

std::string secondsCell(const AssetRecord& asset) {
  return asset.state == AssetState::kNotRun ? cell("number", "", "") : numberCell(secondsText(asset.seconds), asset.seconds);
}

// Empty if there is no output.
std::string bytesCell(const AssetRecord& asset) {
  return asset.bytes == 0 ? cell("number", "", "") : numberCell(bytesText(asset.bytes), double(asset.bytes));
}

std::string figureCell(const AssetRecord& asset, const char* key) {
  if (!asset.figures) return cell("number", "", "");
  const FigureField& field = figureField(key);
  const double value = field.of(*asset.figures);
  const std::string text = figureText(field, value);
  return text == "undefined" ? cell("number", text, "") : numberCell(text, value);
}

std::string warningsCell(const AssetRecord& asset) {
  const auto warnings = warningsOf(asset);
  if (warnings.empty()) return cell("warnings", "", "");
  std::string kinds, items;
  double total = 0;
  for (const CountedWarning& warning : warnings) {
    total += double(warning.count);
    const std::string kind = escapedMarkup(warning.kind) + " × " + grouped(warning.count);
    kinds += (kinds.empty() ? "" : ", ") + kind;
    items += "<li>" + kind + ": " + escapedMarkup(warning.first) + "</li>";
  }
  return cell("warnings", "<details><summary>" + kinds + "</summary><ul>" + items + "</ul></details>",
              numberText(total, std::chars_format::fixed, 0));
}

std::string assetRow(const AssetRecord& asset, const AssetPicture& picture, bool with_figures) {
  std::string row = "<tr class=\"is-" + std::string(stateName(asset.state)) + "\">" + pictureCell(asset, picture) + assetCell(asset) +
                    stateCell(asset) + verticesCell(asset) + secondsCell(asset) + bytesCell(asset);
  if (with_figures)
    for (const char* key : kToldFigures) row += figureCell(asset, key);
  return row + warningsCell(asset) + "</tr>\n";
}

// The table of the failed assets, or of the others. Columns of figures appear if an asset has figures.
std::string assetTable(const BatchReport& report, const std::vector<AssetPicture>& pictures, bool failed) {
  const auto shown = [&](const AssetRecord& asset) { return (asset.state == AssetState::kFailed) == failed; };
  const bool with_figures =
      std::any_of(report.assets.begin(), report.assets.end(), [&](const AssetRecord& asset) { return shown(asset) && asset.figures; });
  std::string table = "<div class=\"scroll\"><table>\n<thead><tr><th></th>" + head("asset", "asset") + head("state", "state") +
                      head("number", "vertices") + head("number", "seconds") + head("number", "size");
  if (with_figures)
    for (const char* key : kToldFigures) table += head("number", figureName(figureField(key)));
  table += head("warnings", "warnings") + "</tr></thead>\n<tbody>\n";
  for (size_t i = 0; i < report.assets.size(); ++i)
    if (shown(report.assets[i])) table += assetRow(report.assets[i], i < pictures.size() ? pictures[i] : AssetPicture(), with_figures);
  return table + "</tbody>\n</table></div>\n";
}

std::string heading(const BatchReport& report) {
  std::string html = "<h1>" + escapedMarkup(report.source) + "</h1>\n<p class=\"faint\">batch into " + escapedMarkup(report.output);
  if (report.shards > 0) html += ", shard " + std::to_string(report.shard) + " of " + std::to_string(report.shards);
  html += "</p>\n";
  if (report.interrupted)
    html += "<p class=\"notice\">The batch was interrupted. The next run bakes the assets that are still missing.</p>\n";
  html += "<dl>\n" + tile("assets", grouped(report.assets.size()));
  for (const AssetState state : kAssetStates)
    if (const size_t count = assetsIn(report, state)) html += tile(pill(state), grouped(count));
  html += tile("time", secondsText(report.seconds)) + tile("processor time", secondsText(report.processor_seconds));
  if (report.seconds > 0)
    html += tile("CPUs used", numberText(report.processor_seconds / report.seconds) + " of " + std::to_string(report.threads));
  return html + tile("peak memory", bytesText(report.peak_memory)) + "</dl>\n";
}

std::string list(const std::string& title, const std::vector<std::string>& lines) {
  std::string html = "<section>\n<h2>" + title + "</h2>\n<ul>\n";
  for (const std::string& line : lines) html += "<li>" + escapedMarkup(line) + "</li>\n";
  return html + "</ul>\n</section>\n";
}

// Check boxes that hide the rows of a state, if there are rows of several states.
std::string stateBoxes(const BatchReport& report) {
  std::string boxes;
  size_t states = 0;
  for (const AssetState state : kAssetStates) {
    if (state == AssetState::kFailed || assetsIn(report, state) == 0) continue;
    const std::string name(stateName(state));
    ++states;
    boxes += "<label><input type=\"checkbox\" id=\"show-" + name + "\" checked> " + std::string(stateLabel(state)) + "</label>\n";
  }
  return states < 2 ? "" : "<p class=\"show\">\n" + boxes + "</p>\n";
}

}  // namespace

std::string batchHtml(const BatchReport& report, const std::vector<std::string>& changes, const std::vector<AssetPicture>& pictures) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>cloudbake: " +
      escapedMarkup(report.source) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n" + heading(report);
  const size_t failed = assetsIn(report, AssetState::kFailed);
  if (failed > 0) html += "<section>\n<h2>Failed</h2>\n" + assetTable(report, pictures, true) + "</section>\n";
  html += list("What changed since the last report", changes.empty() ? std::vector<std::string>{"nothing"} : changes);
  if (!report.removed.empty()) html += list("Removed outputs", report.removed);
  if (failed < report.assets.size())
    html += "<section>\n<h2>Assets</h2>\n" + stateBoxes(report) + assetTable(report, pictures, false) + "</section>\n";
  return html + "<script>" + kScript + "</script>\n</body>\n</html>\n";
}

}  // namespace cloudbake
