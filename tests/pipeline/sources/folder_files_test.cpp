// What of a folder is shown, and what is said of the rest.
#include "pipeline/sources/folder_files.h"

#include "tests/pipeline/pipeline_helpers.h"

namespace cloudbake {
namespace {

using Names = std::vector<std::string>;

Names namesOf(const FolderFiles& found) {
  Names names;
  for (const std::filesystem::path& file : found.files) names.push_back(found.nameOf(file));
  return names;
}

TEST(FolderFiles, AssetsSculptsVolumesAndRecipes) {
  const TestFolder folder;
  std::filesystem::create_directories(folder.path / "b" / ".cloudbake");
  for (const char* name : {"a.obj", "a.GLB", "b/c.vdb", "b/.cloudbake/d.glb", ".e.obj", "f.png", "g.mtl", "h.txt"}) folder.write(name, "x");
  folder.write("recipe.toml", "# mine\npremise = 'F'\n");
  folder.write("manifest.toml", "[[cloud]]\nrules = 'x'\n");
  folder.write("scene.toml", "[camera]\nfov = 40\n");
  const FolderFiles found = filesToShow(folder.path);
  EXPECT_EQ(namesOf(found), (Names{"a.GLB", "a.obj", "b/c.vdb", "recipe.toml"}));
  EXPECT_TRUE(found.unread.empty()) << found.unread.front();
  EXPECT_EQ(found.folders, (std::set<std::filesystem::path>{folder.path, folder.path / "b"}));
}

TEST(FolderFiles, LevelsAreLeftOutBesideTheirAsset) {
  const TestFolder folder;
  for (const char* name : {"a.glb", "a_lod1.glb", "a_lod2.glb", "b_lod1.glb", "a_lodge.glb", "c.obj", "c_lod1.glb"})
    folder.write(name, "x");
  EXPECT_EQ(namesOf(filesToShow(folder.path)), (Names{"a.glb", "a_lodge.glb", "b_lod1.glb", "c.obj", "c_lod1.glb"}));
}

TEST(FolderFiles, NothingToShow) {
  const TestFolder folder;
  expectError<InputError>([&] { filesToShow(folder.path); }, "nothing to show in this folder");
  folder.write("a.MAX", "x");
  expectError<InputError>([&] { filesToShow(folder.path); }, "a.MAX is left out: a 3ds Max scene cannot be read; export");
  expectError<IoError>([&] { filesToShow(folder.path / "none"); }, "cannot read the folder");
}

TEST(FolderFiles, LinesAboutWhatIsNotRead) {
  const std::filesystem::path files[] = {"a.ztl", "b/c.ZTL", ".d.ztl", "e.usd", "f.nvdb", "g.xyzw", "h", "i.jpeg", "j.bin", "k.blend1"};
  EXPECT_EQ(linesAboutUnread(files),
            (Names{"f.nvdb is left out: a NanoVDB volume cannot be read; export the volume as OpenVDB (.vdb)",
                   "e.usd is left out: USD cannot be read; export the sculpt as glTF, FBX or OBJ",
                   "g.xyzw is left out: no reader of sculpts has this ending; if it is a sculpt, export it as glTF, FBX or OBJ",
                   "2 .ztl files are left out (first: a.ztl): a ZBrush project cannot be read; export the sculpt as glTF, FBX or OBJ"}));
}

}  // namespace
}  // namespace cloudbake
