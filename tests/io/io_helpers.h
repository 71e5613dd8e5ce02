// A folder of its own for each test, and a tetrahedron in every format.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.h"
#include "core/types.h"

namespace cloudbake {

/// An empty folder that lives as long as this.
struct TestFolder {
  std::filesystem::path path;
  TestFolder() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string("cloudbake_") + info->test_suite_name() + "_" + info->name() + "_XXXXXX";
    for (char& c : name) c = c == '/' ? '_' : c;
    std::string pattern = (std::filesystem::temp_directory_path() / name).string();
    if (!mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
    path = pattern;
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  ~TestFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::filesystem::remove(path / name);  // writing over a file makes some file systems wait for the disk
    std::ofstream(path / name, std::ios::binary) << bytes;
    return path / name;
  }
};

/// The error that `run` throws, which must be a `Kind` and hold `text`.
template <typename Kind, typename Run>
void expectError(Run run, const std::string& text) {
  try {
    run();
    ADD_FAILURE() << "nothing was thrown; expected: " << text;
  } catch (const Kind& error) {
    EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    EXPECT_TRUE(error.message.find_first_of(";:") != std::string::npos || error.message.find(" must be ") != std::string::npos)
        << "no cure in: " << error.what();
  }
}

// A tetrahedron whose triangles face outwards: volume 1/6.
inline const std::string kTetrahedronObj = "# a tetrahedron\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// Signed volume of a closed mesh: Σ a·(b×c)/6.
inline double signedVolume(const std::vector<Vec3>& p, const std::vector<Triangle>& triangles) {
  double sum = 0;
  for (const Triangle& t : triangles) {
    const Vec3 a = p[t[0]], b = p[t[1]], c = p[t[2]];
    sum += double(a.x) * (double(b.y) * c.z - double(b.z) * c.y) + double(a.y) * (double(b.z) * c.x - double(b.x) * c.z) +
           double(a.z) * (double(b.x) * c.y - double(b.y) * c.x);
  }
  return sum / 6;
}

}  // namespace cloudbake
