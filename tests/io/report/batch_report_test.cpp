#include "io/report/batch_report.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <fstream>
#include <limits>
#include <locale>
#include <set>
#include <tuple>

#include "io/file/write_file.h"
#include "io/image/image.h"
#include "io/report/report.h"
#include "tests/folders.h"
#include "tests/io/io_helpers.h"
#include "tests/io/report/report_helpers.h"

using namespace cloudbake;

namespace {

const std::string kReplaced = "\xEF\xBF\xBD";

// What a path or a message of another program may hold. The control characters are forbidden in XML.
const std::string kHostile = "</td><script>alert('x')</script> \"q\" & $HOME #1 \\ ü 雲 \xFF\xC3( line\nend \x01\x1F\x7F ]]> \xEF\xBF\xBF";

AssetRecord bakedAsset() {
  BakeReport bake;
  bake.command = "grow";
  bake.input = "humilis";
  bake.vertices = 13826;
  bake.seconds = {{"bake", 0.125}};
  bake.warnings.add(WarningKind::kOpenEdges, "edge 3 of <mesh>", 12);
  bake.warnings.add(WarningKind::kThinPart, "a \"part\" & more", 2);
  AssetRecord asset;
  asset.name = "fair/humilis.glb";
  asset.source = "preset humilis, seed 7";
  asset.state = AssetState::kBaked;
  asset.reason = "input or settings changed";
  asset.key = "0123456789abcdef";
  asset.seconds = 0.375;
  asset.bytes = 5000000000ULL;
  asset.output_hash = "59c4afc4d3aba285d4baf0d0bdef70e3";
  asset.level_hashes = {"a1", "b2"};
  asset.report = Json::parse(reportJson(bake));
  asset.figures = BakeFigures{"Embree, all hits", 256, false, {1.5, 1.25, 3.5, 12.5, 0, 0, 0.03125, -0.015625}, {0.0625, -0.0078125}};
  return asset;
}

AssetRecord failedAsset() {
  AssetRecord asset;
  asset.name = "scans/" + kHostile + ".glb";
  asset.source = kHostile;
  asset.state = AssetState::kFailed;
  asset.reason = "new";
  asset.key = "ffff";
  asset.code = 3;
  asset.error = kHostile + ": no triangles; export it again";
  return asset;
}

AssetRecord plainAsset(const std::string& name, AssetState state) {
  AssetRecord asset;
  asset.name = name;
  asset.source = name + ".obj";
  asset.state = state;
  return asset;
}

// Every field set, every state there.
BatchReport sampleReport() {
  BatchReport report;
  report.source = "clouds & \"more\".toml";
  report.output = "out <dir>";
  report.shard = 2;
  report.shards = 5;
  report.interrupted = true;
  report.assets = {bakedAsset(), failedAsset(), plainAsset("cached.glb", AssetState::kFromCache),
                   plainAsset("fresh.glb", AssetState::kFresh), plainAsset("late.glb", AssetState::kNotRun)};
  report.removed = {"old.glb", "older " + kHostile};
  report.seconds = 12.5;
  report.processor_seconds = 81.25;
  report.peak_memory = 6000000000ULL;
  report.threads = 8;
  return report;
}

// As JSON can hold it.
std::string readBack(std::string text) {
  text.replace(text.find("\xFF\xC3"), 2, kReplaced + kReplaced);
  return text;
}

void expectEqual(const AssetRecord& a, const AssetRecord& b) {
  EXPECT_EQ(std::tie(a.name, a.source, a.state, a.reason, a.key, a.code, a.error, a.seconds, a.bytes, a.output_hash, a.level_hashes),
            std::tie(b.name, b.source, b.state, b.reason, b.key, b.code, b.error, b.seconds, b.bytes, b.output_hash, b.level_hashes));
  EXPECT_EQ(a.report, b.report);
  ASSERT_EQ(a.figures.has_value(), b.figures.has_value());
  if (!a.figures) return;
  const auto values = [](const BakeFigures& f) {
    return std::tie(f.truth, f.vertices, f.lobe.angle_rms_degrees, f.lobe.angle_median_degrees, f.lobe.angle_p95_degrees,
                    f.lobe.angle_max_degrees, f.lobe.density_rms, f.lobe.density_bias, f.transmittance.rms, f.transmittance.bias);
  };
  EXPECT_EQ(values(*a.figures), values(*b.figures));
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

void expectHas(const std::string& text, const std::string& piece) {
  EXPECT_NE(text.find(piece), std::string::npos) << "not found: " << piece << "\nin: " << text;
}

// The files that tests/cli/batch_files parses with Python's own readers.
void keep(const std::string& name, const std::string& bytes) {
  std::filesystem::create_directories(batchFolder());
  std::ofstream(batchFolder() / name, std::ios::binary) << bytes;
}

}  // namespace

TEST(BatchReport, ComesBackAsItWas) {
  const BatchReport report = sampleReport();
  const std::string text = batchJson(report);
  keep("report.json", text);
  BatchReport back = readBatchJson(text, "report.json");
  EXPECT_EQ(std::tie(back.source, back.output, back.shard, back.shards, back.interrupted, back.seconds, back.processor_seconds,
                     back.peak_memory, back.threads),
            std::tie(report.source, report.output, report.shard, report.shards, report.interrupted, report.seconds,
                     report.processor_seconds, report.peak_memory, report.threads));
  EXPECT_EQ(back.removed, (std::vector<std::string>{"old.glb", readBack("older " + kHostile)}));

  // What is no UTF-8 reads back as U+FFFD, all else as it was.
  ASSERT_EQ(back.assets.size(), report.assets.size());
  for (size_t i = 0; i < back.assets.size(); ++i) {
    AssetRecord expected = report.assets[i];
    if (i == 1)
      for (std::string* field : {&expected.name, &expected.source, &expected.error}) *field = readBack(*field);
    expectEqual(back.assets[i], expected);
  }
  EXPECT_EQ(batchJson(back), text);
}

TEST(BatchReport, AnEmptyBatchComesBack) {
  const BatchReport back = readBatchJson(batchJson(BatchReport()), "report.json");
  EXPECT_TRUE(back.assets.empty());
  EXPECT_EQ(batchJson(back), batchJson(BatchReport()));
}

TEST(BatchReport, AnUndefinedFigureComesBackUndefined) {
  BatchReport report;
  report.assets = {bakedAsset()};
  report.assets[0].figures->lobe.density_rms = kNaN;
  report.assets[0].figures->lobe.density_bias = kNaN;
  const std::string text = batchJson(report);
  keep("undefined.json", text);
  expectHas(text, "\"density_rms\": null");
  const BatchReport back = readBatchJson(text, "report.json");
  EXPECT_TRUE(std::isnan(back.assets[0].figures->lobe.density_rms));
  EXPECT_TRUE(std::isnan(back.assets[0].figures->lobe.density_bias));
  EXPECT_EQ(back.assets[0].figures->lobe.angle_rms_degrees, 1.5);
  EXPECT_TRUE(batchChanges(report, back).empty());
  EXPECT_TRUE(batchChanges(back, report).empty());
}

// Each row spoils one thing of a right report; the message names what.
TEST(BatchReport, RefusesWhatIsNoReport) {
  const std::string right = batchJson(sampleReport());
  const struct {
    std::string from, to, message;
  } rows[] = {
      {"cloudbake-batch-1", "cloudbake-batch-2", "\"schema\" is not cloudbake-batch-1"},
      {"\"schema\": \"cloudbake-batch-1\"", "\"schema\": 1", "\"schema\" is not text"},
      {"\"output\": \"out <dir>\"", "\"output\": null", "\"output\" is not text"},
      {"\"output\": \"out <dir>\",", "", "\"output\" is not text"},
      {"\"shard\": 2", "\"shard\": 6", "\"shard\" is not one of \"shards\""},
      {"\"shard\": 2", "\"shard\": 0", "\"shard\" is not one of \"shards\""},
      {"\"shards\": 5", "\"shards\": 5.5", "\"shards\" is not a whole number"},
      {"\"interrupted\": true", "\"interrupted\": 1", "\"interrupted\" is not true or false"},
      {"\"threads\": 8", "\"threads\": -8", "\"threads\" is not a whole number in the allowed range"},
      {"\"threads\": 8", "\"threads\": 3000000000", "\"threads\" is not a whole number in the allowed range"},
      {"\"seconds\": 12.5", "\"seconds\": -12.5", "\"seconds\" is not a number of 0 or more"},
      {"\"seconds\": 12.5", "\"seconds\": \"12.5\"", "\"seconds\" is not a number"},
      {"\"seconds\": 12.5", "\"seconds\": 1e999", "a number that is too large"},
      {"\"peak_memory_bytes\": 6000000000", "\"peak_memory_bytes\": 1e39", "\"peak_memory_bytes\" is not a whole number"},
      {"\"peak_memory_bytes\": 6000000000", "\"peak_memory_bytes\": 18446744073709551615", "\"peak_memory_bytes\" is not a whole number"},
      {"\"failed\": 1", "\"failed\": 2", "\"counts.failed\" is not the number of its assets"},
      {"\"removed\": [", "\"removed\": [7,", "\"removed\" is not an array of text"},
      {"\"assets\": [", "\"assets\": [7,", "\"assets\" is not an array of objects"},
      {"\"assets\": [", "\"assets\": {}, \"others\": [", "\"assets\" is not an array of objects"},
      {"\"state\": \"failed\"", "\"state\": \"Failed\"", "\"assets[1].state\" is not a state of an asset"},
      {"\"code\": 3", "\"code\": 300", "\"assets[1].code\" is not a whole number in the allowed range"},
      {"\"bytes\": 5000000000", "\"bytes\": -1", "\"assets[0].bytes\" is not a whole number in the allowed range"},
      {"\"key\": \"ffff\"", "\"key\": [\"ffff\"]", "\"assets[1].key\" is not text"},
      {"\"figures\": {", "\"figures\": [], \"others\": {", "\"assets[0].figures\" is not an object"},
      {"\"transmittance_rms\": 0.0625", "\"transmittance_rms\": -0.0625", "\"assets[0].figures.transmittance_rms\" is not a number of 0"},
      {"\"density_bias\": -0.015625", "\"density_bias\": \"\"", "\"assets[0].figures.density_bias\" is not a number"},
      {"cloudbake-report-1", "cloudbake-report-9", "\"assets[0].report.schema\" is not cloudbake-report-1"},
      {"\"vertices\": 13826", "\"vertices\": \"many\"", "\"assets[0].report.vertices\" is not a whole number"},
      {"\"count\": 12", "\"count\": \"12\"", "\"assets[0].report.warnings[0].count\" is not a whole number"},
      {"\"first\": \"edge 3 of <mesh>\"", "\"first\": 3", "\"assets[0].report.warnings[0].first\" is not text"},
  };
  for (const auto& row : rows) expectError<InputError>([&] { readBatchJson(replaced(right, row.from, row.to), "old.json"); }, row.message);
}

TEST(BatchReport, RefusesTextThatIsNoJson) {
  const std::string right = batchJson(sampleReport());
  for (const std::string& text : {std::string(), std::string("\n\n"), std::string(1, '\0'), right + "}", "\xFF" + right,
                                  replaced(right, "ü", "\xFC"), std::string("{\"schema\": \"cloudbake-batch-1\"")})
    expectError<InputError>([&] { readBatchJson(text, "old.json"); }, "the JSON ends too early or is not valid from here on");
  for (size_t size = 0; size + 2 < right.size(); size += 7)
    expectError<InputError>([&] { readBatchJson(right.substr(0, size), "old.json"); }, "old.json:");
  for (const std::string& text : {std::string("[]"), std::string("7"), std::string("null"), "[" + right + "]"})
    expectError<InputError>([&] { readBatchJson(text, "old.json"); }, "does not contain an object");

  // The line where it went wrong.
  expectError<InputError>([] { readBatchJson("{\n\"schema\":\n?\n}\n", "old.json"); }, "old.json:3: ");
}

TEST(BatchReport, RefusesWhatIsNestedDeeply) {
  const std::string open(100000, '['), close(100000, ']');
  for (const std::string& text :
       {open, open + close, replaced(batchJson(sampleReport()), "\"triangles\": 0", "\"triangles\": " + open + close)})
    expectError<InputError>([&] { readBatchJson(text, "old.json"); }, "nested more than 200 levels deep");
}

TEST(BatchReport, IgnoresKeysOfOthers) {
  const std::string text = replaced(batchJson(sampleReport()), "\"threads\": 8", "\"note\": {\"by\": [1]}, \"threads\": 8");
  EXPECT_EQ(batchJson(readBatchJson(text, "report.json")), batchJson(sampleReport()));
}

namespace {

// Every key that the page of the schema knows for an object, and every key that it demands, against those of an object.
void expectKeys(const Json& schema, const Json& object, const std::string& where) {
  std::set<std::string> known, demanded, optional, there;
  for (const auto& [key, value] : schema["properties"].items()) known.insert(key);
  for (const auto& key : schema["required"]) demanded.insert(key);
  for (const auto& [key, value] : object.items()) there.insert(key);
  EXPECT_EQ(known, there) << where;
  EXPECT_EQ(schema["additionalProperties"], false) << where;
  for (const std::string& key : demanded) EXPECT_TRUE(known.contains(key)) << where << ": " << key;
  for (const std::string& key : known)
    if (!demanded.contains(key)) optional.insert(key);
  EXPECT_EQ(optional, where == "asset" ? (std::set<std::string>{"figures", "level_hashes", "report"}) : std::set<std::string>()) << where;
  for (const auto& [key, value] : schema["properties"].items())
    EXPECT_TRUE(value.contains("description") || value.value("$ref", "") == "#/$defs/figures") << where << ": " << key;
}

}  // namespace

TEST(BatchReport, TheSchemaHasItsKeys) {
  const Json schema = Json::parse(readFileBytes(sourceFolder() / "docs/batch_report.schema.json"));
  const Json json = Json::parse(batchJson(sampleReport()));
  expectKeys(schema, json, "batch");
  expectKeys(schema["properties"]["counts"], json["counts"], "counts");
  expectKeys(schema["$defs"]["asset"], json["assets"][0], "asset");
  expectKeys(schema["$defs"]["figures"], json["assets"][0]["figures"], "figures");
  EXPECT_FALSE(json["assets"][1].contains("report"));
  EXPECT_FALSE(json["assets"][1].contains("figures"));
  EXPECT_EQ(schema["properties"]["schema"]["const"], json["schema"]);

  // The words for a state are the same everywhere.
  std::vector<std::string> states;
  for (const auto& [key, value] : json["counts"].items()) states.push_back(key);
  EXPECT_EQ(schema["$defs"]["asset"]["properties"]["state"]["enum"].get<std::vector<std::string>>(), states);
  for (const Json& asset : json["assets"]) EXPECT_EQ(json["counts"][asset["state"].get<std::string>()], 1);
}

TEST(BatchJunit, TellsEachAsset) {
  const std::string xml = batchJunit(sampleReport());
  keep("junit.xml", xml);
  const std::string totals = "tests=\"5\" failures=\"1\" errors=\"0\" skipped=\"1\" time=\"12.500\">";
  expectHas(xml, "<testsuites name=\"cloudbake batch\" " + totals);
  expectHas(xml, "<testsuite name=\"clouds &amp; &quot;more&quot;.toml\" " + totals);
  expectHas(xml, "<testcase classname=\"preset humilis, seed 7\" name=\"fair/humilis.glb\" time=\"0.375\">");
  expectHas(xml, "<system-out>open-edges (12): edge 3 of &lt;mesh&gt;\nthin-part (2): a &quot;part&quot; &amp; more\n</system-out>");
  expectHas(xml, "<testcase classname=\"fresh.glb.obj\" name=\"fresh.glb\" time=\"0.000\"/>");
  expectHas(xml, "name=\"late.glb\" time=\"0.000\">\n      <skipped message=\"the batch ended before its turn\"/>\n    </testcase>");
  EXPECT_EQ(count(xml, "<failure message="), 1U);
  EXPECT_EQ(count(xml, "<skipped"), 1U);
  const std::string hostile = "&lt;/td&gt;&lt;script&gt;alert(&#39;x&#39;)&lt;/script&gt; &quot;q&quot; &amp; $HOME #1 \\ ü 雲 " +
                              kReplaced + kReplaced + "( line&#10;end \x7F ]]&gt; ";
  expectHas(xml, "<failure message=\"" + hostile + ": no triangles; export it again\" type=\"exit 3\">" + hostile);
  expectHas(xml, "classname=\"" + hostile + "\" name=\"scans/" + hostile + ".glb\"");
}

TEST(BatchChanges, EqualReportsGiveNone) {
  EXPECT_TRUE(batchChanges(BatchReport(), BatchReport()).empty());
  EXPECT_TRUE(batchChanges(sampleReport(), sampleReport()).empty());
  EXPECT_TRUE(batchChanges(readBatchJson(batchJson(sampleReport()), "report.json"), sampleReport()).empty());
}

namespace {

using Lines = std::vector<std::string>;

Lines linesOf(const std::vector<BatchChange>& changes) {
  Lines lines;
  for (const BatchChange& change : changes) lines.push_back(change.line());
  return lines;
}

// The lines after `change` was made to the sample.
template <typename Change>
std::vector<std::string> linesAfter(Change change) {
  const BatchReport before = sampleReport();
  BatchReport now = before;
  change(now);
  return linesOf(batchChanges(before, now));
}

}  // namespace

TEST(BatchChanges, EachKindGivesItsLine) {
  EXPECT_EQ(linesAfter([](BatchReport& r) { r.assets.push_back(plainAsset("more.glb", AssetState::kBaked)); }),
            Lines{"new: more.glb, from more.glb.obj"});
  EXPECT_EQ(linesAfter([](BatchReport& r) { r.assets.erase(r.assets.begin()); }),
            Lines{"gone: fair/humilis.glb, from preset humilis, seed 7"});
  EXPECT_EQ(linesAfter([](BatchReport& r) {
              r.removed = {r.assets[2].name};
              r.assets.erase(r.assets.begin() + 2);
            }),
            Lines{"removed: cached.glb, from cached.glb.obj"});
  EXPECT_EQ(linesAfter([](BatchReport& r) { r.assets[0].key = "1"; }), Lines{"inputs, settings or build changed: fair/humilis.glb"});
  EXPECT_EQ(linesAfter([](BatchReport& r) {
              r.assets[3].state = AssetState::kFailed;
              r.assets[3].error = "a.obj:7:\nno number";
            }),
            Lines{"fails now: fresh.glb: a.obj:7: no number"});
  EXPECT_EQ(linesAfter([](BatchReport& r) { r.assets[0].figures->lobe.angle_rms_degrees = 1.75; }),
            Lines{"figures moved: fair/humilis.glb: direction rms from 1.5° to 1.75°"});
  EXPECT_EQ(linesAfter([](BatchReport& r) {
              r.assets[0].figures->lobe.density_rms = kNaN;
              r.assets[0].figures->transmittance.bias = 0.01;
            }),
            Lines{"figures moved: fair/humilis.glb: density rms from 3.12% to undefined, transmittance bias from -0.781% to 1%"});
}

TEST(BatchChanges, FailuresComeAndGo) {
  BatchReport before, now;
  before.assets = now.assets = {plainAsset("a.glb", AssetState::kFailed)};
  before.assets[0].error = "a.obj: is empty; export it again";
  now.assets[0].state = AssetState::kBaked;
  EXPECT_EQ(linesOf(batchChanges(before, now)), Lines{"no longer fails: a.glb"});
  now.assets[0].state = AssetState::kFailed;
  now.assets[0].error = "a.obj: has no faces; export it again";
  EXPECT_EQ(linesOf(batchChanges(before, now)), Lines{"fails with another error: a.glb: a.obj: has no faces; export it again"});

  // What did not run tells nothing of its failure. A new asset may fail at once.
  now.assets[0].state = AssetState::kNotRun;
  EXPECT_TRUE(batchChanges(before, now).empty());
  EXPECT_EQ(linesOf(batchChanges(BatchReport(), before)),
            (Lines{"new: a.glb, from a.glb.obj", "fails now: a.glb: a.obj: is empty; export it again"}));
}

// Assets of another shard are neither new nor gone.
TEST(BatchChanges, ShardsAreComparedWhereTheyMeet) {
  BatchReport before, now;
  before.assets = {plainAsset("a.glb", AssetState::kBaked), plainAsset("b.glb", AssetState::kBaked)};
  now.assets = {plainAsset("b.glb", AssetState::kFailed), plainAsset("c.glb", AssetState::kBaked)};
  now.shard = 1, now.shards = 4;
  EXPECT_EQ(linesOf(batchChanges(before, now)),
            (Lines{"only assets in both reports are compared: now shard 1 of 4, before the whole batch", "fails now: b.glb: "}));
}

TEST(BatchHtml, HoldsTheBatch) {
  const std::string jpeg = encodeJpeg(blankImage(kThumbnailWidth, kThumbnailHeight), 70);
  const std::string html = batchHtml(sampleReport(), {{"new", "<a> & b"}}, {{jpeg}, {}, {"M"}, {"Ma"}, {"Man"}});
  keep("page.html", html);
  for (const char* piece : {"<h1>clouds &amp; &quot;more&quot;.toml</h1>",
                            "batch into out &lt;dir&gt;, shard 2 of 5",
                            "The batch was interrupted",
                            "<dd>12.5 s</dd>",
                            "<dd>81.2 s</dd>",
                            "<dt>CPUs used</dt><dd>6.5 of 8</dd>",
                            "<dd>6.00 GB</dd>",
                            "<li>new: &lt;a&gt; &amp; b</li>",
                            "<dt>removed</dt><dd>2</dd>",
                            "<li><details><summary>removed × 2</summary>",
                            "<li>old.glb</li>",
                            "<span class=\"pill baked\">baked</span><p class=\"faint\">input or settings changed</p>",
                            "<span class=\"faint\">exit 3</span>",
                            "data-sort=\"13826\">13,826<",
                            ">0.38 s<",
                            ">5.00 GB<",
                            ">1.5°<",
                            ">3.5°<",
                            ">6.25%<",
                            ">3.12%<",
                            "data-sort=\"14\"><details><summary>open-edges × 12, thin-part × 2</summary>",
                            "<li>open-edges × 12: edge 3 of &lt;mesh&gt;</li>",
                            ": no triangles; export it again</p>"})
    expectHas(html, piece);
  BatchReport long_one = sampleReport();
  long_one.seconds = 119.7, long_one.processor_seconds = 7261, long_one.peak_memory = 999;
  const std::string long_page = batchHtml(long_one, {}, {});
  for (const char* piece : {"<dd>2 min 0 s</dd>", "<dd>2 h 1 min</dd>", "<dd>999 B</dd>"}) expectHas(long_page, piece);
  EXPECT_LT(html.find("<h2>Failed</h2>"), html.find("<h2>What changed since the last report</h2>"));
  EXPECT_LT(html.find("scans/"), html.find("fair/humilis.glb"));
  EXPECT_EQ(count(html, "scans/"), 2U) << "a failed asset stands in its section alone: as name and as sort key";

  // Thumbnails come last, in the order of the rows; base64 of 1, 2 and 3 bytes as in RFC 4648.
  EXPECT_EQ(count(html, "<img "), 4U);
  EXPECT_EQ(html.find("<img alt=\"\" data-picture=\"0\""), html.find("<img "));
  EXPECT_LT(html.find("data-picture=\"3\""), html.find("</main>"));
  expectHas(html.substr(html.find("</main>")), "<script type=\"text/plain\" id=\"pictures\">\n\n/9j/4AAQ");
  expectHas(html, "\nTQ==\nTWE=\nTWFu\n</script>");
}

// Paths become relative URLs: every byte that means something in a URL or in HTML is escaped.
TEST(BatchHtml, PicturesLinkToLiveViews) {
  BatchReport report;
  for (const char* name : {"a.glb", "b.glb", "c.glb"}) report.assets.push_back(plainAsset(name, AssetState::kBaked));
  const std::string html = batchHtml(report, {}, {{"M", "../out/a:b c#d?%&\"'<\xC3\xBC\xFF-._~.html"}, {"M", ""}, {"", "c.html"}});
  keep("linked.html", html);
  expectHas(
      html,
      "<td class=\"picture\"><a href=\"../out/a%3Ab%20c%23d%3F%25%26%22%27%3C%C3%BC%FF-._~.html\" aria-label=\"live view of a.glb\"><img "
      "alt=\"\" data-picture=\"0\">live view</a></td>");
  expectHas(html, "<td class=\"picture\"><a href=\"c.html\" aria-label=\"live view of c.glb\">live view</a></td>");
  EXPECT_EQ(count(html, "href="), 2U);
}

TEST(BatchHtml, StandsAloneAndIsEscaped) {
  const std::string html = batchHtml(sampleReport(), {{kHostile}, {"new", kHostile, kHostile, kHostile}}, {{"jpeg"}});
  EXPECT_EQ(count(html, "<script>"), 1U);
  EXPECT_EQ(html.find("alert('x')"), std::string::npos);
  EXPECT_EQ(html.find("\xFF"), std::string::npos);
  EXPECT_EQ(html.find('\x01'), std::string::npos);
  for (const char* reference : {"http://", "https://", "<link", "@import", "url(", "href="})
    EXPECT_EQ(html.find(reference), std::string::npos);
  EXPECT_EQ(count(html, "src="), 0U);
}

TEST(BatchHtml, LeavesOutWhatIsNotThere) {
  BatchReport report;
  report.source = "clouds";
  report.assets = {plainAsset("a.glb", AssetState::kFresh)};
  const std::string html = batchHtml(report, {}, {});
  keep("small.html", html);
  for (const char* piece :
       {"<h2>Failed", "Removed outputs", "interrupted", "shard", "direction rms", "CPUs used", "<img", "<input", "id=\"pictures"})
    EXPECT_EQ(html.find(piece), std::string::npos) << piece;
  expectHas(html, "<li>nothing</li>");
  keep("empty.html", batchHtml(BatchReport(), {}, {}));
  keep("empty.xml", batchJunit(BatchReport()));
  keep("empty.json", batchJson(BatchReport()));
}

namespace {

struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

}  // namespace

// A comma for the point would spoil JSON, XML and sorting. C++ streams take the one locale, printf the other, where it is installed.
TEST(BatchReport, NoLocaleChangesIt) {
  const auto all = [] { return batchJson(sampleReport()) + batchJunit(sampleReport()) + batchHtml(sampleReport(), {}, {}); };
  const std::string expected = all();
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  std::setlocale(LC_ALL, "de_DE.UTF-8");
  const std::string text = all();
  std::setlocale(LC_ALL, "C");
  std::locale::global(before);
  EXPECT_EQ(text, expected);
}

// What `gcc -M` writes for files of these names; the colon is escaped besides, since Make takes a bare one for a rule. GNU Make 4.3 and
// Ninja 1.11 read all of them back, but for the tab (Make alone).
TEST(BatchDepfile, EscapesAsMakeAndNinjaRead) {
  EXPECT_EQ(depfileText("out.json", {}), "out.json:\n");
  EXPECT_EQ(depfileText("out dir/r.json", {"a.obj", "b c.obj"}), "out\\ dir/r.json: \\\n  a.obj \\\n  b\\ c.obj\na.obj:\nb\\ c.obj:\n");
  const std::pair<const char*, const char*> rows[] = {{"a#b", "a\\#b"},
                                                      {"a$b", "a$$b"},
                                                      {"a:b", "a\\:b"},
                                                      {"a\\b", "a\\b"},
                                                      {"a\\b c", "a\\b\\ c"},
                                                      {"a\\ b", "a\\\\\\ b"},
                                                      {"a\\\\ b", "a\\\\\\\\\\ b"},
                                                      {"a%b", "a%b"},
                                                      {"雲", "雲"},
                                                      {"a\tb", "a\\\tb"},
                                                      {"a  b", "a\\ \\ b"},
                                                      {"\xFF", "\xFF"}};
  for (const auto& [name, escaped] : rows) EXPECT_EQ(depfileText("t", {name}), std::string("t: \\\n  ") + escaped + "\n" + escaped + ":\n");
}

TEST(BatchDepfile, RefusesNamesThatItCannotHold) {
  for (const char* name : {"a\nb", "a\rb", "a\\"}) {
    expectError<InputError>([&] { depfileText("t", {"x", name}); }, "a depfile cannot contain a file name");
    expectError<InputError>([&] { depfileText(name, {}); }, "a depfile cannot contain a file name");
  }
}
