// Outputs that would replace an input or each other, by any name of the same file, and names that promise another format.
#include "pipeline/options/run_files.h"

#include "tests/io/io_helpers.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;

std::string refusalOfShared(const RunFiles& files) {
  return refusalOf<UsageError>([&] { refuseSharedFiles(files); });
}
std::string sharedBy(const fs::path& input, const fs::path& output) { return refusalOfShared({{{input, "the input"}}, {{output, "-o"}}}); }

TEST(RunFiles, AnOutputIsNotAnInputByAnyName) {
  const TestFolder folder;
  const fs::path sculpt = folder.write("art.obj", kTetrahedronObj);
  fs::create_directory(folder.path / "sub");
  fs::create_symlink(sculpt, folder.path / "link.obj");
  fs::create_symlink("link.obj", folder.path / "link of link.obj");
  fs::create_hard_link(sculpt, folder.path / "hard.obj");
  fs::create_directory_symlink(folder.path, folder.path / "sub" / "up");
  for (const fs::path& other : {sculpt, folder.path / "link.obj", folder.path / "link of link.obj", folder.path / "hard.obj",
                                folder.path / "sub" / ".." / "art.obj", folder.path / "sub" / "up" / "art.obj"})
    EXPECT_TRUE(contains(sharedBy(sculpt, other), "-o would replace the input")) << other;
  EXPECT_EQ(sharedBy(sculpt, folder.path / "art.glb"), "");
  EXPECT_EQ(sharedBy(folder.path / "missing.obj", folder.path / "art.glb"), "");
}

TEST(RunFiles, TwoOutputsAreTwoFiles) {
  const TestFolder folder;
  const auto both = [&](const fs::path& a, const fs::path& b) { return refusalOfShared({{}, {{a, "--html"}, {b, "--json"}}}); };
  EXPECT_TRUE(contains(both(folder.path / "q", folder.path / "." / "q"), "--html and --json would write the same file"));
  EXPECT_TRUE(contains(both(folder.path / "Report", folder.path / "report"), "would write the same file"));
  fs::create_symlink("real", folder.path / "dangling");
  EXPECT_TRUE(contains(both(folder.path / "real", folder.path / "dangling"), "would write the same file"));
  EXPECT_EQ(both(folder.path / "a", folder.path / "b"), "");
  EXPECT_EQ(both("/dev/null", "/dev/null"), "");
  EXPECT_EQ(both(folder.path / "none" / "a", folder.path / "none" / "b"), "");
  EXPECT_NE(both(folder.path / "none" / "a", folder.path / "none" / "a"), "");
}

TEST(RunFiles, OptionsNameWhatTheyReadAndWrite) {
  RunFiles files;
  for (const char* text : {"channels=out/c", "frames=out/f", "scene=s.toml", "json=r.json", "lattice=l.json"})
    addFilesOf(option(text, std::string_view(text).starts_with("lattice") ? kBake : kPreview), files);
  std::string all;
  for (const RunFile& file : files.outputs) all += file.path.string() + file.ending + " ";
  EXPECT_EQ(all,
            "out/c_sun.png out/c_sky.png out/c_opacity.png out/c_depth.png out/f_[0-9][0-9][0-9][0-9].png "
            "out/f_[0-9][0-9][0-9][0-9][0-9].png r.json l.json l.[0-9].ktx2 ");
  std::string of_sets;
  for (const RunFile& file : files.outputs)
    if (file.is_of_set) of_sets += file.path.filename().string() + " ";
  EXPECT_EQ(of_sets, "c_sun.png c_sky.png c_opacity.png c_depth.png f f l ") << "what the user has not spelled out";
  ASSERT_EQ(files.inputs.size(), 1U);
  EXPECT_EQ(files.inputs[0].path, "s.toml");
  RunFiles exr;
  addFilesOf(option("channels=c.exr", kPreview), exr);
  ASSERT_EQ(exr.outputs.size(), 1U);
}

TEST(RunFiles, AFrameMayNotReplaceAnInput) {
  const TestFolder folder;
  const fs::path frame = folder.write("turn_0003.png", "x");
  RunFiles files;
  files.inputs.push_back({frame, "the input"});
  addFilesOf(option("frames=" + (folder.path / "turn").string(), kPreview), files);
  EXPECT_TRUE(contains(refusalOfShared(files), "--frames would replace the input"));
}

TEST(RunFiles, AnOutputIsNoFrameThatIsStillToCome) {
  const TestFolder folder;
  RunFiles frames;
  addFilesOf(option("frames=" + (folder.path / "p").string(), kPreview), frames);
  const auto with = [&](const char* name) {
    RunFiles files = frames;
    files.outputs.push_back({folder.path / name, "-o"});
    return refusalOfShared(files);
  };
  for (const char* name : {"p_0001.png", "P_0002.PNG", "p_10000.png", "./p_0003.png"})
    EXPECT_TRUE(contains(with(name), "--frames and -o would write the same file")) << name;
  for (const char* name : {"p.png", "p_1.png", "q_0001.png", "p_0001.json"}) EXPECT_EQ(with(name), "") << name;
  fs::create_symlink("p_0004.png", folder.path / "link.png");
  EXPECT_NE(with("link.png"), "");
}

TEST(RunFiles, OfASetReplaceOnlyWhatCloudbakeHasWritten) {
  const TestFolder folder;
  const auto refused = [&](const RunFile& output) { return refusalOf<UsageError>([&] { refuseForeignFiles({{}, {output}}); }); };
  const fs::path mine = folder.write("p_0001.png", "mine"), own = folder.write("p_0002.png", "made by cloudbake 0.1.0");
  EXPECT_TRUE(contains(refused({mine, "-o", "", true}), "p_0001.png would be replaced, but cloudbake has not written it"));
  EXPECT_TRUE(contains(refused({folder.path / "p", "--frames", "_[0-9][0-9][0-9][0-9].png", true}), "--frames: "));
  EXPECT_EQ(refused({mine, "-o"}), "") << "the user has spelled it out";
  EXPECT_EQ(refused({own, "-o", "", true}), "");
  EXPECT_EQ(refused({folder.write("empty.png", ""), "-o", "", true}), "");
  EXPECT_EQ(refused({folder.path / "none.png", "-o", "", true}), "");
  fs::create_symlink(mine, folder.path / "link.png");
  EXPECT_NE(refused({folder.path / "link.png", "-o", "", true}), "");
}

TEST(RunFiles, AreNotAmongTheRecordsOfABatch) {
  const TestFolder folder;
  const auto refused = [&](const fs::path& file, const fs::path& output, const fs::path& cache) {
    return refusalOf<UsageError>([&] { refuseRecords({{}, {{file, "--json"}}}, output, cache); });
  };
  const fs::path out = folder.path / "out", records = out / ".cloudbake";
  EXPECT_TRUE(contains(refused(records / "sub" / "r.json", out, {}), "lies among the records of a batch")) << "they are not there yet";
  EXPECT_TRUE(contains(refused(folder.path / "cache" / "r.json", out, folder.path / "cache"), "lies in the folder of --cache"));
  EXPECT_EQ(refused(out / "r.json", out, folder.path / "cache"), "");
  EXPECT_EQ(refused(records / "r.json", {}, {}), "") << "a folder of this name that is no batch's";
  fs::create_directories(records);
  folder.write("out/.cloudbake/lock", "");
  EXPECT_NE(refused(records / "r.json", {}, {}), "") << "the records of another batch";
  fs::create_directory_symlink(records, folder.path / "link");
  EXPECT_NE(refused(folder.path / "link" / "r.json", {}, {}), "");
}

TEST(RunFiles, AreProbedBeforeTheWork) {
  const TestFolder folder;
  const fs::path out = folder.path / "out";
  const auto failure = [&](const fs::path& file, const fs::path& output) {
    return refusalOf<IoError>([&] { probeOutputs({{}, {{file, "--json"}}}, output); });
  };
  EXPECT_TRUE(contains(failure(out / "r.json", {}), "create the folder first"));
  EXPECT_EQ(failure(out / "r.json", out), "") << "the folder will be made";
  EXPECT_EQ(failure(out / "sub" / "r.json", out), "");
  EXPECT_FALSE(fs::exists(out));
  folder.write("file", "x");
  EXPECT_TRUE(contains(failure(folder.path / "r.json", folder.path / "file"), "Not a directory"));
  RunFiles frames;
  addFilesOf(option("frames=" + (out / "p").string(), kPreview), frames);
  EXPECT_TRUE(contains(refusalOf<IoError>([&] { probeOutputs(frames, {}); }), "p_0000.png: cannot write: No such file"));
}

// Brackets in a name that the user gives are no pattern.
TEST(RunFiles, BracketsAreOfTheName) {
  const TestFolder folder;
  const fs::path sculpt = folder.write("x1.obj", kTetrahedronObj);
  EXPECT_EQ(sharedBy(sculpt, folder.path / "x[1].obj"), "");
  const fs::path frame = folder.write("a[1]_0003.png", "x");
  RunFiles files{{{frame, "the input"}}, {}};
  addFilesOf(option("frames=" + (folder.path / "a[1]").string(), kPreview), files);
  EXPECT_TRUE(contains(refusalOfShared(files), "--frames would replace the input"));
  files.inputs = {{folder.write("b_11_0003.png", "x"), "the input"}};
  EXPECT_EQ(refusalOfShared(files), "") << "a frame of another name";
}

TEST(RunFiles, WhatInputsNameIsAnInputToo) {
  const TestFolder folder;
  folder.write("paint.mtl", "newmtl a\n");
  folder.write("rules.txt", "F=FF\n");
  folder.write("art.obj", "mtllib paint.mtl\n" + kTetrahedronObj);
  folder.write("scene.toml", "[[cloud]]\nfile = 'art.obj'\n[other]\nlist = ['rules.txt', 'none.txt']\n");
  RunFiles files{{{folder.path / "scene.toml", "--scene"}}, {{folder.path / "paint.mtl", "-o"}}};
  addNamedFiles(files);
  EXPECT_EQ(files.inputs.size(), 4U);
  EXPECT_TRUE(contains(refusalOfShared(files), "-o would replace a file that")) << refusalOfShared(files);
  RunFiles nothing_there{{{folder.path / "scene.toml", "--scene"}}, {{folder.path / "new.png", "-o"}}};
  addNamedFiles(nothing_there);
  EXPECT_EQ(nothing_there.inputs.size(), 1U) << "nothing can be lost, so nothing is read";
}

TEST(RunFiles, NamesPromiseTheFormat) {
  const auto refused = [](const char* name, const char* extensions) {
    return refusalOf<UsageError>([&] { refuseOtherFormat({name, "-o"}, extensions); });
  };
  for (const char* name : {"x.obj", "x.GLTF", "x.png", "x.vdb", "x.json"})
    EXPECT_TRUE(contains(refused(name, ".glb"), "end the name in .glb")) << name;
  for (const char* name : {"x.glb", "X.GLB", "x", "x.bin", "/dev/null"}) EXPECT_EQ(refused(name, ".glb"), "") << name;
  EXPECT_EQ(refused("x.apng", ".png .apng"), "");
  EXPECT_TRUE(contains(refused("-", ".glb"), "'-' is not a file"));
}

}  // namespace
}  // namespace cloudbake
