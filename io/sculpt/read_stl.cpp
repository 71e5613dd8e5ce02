// STL: "StereoLithography Interface Specification" (3D Systems, 1989). Binary: 80 bytes of title, the number of facets as
// uint32, then per facet a normal, three corners (float32) and two spare bytes; little-endian. ASCII: "vertex x y z" in
// loops of three. Facets share no vertices, so corners at exactly the same position are merged.
#include <cctype>
#include <cstring>

#include "core/distinct_positions.h"
#include "core/error.h"
#include "core/text/plain_text.h"
#include "core/text/scan.h"
#include "io/sculpt/read_mesh.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

constexpr size_t kHeaderBytes = 84, kFacetBytes = 50;

// The corners of all facets, merged. −0 becomes 0.
struct Welder {
  DistinctPositions distinct{0};
  std::vector<Triangle> triangles{};
  uint32_t add(Vec3 p) { return distinct.add({p.x + 0.0F, p.y + 0.0F, p.z + 0.0F}); }
  SculptPart part() && {
    SculptPart part;
    part.positions = std::move(distinct.positions);
    part.triangles = std::move(triangles);
    return part;
  }
};

uint32_t facetCount(const std::string& bytes) {
  uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  return count;
}

SculptPart readBinary(const fs::path& file, const std::string& bytes) {
  const uint64_t count = facetCount(bytes), needed = kHeaderBytes + count * kFacetBytes;
  if (needed > bytes.size())
    throw InputError(file.string(), "the STL claims " + std::to_string(count) + " facets (" + std::to_string(needed) + " bytes) but has " +
                                        std::to_string(bytes.size()) + " bytes; it is truncated, export it again");
  Welder welder{DistinctPositions(count / 2)};  // a closed mesh has about half as many vertices as triangles
  welder.triangles.reserve(count);
  for (uint64_t facet = 0; facet < count; ++facet) {
    float values[9];
    std::memcpy(values, bytes.data() + kHeaderBytes + facet * kFacetBytes + 12, sizeof values);
    Triangle triangle;
    for (int corner = 0; corner < 3; ++corner) {
      const Vec3 p{values[3 * corner], values[3 * corner + 1], values[3 * corner + 2]};
      if (!isFinite(p))
        throw InputError(file.string(), "the position of vertex " + std::to_string(facet * 3 + uint64_t(corner)) + " (facet " +
                                            std::to_string(facet) + ") is not finite; repair the file");
      triangle[corner] = welder.add(p);
    }
    welder.triangles.push_back(triangle);
  }
  return std::move(welder).part();
}

// Words may follow each other in lines of any length.
struct AsciiReader {
  const fs::path& file;
  LineScanner scanner;
  Welder welder{};
  std::vector<uint32_t> loop{};
  uint64_t vertices = 0;
  bool closed = true;

  [[noreturn]] void fail(const std::string& what) const { throw InputError(file.string(), scanner.line, what); }

  float coordinate(std::string_view word) const {
    const auto number = parseFloat(word);
    if (!number || !std::isfinite(*number))
      fail("a coordinate of vertex " + std::to_string(vertices) + " is not a finite number (" + quotedWord(word) + "); repair the file");
    return *number;
  }
  void endLoop() {
    if (loop.size() != 3) fail("a facet has " + std::to_string(loop.size()) + " vertices, but STL allows only triangles; export it again");
    welder.triangles.push_back({loop[0], loop[1], loop[2]});
    loop.clear();
  }
  void readLine(std::string_view rest) {
    for (std::string_view word = takeWord(rest); !word.empty(); word = takeWord(rest)) {
      if (!std::isalpha(static_cast<unsigned char>(word.front()))) continue;  // a number of a normal
      const std::string key = lowerCase(word);
      if (key == "facet" || key == "solid") closed = false;
      if (key == "endsolid") closed = true;
      if (key == "solid" || key == "endsolid") return;  // the rest is a name
      if (key == "endloop") endLoop();
      if (key != "vertex") continue;
      const float x = coordinate(takeWord(rest)), y = coordinate(takeWord(rest)), z = coordinate(takeWord(rest));
      loop.push_back(welder.add({x, y, z}));
      ++vertices;
    }
  }
};

SculptPart readAscii(const fs::path& file, std::string_view text) {
  AsciiReader reader{file, {text}};
  while (const auto line = reader.scanner.next()) reader.readLine(*line);
  if (!reader.closed || !reader.loop.empty()) reader.fail("the STL ends without 'endsolid'; it is truncated, export it again");
  return std::move(reader.welder).part();
}

// Facets with a colour in their two spare bytes: in VisCAM's files bit 15 says that there is one, in those of Magics, whose title has a
// colour of the whole, that there is none.
uint64_t coloredFacets(const std::string& bytes) {
  const bool magics = std::string_view(bytes).substr(0, 80).find("COLOR=") != std::string_view::npos;
  uint64_t colored = 0;
  for (size_t at = kHeaderBytes + kFacetBytes - 1, i = 0; i < facetCount(bytes); ++i, at += kFacetBytes)
    colored += ((static_cast<unsigned char>(bytes[at]) & 0x80U) != 0) != magics;
  return colored;
}

}  // namespace

// The title of a binary file may begin with "solid" too. So a file whose size matches its count is binary; otherwise one that begins with
// "solid", in any case, is text.
SculptPart readStl(const fs::path& file, const std::string& bytes, Warnings& warnings) {
  const bool fits = bytes.size() >= kHeaderBytes && kHeaderBytes + uint64_t(facetCount(bytes)) * kFacetBytes == bytes.size();
  const std::string_view begin = trimmed(withoutByteOrderMark(bytes).substr(0, 100));
  const bool solid = lowerCase(begin.substr(0, 5)) == "solid", wide = bytes.size() > 1 && (bytes[0] == '\xFF' || bytes[0] == '\xFE');
  const bool text = !fits && (wide || (solid && bytes.find('\0') == bytes.npos));
  if (!fits && !text && bytes.find('\0') == bytes.npos)
    throw InputError(file.string(), "not an STL: neither a text that begins with 'solid' nor a binary file; export it again");
  if (!fits && !text && bytes.size() < kHeaderBytes)
    throw InputError(file.string(), "too short for an STL (" + std::to_string(bytes.size()) + " bytes); export it again");
  std::string mended;
  SculptPart part = text ? readAscii(file, plainText(bytes, file.string(), mended)) : readBinary(file, bytes);
  part.name = file.stem().string();
  if (!text) warnings.add(WarningKind::kMaterialIgnored, file.string() + ": the colours of facets are not kept", coloredFacets(bytes));
  return part;
}

}  // namespace cloudbake
