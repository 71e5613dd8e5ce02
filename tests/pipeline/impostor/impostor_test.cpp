// Impostors of baked assets.
#include "pipeline/impostor/impostor.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstdio>

#include "core/error.h"
#include "io/file/write_file.h"
#include "pipeline/library/cloudbake.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace cloudbake {
namespace {

// A grown cloud as a baked asset.
std::filesystem::path hero() {
  static const TestFolder folder;
  std::filesystem::path file = folder.path / "hero.glb";
  if (!std::filesystem::exists(file)) writeFileAtomically(file, grow("hero", {{"vertices", "2000"}}).glb);
  return file;
}

Settings impostorOf(const std::filesystem::path& asset) {
  Settings settings = settingsFor({}, SourceKind::kSculpt, asset);
  settings.impostor.views = 4, settings.impostor.frame = 24;
  return settings;
}

BakedImpostor baked(const Settings& settings) {
  BakeReport report;
  Stopwatch watch;
  return bakeImpostor(readImpostorSubject(settings, report, watch), settings, report, watch);
}

TEST(BakeImpostor, IsNearerToTheLightThanSixWayMapsAndKeepsItWhenStored) {
  for (const ImpostorOf of : {ImpostorOf::kVolume, ImpostorOf::kMesh}) {
    Settings settings = impostorOf(hero());
    settings.impostor.of = of;
    const BakedImpostor impostor = baked(settings);
    const ImpostorFigures& figures = impostor.figures;
    std::printf("[figures] %s: rms %.4f fitted, %.4f stored, %.4f six-way\n", of == ImpostorOf::kMesh ? "mesh" : "volume", figures.fitted,
                figures.stored, figures.six_way);
    EXPECT_LT(figures.fitted, (of == ImpostorOf::kMesh ? 0.4 : 1.0) * figures.six_way);
    EXPECT_LT(figures.stored, figures.fitted + 0.002);
    EXPECT_GT(figures.texels, 1000U);
    EXPECT_EQ(impostor.impostor.info.of, of);
  }
}

TEST(BakeImpostor, HasTheSameBytesForAnyNumberOfThreads) {
  const Settings settings = impostorOf(hero());
  const auto bytes = [&] {
    const BakedImpostor impostor = baked(settings);
    return encodeImpostor(impostor.impostor, billboardOf(impostor.impostor)).glb;
  };
  const std::string many = bytes();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(many, bytes());
}

TEST(BakeImpostor, WritesSixWayMapsOfTheSameViews) {
  Settings settings = impostorOf(hero());
  settings.impostor.six_way = true;
  const BakedImpostor impostor = baked(settings);
  ASSERT_TRUE(impostor.six_way);
  EXPECT_EQ(impostor.six_way->size, 4 * 24);
  for (size_t i = 0; i < impostor.impostor.rest[0].pixels.size(); ++i)
    EXPECT_NEAR(float(impostor.six_way->first[4 * i + 3]), 255 * impostor.impostor.rest[0].pixels[i].y, 0.6F) << "the same opacity";
}

TEST(BakeImpostor, RefusesWhatItCannotSee) {
  const BakedImpostor impostor = baked(impostorOf(hero()));
  const TestFolder folder;
  const std::filesystem::path file = folder.path / "impostor.glb";
  writeFileAtomically(file, encodeImpostor(impostor.impostor, billboardOf(impostor.impostor)).glb);
  EXPECT_THROW(baked(impostorOf(file)), InputError);
}

}  // namespace
}  // namespace cloudbake
