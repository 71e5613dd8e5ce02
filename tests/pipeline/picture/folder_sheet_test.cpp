// A sheet has a panel per file of a folder, also for files that cannot be shown.
#include "pipeline/picture/folder_sheet.h"

#include <nlohmann/json.hpp>

#include "pipeline/picture/picture.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

TEST(FolderSheet, HasAsManyColumnsAsRowsOrOneMore) {
  EXPECT_EQ(sheetColumns(1), 1);
  EXPECT_EQ(sheetColumns(2), 2);
  EXPECT_EQ(sheetColumns(6), 3);
  EXPECT_EQ(sheetColumns(7), 3);
  EXPECT_EQ(sheetColumns(1000), 8);
}

TEST(FolderSheet, APanelForEachFile) {
  const TestFolder folder;
  folder.write("ball.obj", objText(ballMesh(1, 2)));
  folder.write("broken.ply", "ply\n");
  const std::vector<Given> given = options({"size=48x32", "look=plain"}, kPreview);
  Settings settings = resolve(sourceOf(SourceKind::kSculpt, folder.path), given);
  BakeReport report;
  Stopwatch watch;
  const FolderSheet drawn = drawFolder(filesToShow(folder.path), settings, given, report, watch);
  ASSERT_EQ(drawn.panels.size(), 2U);
  EXPECT_EQ(drawn.panels[0].name, "ball.obj");
  EXPECT_EQ(drawn.panels[0].kind, "sculpt");
  EXPECT_EQ(drawn.panels[0].code, 0);
  EXPECT_EQ(drawn.panels[0].vertices, ballMesh(1, 2).positions.size());
  EXPECT_EQ(drawn.panels[1].code, int(ExitCode::kInput));
  EXPECT_NE(drawn.panels[1].error.find("broken.ply:"), std::string::npos);
  EXPECT_EQ(drawn.failures(), 1U);
  EXPECT_GE(drawn.sheet.width, 2 * 48);
  EXPECT_EQ(folderJson(drawn)[1]["code"], int(ExitCode::kInput));
  // The ball is the picture that `preview` draws of it.
  settings.source.input = folder.path / "ball.obj";
  StageSeconds seconds;
  const Image alone = stillPicture(bakeScenery(settings, given, report), seconds);
  size_t found = 0;
  for (int y = 0; y + alone.height <= drawn.sheet.height; ++y)
    for (int x = 0; x + alone.width <= drawn.sheet.width; ++x) {
      bool same = true;
      for (int v = 0; v < alone.height && same; ++v)
        for (int u = 0; u < alone.width && same; ++u) same = drawn.sheet.at(x + u, y + v) == alone.at(u, v);
      found += same;
    }
  EXPECT_EQ(found, 1U);
}

}  // namespace
}  // namespace cloudbake
