#include "pipeline/options/version.h"

#include <gtest/gtest.h>

#include <cctype>
#include <set>
#include <sstream>

namespace cloudbake {
namespace {

TEST(Version, ALinePerLibraryWithItsNumber) {
  std::istringstream lines(versionText());
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "cloudbake " CLOUDBAKE_VERSION);
  std::set<std::string> names;
  while (std::getline(lines, line)) {
    const size_t blank = line.find(' ');
    ASSERT_NE(blank, std::string::npos) << line;
    if (line == "without CGAL" || line == "rays by cloudbake's own tree") continue;
    EXPECT_TRUE(names.insert(line.substr(0, blank)).second) << line;
    EXPECT_TRUE(blank + 1 < line.size() && std::isdigit(static_cast<unsigned char>(line[blank + 1]))) << line;
  }
  for (const char* name : {"OpenVDB", "oneTBB", "assimp", "meshoptimizer", "Highway", "toml++", "CLI11", "cpp-httplib", "xxHash"})
    EXPECT_TRUE(names.contains(name)) << name;
#ifdef CLOUDBAKE_PORTABLE
  EXPECT_FALSE(names.contains("Embree"));
  EXPECT_NE(versionText().find("\nrays by cloudbake's own tree"), std::string::npos);
#else
  EXPECT_TRUE(names.contains("Embree"));
#endif
}

}  // namespace
}  // namespace cloudbake
