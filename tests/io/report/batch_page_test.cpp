// The HTML page of a batch of many assets: what it folds, and how large it is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "core/random.h"
#include "io/image/image.h"
#include "io/report/batch_report.h"
#include "io/report/report.h"
#include "tests/folders.h"
#include "tests/io/report/report_helpers.h"

using namespace cloudbake;

namespace {

constexpr size_t kMany = 500;

// Lumps before a sky, which take as many bytes as pictures of clouds: 2.6 kB.
Image lumps(uint64_t seed) {
  Image image = blankImage(kThumbnailWidth, kThumbnailHeight);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      Vec3 color{0.35F + 0.002F * float(y), 0.55F + 0.0015F * float(y), 0.8F};
      for (uint32_t i = 0; i < 24; ++i) {
        const auto draw = [&](uint32_t k, int most) { return float(hashDraw(seed, i, k) % uint64_t(most)); };
        const float dx = float(x) - 40 - draw(0, 100), dy = float(y) - 40 - draw(1, 50), r = 8 + draw(2, 10);
        if (const float height = 1 - (dx * dx + dy * dy) / (r * r); height > 0)
          color = Vec3{1, 1, 1} * (0.6F + 0.4F * std::sqrt(height) - 0.003F * float(y));
      }
      image.at(x, y) = color;
    }
  return image;
}

BatchReport manyAssets() {
  BatchReport report;
  report.source = "clouds.toml";
  report.output = "baked";
  BakeReport bake;
  bake.vertices = 600;
  bake.warnings.add(WarningKind::kThinPart, "a sphere has a radius under 1.5 voxels: use more --voxels to keep its shape", 3);
  bake.warnings.add(WarningKind::kOpenEdges, "edge 3", 2);
  for (size_t i = 0; i < kMany; ++i) {
    AssetRecord asset;
    asset.name = "humilis/" + std::to_string(i + 1) + ".glb";
    asset.source = "preset humilis, seed " + std::to_string(i + 1);
    asset.state = i % 25 == 24 ? AssetState::kFailed : i % 2 == 0 ? AssetState::kBaked : AssetState::kFresh;
    if (asset.state == AssetState::kBaked) asset.reason = "settings changed";
    if (asset.state == AssetState::kFailed) asset.error = asset.source + ": no triangles; export it again";
    asset.key = "now";
    asset.seconds = double((i * 7) % kMany);
    asset.bytes = 20000 + i;
    asset.report = Json::parse(reportJson(bake));
    asset.figures = BakeFigures{"Embree, all hits", 200, false, {1.5, 1.25, 3.5, 12.5, 0, 0, 0.03125, -0.015625}, {0.0625, -0.0078125}};
    report.assets.push_back(asset);
  }
  return report;
}

std::string pageOf(const BatchReport& report) {
  BatchReport before = report;
  for (AssetRecord& asset : before.assets) asset.state = AssetState::kFresh, asset.key = "before";
  constexpr size_t kDrawn = 10;  // these tests are not optimised
  std::vector<std::string> drawn;
  for (size_t i = 0; i < kDrawn; ++i) drawn.push_back(encodeJpeg(lumps(i), 70));
  std::vector<AssetPicture> pictures;
  for (size_t i = 0; i < report.assets.size(); ++i) pictures.push_back({drawn[i % kDrawn], "humilis/" + std::to_string(i + 1) + ".html"});
  return batchHtml(report, batchChanges(before, report), pictures);
}

std::string pageWith(const std::vector<BatchChange>& changes) { return batchHtml({}, changes, {}); }

}  // namespace

// tests/browser/report.mjs opens the page.
TEST(BatchPage, FiveHundredAssetsTakeTwoMegabytes) {
  const std::string html = pageOf(manyAssets());
  std::filesystem::create_directories(batchFolder());
  std::ofstream(batchFolder() / "many.html", std::ios::binary) << html;
  EXPECT_LE(html.size(), 2'000'000U);
  EXPECT_GE(html.size(), 1'000'000U) << "the pictures are in it";
  EXPECT_EQ(count(html, "data-picture=\""), kMany);
  EXPECT_LT(html.find("</main>"), html.size() / 2) << "pictures come after the tables";
  EXPECT_EQ(count(html, "inputs, settings or build changed"), 1U);
  EXPECT_EQ(count(html, "<summary>inputs, settings or build changed × 500</summary>"), 1U);
  EXPECT_EQ(count(html, "<summary>fails now × 20: no triangles; export it again</summary>"), 1U) << "the names of the files differ";
}

TEST(BatchPage, FoldsWhatIsTheSame) {
  std::vector<BatchChange> changes;
  for (const char* name : {"a.glb", "b.glb", "c.glb"}) {
    changes.push_back({"new", name, std::string(", from ") + name});
    const std::string error = name == std::string("c.glb") ? ": other" : ": one";
    changes.push_back({"fails now", name, ": x" + error, error});
  }
  const std::string html = pageWith(changes);
  EXPECT_EQ(count(html, "<summary>new × 3</summary><ul tabindex=\"0\">\n<li>a.glb, from a.glb</li>\n<li>b.glb, from b.glb</li>\n"), 1U);
  EXPECT_EQ(count(html, "<summary>fails now × 2: one</summary>"), 1U) << html;
  EXPECT_EQ(count(html, "<li>fails now: c.glb: x: other</li>"), 1U);
  EXPECT_EQ(count(html, "a.glb"), 3U) << "nothing is lost or twice";
}

// Figures seldom move alike: more than ten lines of a kind are one.
TEST(BatchPage, FoldsManyLinesOfAKind) {
  std::vector<BatchChange> changes;
  for (int i = 0; i < 11; ++i) {
    const std::string moved = ": direction rms from 1° to " + std::to_string(i + 2) + "°";
    EXPECT_EQ(count(pageWith(changes), "<li>figures moved: a"), size_t(i));
    changes.push_back({"figures moved", "a" + std::to_string(i), moved, moved});
  }
  EXPECT_EQ(count(pageWith(changes), "<summary>figures moved × 11</summary>"), 1U);
  EXPECT_EQ(count(pageWith(changes), "direction rms from"), 11U);
}

TEST(BatchPage, WhatWasRemovedIsThereOnce) {
  BatchReport report;
  report.removed = {"a.glb", "old <1>.glb"};
  const std::string html = batchHtml(report, {{"removed", "a.glb", ", from a.obj"}}, {});
  EXPECT_EQ(count(html, "<summary>removed × 2</summary>"), 1U);
  EXPECT_EQ(count(html, "a.glb"), 1U);
  EXPECT_EQ(count(html, "<li>a.glb, from a.obj</li>"), 1U);
  EXPECT_EQ(count(html, "<li>old &lt;1&gt;.glb</li>"), 1U);
  EXPECT_EQ(count(html, "<dt>removed</dt><dd>2</dd>"), 1U);
  EXPECT_EQ(count(html, "<li>nothing</li>"), 0U);
}

// Equal pictures have nothing but their common beginning.
TEST(BatchPage, EqualPicturesKeepTheirLines) {
  BatchReport report;
  report.assets.resize(2);
  EXPECT_EQ(count(batchHtml(report, {}, {{"Man"}, {"Man"}}), "id=\"pictures\">\nTWFu\n\n\n</script>"), 1U);
  EXPECT_EQ(count(batchHtml(report, {}, {{"Man"}}), "id=\"pictures\">\nTWFu\n\n</script>"), 1U);
}
