// STL: "StereoLithography Interface Specification" (3D Systems, 1989). Binary: 80 bytes of title, the number of facets as
// uint32, then per facet a normal, three corners (float32) and two spare bytes; little-endian. ASCII: "vertex x y z" in
// loops of three. Facets share no vertices, so corners at exactly the same position are merged.
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
  DistinctPositions distinct;
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

SculptPart readAscii(const fs::path& file, std::string_view text) {
  Welder welder;
  LineScanner scanner{text};
  std::vector<uint32_t> loop;
  bool closed = true;
  for (uint64_t vertex = 0; const auto line = scanner.next();) {
    std::string_view rest = *line;
    const std::string key = lowerCase(takeWord(rest));
    if (key == "facet" || key == "solid") closed = false;
    if (key == "endsolid") closed = true;
    if (key == "endloop") {
      if (loop.size() != 3)
        throw InputError(file.string(), scanner.line,
                         "a facet has " + std::to_string(loop.size()) + " vertices, but STL allows only triangles; export it again");
      welder.triangles.push_back({loop[0], loop[1], loop[2]});
      loop.clear();
    }
    if (key != "vertex") continue;
    float xyz[3];
    for (float& value : xyz) {
      const std::string_view word = takeWord(rest);
      const auto number = parseFloat(word);
      if (!number || !std::isfinite(*number))
        throw InputError(
            file.string(), scanner.line,
            "a coordinate of vertex " + std::to_string(vertex) + " is not a finite number (" + quotedWord(word) + "); repair the file");
      value = *number;
    }
    loop.push_back(welder.add({xyz[0], xyz[1], xyz[2]}));
    ++vertex;
  }
  if (!closed || !loop.empty())
    throw InputError(file.string(), scanner.line, "the STL ends without 'endsolid'; it is truncated, export it again");
  return std::move(welder).part();
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
  const std::string_view title = std::string_view(bytes).substr(0, 80);
  warnings.add(WarningKind::kMaterialIgnored, file.string() + ": the colours of facets are not kept",
               !text && title.find("COLOR=") != title.npos);
  return part;
}

}  // namespace cloudbake
