// Each file of an asset is read once, so that its hash and its bake come from the same bytes.
#include "io/file/input_files.h"

#include "tests/io/io_helpers.h"

using namespace cloudbake;

namespace fs = std::filesystem;

namespace {

// Files in memory. A file that is not there cannot be read.
struct Disk {
  std::map<fs::path, std::string> files;
  int reads = 0;
  FileReader reader() {
    return [this](const fs::path& file) {
      ++reads;
      if (!files.contains(file)) throw IoError(file.string(), "cannot read: it is gone");
      return files.at(file);
    };
  }
};

void expectChanged(InputFiles& files, const fs::path& file) {
  try {
    files.read(file);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.code, ExitCode::kTryAgain);
    EXPECT_STREQ(error.what(), (file.string() + ": the file was changed while it was read: run again").c_str());
  }
}

}  // namespace

// What was saved after the first read is not seen, neither when the key is made nor when the asset is.
TEST(InputFiles, KeepTheBytesOfTheFirstRead) {
  Disk disk{{{"a", "old"}, {"b", "old b"}}};
  InputFiles files(disk.reader());
  EXPECT_EQ(files.read("a"), "old");
  disk.files["a"] = "new";
  EXPECT_EQ(files.read("./x/../a"), "old");
  EXPECT_EQ(files.read("b"), "old b");
  disk.files.erase("b");
  files.seal();
  EXPECT_EQ(files.read("a"), "old");
  EXPECT_EQ(files.read("b"), "old b");
  EXPECT_EQ(disk.reads, 2);
  EXPECT_TRUE(files.late().empty());
}

// The bytes are given away once. Whoever wants them again must get the same.
TEST(InputFiles, ASecondReaderGetsTheSameBytesOrAnError) {
  Disk disk{{{"a", "old"}, {"b", "old"}}};
  InputFiles files(disk.reader());
  files.read("a"), files.read("b");
  files.seal();
  files.read("a"), files.read("b");
  EXPECT_EQ(files.read("a"), "old");
  disk.files["a"] = "new";
  expectChanged(files, "a");
  disk.files.erase("b");
  expectChanged(files, "b");
}

TEST(InputFiles, WhatIsMissingStaysMissing) {
  Disk disk;
  InputFiles files(disk.reader());
  expectError<IoError>([&] { files.read("a"); }, "a: cannot read: it is gone");
  disk.files["a"] = "new";
  files.seal();
  expectError<IoError>([&] { files.read("a"); }, "a: cannot read: it is gone");
  EXPECT_TRUE(files.late().empty());
}

TEST(InputFiles, NamesWhatWasReadLate) {
  Disk disk{{{"a", "a"}, {"b", "b"}}};
  InputFiles files(disk.reader());
  files.read("a");
  files.seal();
  EXPECT_EQ(files.read("b"), "b");
  EXPECT_THROW(files.read("c"), IoError);
  EXPECT_EQ(files.late(), std::vector<fs::path>{"b"}) << "a file that is not there has given nothing";
}
