#include "io/file/zip.h"

#include <gtest/gtest.h>

#include "tests/io/zip_helpers.h"

using namespace cloudbake;

namespace {

const std::string kLong(100000, 'a');
const std::string kZip = zipOf({{"a/stored", "some text"}, {"a/packed", kLong}, {"empty", ""}});

}  // namespace

TEST(Zip, FindsStoredAndDeflatedFiles) {
  EXPECT_EQ(fileInZip(kZip, "a/stored", 1 << 20), "some text");
  EXPECT_EQ(fileInZip(kZip, "a/packed", 1 << 20), kLong);
  EXPECT_EQ(fileInZip(kZip, "empty", 1 << 20), "");
  EXPECT_EQ(fileInZip(kZip, "a", 1 << 20), std::nullopt);
  EXPECT_EQ(fileInZip(kZip + "", "a/packed", kLong.size() - 1), std::nullopt) << "over the limit";
}

TEST(Zip, DamagedArchivesAreReadOrRefused) {
  const auto attempt = [](const std::string& zip) {
    const std::vector<char> exact(zip.begin(), zip.end());  // a sanitizer sees a read behind its end
    for (const char* name : {"a/stored", "a/packed"})
      EXPECT_LE(fileInZip({exact.data(), exact.size()}, name, 1 << 20).value_or("").size(), 1U << 20);
  };
  for (size_t size = 0; size < kZip.size(); ++size) attempt(kZip.substr(0, size));
  for (size_t at = 0; at < kZip.size(); ++at)
    for (const char c : {'\0', '\1', '\x7F', '\xFF'}) {
      std::string changed = kZip;
      changed[at] = c;
      attempt(changed);
    }
}
