// One page that loads nothing: style, script and thumbnails (base64: RFC 4648; data URIs: RFC 2397) are embedded. It may link to the live
// views of assets. The script sorts and filters tables, and shows a thumbnail when it is scrolled to. The thumbnails come last, so that the
// tables are there before they are read. Text from reports is escaped where it is inserted.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

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
* { box-sizing: border-box; } html { scroll-padding-top: 4rem; }
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
th button::after { content: " ↕"; }
th[aria-sort=ascending] button::after { content: " ↑"; } th[aria-sort=descending] button::after { content: " ↓"; }
.number { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
.picture { width: 136px; } .picture a { color: var(--baked); font-size: .8rem; }
.picture img { display: block; width: 120px; height: 80px; border-radius: .3rem; background: var(--sky); }
.asset { min-width: 14rem; } .asset b, .asset .faint { display: block; } .state { min-width: 9rem; }
.error { margin: .4rem 0 0; white-space: pre-wrap; font: .85rem/1.4 ui-monospace, monospace; color: var(--failed); }
.pill { display: inline-block; padding: 0 .6rem; border: 1px solid currentColor; border-radius: 1rem; font-size: .8rem; font-weight: 600;
  white-space: nowrap; }
.baked { color: var(--baked); } .from-cache { color: var(--from-cache); } .fresh { color: var(--fresh); }
.failed { color: var(--failed); } .not-run { color: var(--not-run); }
.warnings { min-width: 12rem; } .warnings summary { color: var(--warn); cursor: pointer; }
.warnings ul { margin: .3rem 0 0; padding-left: 1.1rem; }
.changes summary { cursor: pointer; } .changes ul ul { max-height: 20rem; overflow-y: auto; }
.tools { position: sticky; top: 0; z-index: 1; display: flex; flex-wrap: wrap; align-items: center; gap: .4rem 1.2rem;
  margin: 1.2rem 0 0; padding: .6rem 0; background: var(--page); border-bottom: 1px solid var(--line); }
.tools label { white-space: nowrap; } .tools input[type=search] { width: 20rem; max-width: 70vw; margin-left: .4rem; padding: .3rem .6rem;
  border: 1px solid var(--faint); border-radius: .4rem; background: var(--card); color: inherit; font: inherit; }
a:focus-visible, summary:focus-visible, input:focus-visible, [tabindex]:focus-visible {
  outline: 2px solid var(--baked); outline-offset: 2px; }
@media print { .tools { display: none; } }
)";

// Rows are filtered by their text without the numbers. Every word has to be in it.
constexpr const char* kScript = R"(
const find = selector => [...document.querySelectorAll(selector)];
for (const button of find("th button")) button.addEventListener("click", () => {
  const head = button.parentNode, body = head.closest("table").tBodies[0], order = new Intl.Collator("en", { numeric: true }).compare;
  const text = head.className === "asset" || head.className === "state", before = head.getAttribute("aria-sort");
  const sign = (before ? before === "descending" : text) ? 1 : -1;  // texts rise first, numbers fall
  for (const other of head.parentNode.cells) other.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", sign > 0 ? "ascending" : "descending");
  const key = row => row.cells[head.cellIndex].dataset.sort, compare = (a, b) => text ? order(a, b) : a - b;
  body.append(...[...body.rows].sort((a, b) =>
    key(a) === "" || key(b) === "" ? (key(a) === "") - (key(b) === "") : sign * compare(key(a), key(b))));
});

const rows = find("tbody tr"), filter = document.getElementById("filter"), boxes = find(".tools [type=checkbox]");
const textOf = new Map();
function showRows() {
  const words = filter.value.toLowerCase().split(/\s+/).filter(word => word);
  const states = new Set(boxes.filter(box => !box.checked).map(box => "is-" + box.value));
  let shown = 0;
  for (const row of rows) {
    if (words.length && !textOf.has(row))
      textOf.set(row, [...row.cells].filter(cell => cell.className !== "number").map(cell => cell.textContent.toLowerCase()).join("\n"));
    row.hidden = states.has(row.className) || !words.every(word => textOf.get(row).includes(word));
    shown += !row.hidden;
  }
  document.getElementById("shown").textContent = shown.toLocaleString("en") + " of " + rows.length.toLocaleString("en") + " assets";
}
if (filter) {
  showRows();  // a page that is gone back to keeps what was typed
  for (const input of [filter, ...boxes]) input.addEventListener("input", showRows);
}

const [begin, ...ends] = document.getElementById("pictures")?.textContent.slice(1).split("\n") ?? [], pictures = find("[data-picture]");
const show = image => { image.src = "data:image/jpeg;base64," + begin + ends[image.dataset.picture]; };
const seen = new IntersectionObserver(entries => {
  for (const { isIntersecting, target } of entries) if (isIntersecting) {
    seen.unobserve(target);
    show(target);
  }
}, { rootMargin: "400px" });
for (const image of pictures) seen.observe(image);
addEventListener("beforeprint", () => pictures.forEach(show));
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

// `line` is that of the picture in the list at the end of the page.
std::string pictureCell(const AssetRecord& asset, const AssetPicture& picture, size_t line) {
  std::string content;
  if (!picture.jpeg.empty()) content = "<img alt=\"\" data-picture=\"" + std::to_string(line) + "\">";
  if (!picture.live_view.empty())
    content = "<a href=\"" + urlOf(picture.live_view) + "\" aria-label=\"live view of " + escapedMarkup(asset.name) + "\">" + content +
              "live view</a>";
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

std::string assetRow(const AssetRecord& asset, const AssetPicture& picture, bool with_figures, size_t line) {
  std::string row = "<tr class=\"is-" + std::string(stateName(asset.state)) + "\">" + pictureCell(asset, picture, line) + assetCell(asset) +
                    stateCell(asset) + verticesCell(asset) + secondsCell(asset) + bytesCell(asset);
  if (with_figures)
    for (const char* key : kToldFigures) row += figureCell(asset, key);
  return row + warningsCell(asset) + "</tr>\n";
}

// The table of the failed assets, or of the others; what it draws is added to `drawn`. Columns of figures appear if an asset has figures.
std::string assetTable(const BatchReport& report, const std::vector<AssetPicture>& pictures, bool failed, std::vector<std::string>& drawn) {
  const auto shown = [&](const AssetRecord& asset) { return (asset.state == AssetState::kFailed) == failed; };
  const bool with_figures =
      std::any_of(report.assets.begin(), report.assets.end(), [&](const AssetRecord& asset) { return shown(asset) && asset.figures; });
  std::string table = "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"" +
                      std::string(failed ? "failed assets" : "assets") + "\"><table>\n<thead><tr><td></td>" + head("asset", "asset") +
                      head("state", "state") + head("number", "vertices") + head("number", "seconds") + head("number", "size");
  if (with_figures)
    for (const char* key : kToldFigures) table += head("number", figureName(figureField(key)));
  table += head("warnings", "warnings") + "</tr></thead>\n<tbody>\n";
  for (size_t i = 0; i < report.assets.size(); ++i)
    if (shown(report.assets[i])) {
      const AssetPicture picture = i < pictures.size() ? pictures[i] : AssetPicture();
      table += assetRow(report.assets[i], picture, with_figures, drawn.size());
      if (!picture.jpeg.empty()) drawn.push_back(encodeBase64(picture.jpeg));
    }
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
  if (!report.removed.empty()) html += tile("removed", grouped(report.removed.size()));
  html += tile("time", secondsText(report.seconds)) + tile("processor time", secondsText(report.processor_seconds));
  if (report.seconds > 0)
    html += tile("CPUs used", numberText(report.processor_seconds / report.seconds) + " of " + std::to_string(report.threads));
  return html + tile("peak memory", bytesText(report.peak_memory)) + "</dl>\n";
}

std::string item(const BatchChange& change) { return "<li>" + escapedMarkup(change.line()) + "</li>\n"; }

// One line that unfolds to those of all assets.
std::string foldedItem(const std::vector<BatchChange>& changes, const std::string& shared) {
  std::string html = "<li><details><summary>" + escapedMarkup(changes[0].what) + " × " + grouped(changes.size()) + escapedMarkup(shared) +
                     "</summary><ul tabindex=\"0\">\n";
  for (const BatchChange& change : changes) html += "<li>" + escapedMarkup(change.asset + change.detail) + "</li>\n";
  return html + "</ul></details></li>\n";
}

// Changes of one kind: those that share their detail are one line, and so are all of them if more than kMostLines would remain.
std::string itemsOfKind(const std::vector<BatchChange>& changes) {
  constexpr size_t kMostLines = 10;
  std::vector<std::vector<BatchChange>> alike;
  std::map<std::string, size_t> groups;
  for (const BatchChange& change : changes) {
    const auto [group, is_new] = groups.emplace(change.shared, alike.size());
    if (is_new) alike.emplace_back();
    alike[group->second].push_back(change);
  }
  if (alike.size() > kMostLines) return foldedItem(changes, "");
  std::string html;
  for (const auto& group : alike) html += group.size() == 1 ? item(group[0]) : foldedItem(group, group[0].shared);
  return html;
}

// With what --prune has removed of assets that the last report did not have.
std::string changesSection(const BatchReport& report, const std::vector<BatchChange>& changes) {
  std::vector<std::string> kinds;
  std::map<std::string, std::vector<BatchChange>> of_kind;
  std::set<std::string> told;
  const auto add = [&](const BatchChange& change) {
    if (!of_kind.contains(change.what)) kinds.push_back(change.what);
    of_kind[change.what].push_back(change);
    if (change.what == "removed") told.insert(change.asset);
  };
  for (const BatchChange& change : changes) add(change);
  for (const std::string& name : report.removed)
    if (told.insert(onOneLine(name)).second) add({"removed", onOneLine(name)});
  std::string html = "<section class=\"changes\">\n<h2>What changed since the last report</h2>\n<ul>\n";
  if (kinds.empty()) html += "<li>nothing</li>\n";
  for (const std::string& kind : kinds) html += itemsOfKind(of_kind[kind]);
  return html + "</ul>\n</section>\n";
}

// A text that rows must contain, and check boxes that hide the rows of a state if there are several states.
std::string tools(const BatchReport& report) {
  if (report.assets.size() < 2) return "";
  std::string boxes;
  size_t states = 0;
  for (const AssetState state : kAssetStates) {
    if (assetsIn(report, state) == 0) continue;
    ++states;
    boxes += "<label><input type=\"checkbox\" value=\"" + std::string(stateName(state)) + "\" checked> " + std::string(stateLabel(state)) +
             "</label>\n";
  }
  return "<div class=\"tools\">\n<label>Filter<input type=\"search\" id=\"filter\" placeholder=\"name, source, reason, "
         "warning\"></label>\n" +
         (states < 2 ? "" : boxes) + "<span class=\"faint\" id=\"shown\" role=\"status\"></span>\n</div>\n";
}

// Base64 of the pictures, one a line. They begin alike, with the same tables of a JPEG, so the first line is what all of them begin with.
std::string pictureLines(const std::vector<std::string>& drawn) {
  if (drawn.empty()) return "";
  size_t same = drawn[0].size();
  for (const std::string& text : drawn)
    same = std::min(same, size_t(std::mismatch(text.begin(), text.end(), drawn[0].begin(), drawn[0].end()).first - text.begin()));
  std::string html = "<script type=\"text/plain\" id=\"pictures\">\n" + drawn[0].substr(0, same) + "\n";
  for (const std::string& text : drawn) html += text.substr(same) + "\n";
  return html + "</script>\n";
}

}  // namespace

std::string batchHtml(const BatchReport& report, const std::vector<BatchChange>& changes, const std::vector<AssetPicture>& pictures) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>cloudbake: " +
      escapedMarkup(report.source) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n<main>\n" + heading(report);
  const size_t failed = assetsIn(report, AssetState::kFailed);
  std::vector<std::string> drawn;
  html += "<noscript><p class=\"notice\">Pictures, sorting and filters need scripts.</p></noscript>\n" + tools(report);
  if (failed > 0) html += "<section>\n<h2>Failed</h2>\n" + assetTable(report, pictures, true, drawn) + "</section>\n";
  html += changesSection(report, changes);
  if (failed < report.assets.size()) html += "<section>\n<h2>Assets</h2>\n" + assetTable(report, pictures, false, drawn) + "</section>\n";
  return html + "</main>\n" + pictureLines(drawn) + "<script>" + kScript + "</script>\n</body>\n</html>\n";
}

}  // namespace cloudbake
