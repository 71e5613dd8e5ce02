// The mesh of a PLY: an element "vertex" with positions, normals, UVs and colours, and an element "face" with a list of corners. Names of
// properties are those that Blender, MeshLab, Houdini and assimp write. What is rarer (materials, UVs of corners) is left to assimp.
#include <algorithm>
#include <array>

#include "core/error.h"
#include "io/sculpt/ply_header.h"
#include "io/sculpt/read_mesh.h"
#include "io/sculpt/triangulate.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

using Names = std::array<std::string_view, 4>;
constexpr std::array<Names, 3> kPosition{{{"x"}, {"y"}, {"z"}}}, kNormal{{{"nx"}, {"ny"}, {"nz"}}},
    kColor{{{"red", "r", "diffuse_red"}, {"green", "g", "diffuse_green"}, {"blue", "b", "diffuse_blue"}}};
constexpr std::array<Names, 2> kUv{{{"u", "s", "texture_u", "tx"}, {"v", "t", "texture_v", "ty"}}};
constexpr std::array<Names, 1> kAlpha{{{"alpha"}}}, kCorners{{{"vertex_indices", "vertex_index"}}};

// The places of the named properties in an element; nothing unless all are there. `list`: whether they are lists.
template <size_t kCount>
std::optional<std::array<size_t, kCount>> columnsOf(const PlyElement& element, const std::array<Names, kCount>& names, bool list = false) {
  std::array<size_t, kCount> columns{};
  for (size_t i = 0; i < kCount; ++i) {
    const auto found = std::find_if(element.properties.begin(), element.properties.end(), [&](const PlyProperty& property) {
      return !property.name.empty() && property.length_type.has_value() == list &&
             std::find(names[i].begin(), names[i].end(), property.name) != names[i].end();
    });
    if (found == element.properties.end()) return std::nullopt;
    columns[i] = size_t(found - element.properties.begin());
  }
  return columns;
}

// Whole numbers stand for 0 to 1.
float largestColor(PlyType type) {
  if (type == PlyType::kUint8) return 255;
  if (type == PlyType::kUint16) return 65535;
  return 1;
}

// Reads one element after the other into a part.
struct PlyReader {
  PlyInput input;
  const PlyHeader header;
  SculptPart& part;
  std::vector<std::string_view> cells{};
  uint64_t flat = 0, crossed = 0;

  int line() const { return header.format == PlyFormat::kText ? input.scanner.line : 0; }

  template <size_t kCount>
  std::array<float, kCount> numbers(const PlyElement& element, uint64_t row, const std::array<size_t, kCount>& columns) const {
    std::array<float, kCount> values{};
    for (size_t i = 0; i < kCount; ++i) {
      const auto number = plyNumber(cells[columns[i]], element.properties[columns[i]].type, header.format);
      if (!number)
        throw InputError(
            input.file.string(), line(),
            "a value of vertex " + std::to_string(row) + " is not a number (" + quotedWord(cells[columns[i]]) + "); repair the file");
      values[i] = *number;
    }
    return values;
  }

  void readVertices(const PlyElement& element) {
    const auto position = columnsOf(element, kPosition), normal = columnsOf(element, kNormal), color = columnsOf(element, kColor);
    const auto uv = columnsOf(element, kUv);
    const auto alpha = columnsOf(element, kAlpha);
    if (!position) throw InputError(input.file.string(), element.line, "the vertices have no x, y and z; export the file again");
    for (uint64_t row = 0; row < element.rows; ++row) {
      takePlyRow(input, header.format, element, row, cells);
      const auto p = numbers(element, row, *position);
      part.positions.push_back({p[0], p[1], p[2]});
      if (normal) {
        const auto n = numbers(element, row, *normal);
        part.normals.push_back({n[0], n[1], n[2]});
      }
      if (uv) {
        const auto t = numbers(element, row, *uv);
        part.uvs.push_back({t[0], 1 - t[1]});
      }
      if (color) {
        const auto c = numbers(element, row, *color);
        const auto scaled = [&](float value, size_t column) { return value / largestColor(element.properties[column].type); };
        part.colors.push_back({scaled(c[0], (*color)[0]), scaled(c[1], (*color)[1]), scaled(c[2], (*color)[2]),
                               alpha ? scaled(numbers(element, row, *alpha)[0], (*alpha)[0]) : 1});
      }
    }
  }

  // Polygons, or strips of triangles: every corner after the first two makes a triangle with the two before it, turned every other time,
  // and −1 begins a new strip (Stanford's scans have them).
  void readFaces(const PlyElement& element, bool strips) {
    const auto list = columnsOf(element, kCorners, true);
    if (!list) throw InputError(input.file.string(), element.line, "the faces have no list vertex_indices; export the file again");
    const PlyProperty& property = element.properties[(*list)[0]];
    std::vector<uint32_t> corners;
    for (uint64_t row = 0; row < element.rows; ++row) {
      takePlyRow(input, header.format, element, row, cells);
      corners.clear();
      for (std::string_view values = cells[(*list)[0]]; !values.empty();) {
        const std::string_view value = takePlyValue(values, property.type, header.format);
        const auto index = plyIndex(value, property.type, header.format);
        if (strips && index == -1) {
          addStrip(corners);
          corners.clear();
          continue;
        }
        if (!index || *index < 0 || uint64_t(*index) >= part.positions.size())
          throw InputError(input.file.string(), line(),
                           "face " + std::to_string(row) + " uses vertex " + (index ? std::to_string(*index) : vertexText(value)) + " of " +
                               std::to_string(part.positions.size()) + "; the file is damaged, export it again");
        corners.push_back(uint32_t(*index));
      }
      if (strips)
        addStrip(corners);
      else if (corners.size() < 3)
        ++flat;
      else
        crossed += !triangulatePolygon(corners, part.positions, part.triangles);
    }
  }

  // A value that is no index. The bytes of a float are no text.
  std::string vertexText(std::string_view value) const { return header.format == PlyFormat::kText ? quotedWord(value) : "(a fraction)"; }

  void addStrip(const std::vector<uint32_t>& corners) {
    for (size_t i = 2; i < corners.size(); ++i) {
      const size_t turned = i % 2;
      const Triangle triangle{corners[i - 2 + turned], corners[i - 1 - turned], corners[i]};
      const auto [a, b, c] = triangle;
      if (a != b && b != c && c != a) part.triangles.push_back(triangle);  // others only join strips
    }
  }
};

}  // namespace

bool isPlainPly(const fs::path& file, const std::string& bytes) {
  PlyInput input{file, bytes, {bytes}};
  const PlyHeader header = readPlyHeader(input);
  return std::none_of(header.elements.begin(), header.elements.end(), [](const PlyElement& element) {
    const bool more_lists = std::count_if(element.properties.begin(), element.properties.end(),
                                          [](const PlyProperty& property) { return property.length_type.has_value(); }) > 1;
    return element.name == "material" || (element.name == "face" && more_lists);
  });
}

void checkPly(const fs::path& file, const std::string& bytes) {
  PlyInput input{file, bytes, {bytes}};
  const PlyHeader header = readPlyHeader(input);
  std::vector<std::string_view> cells;
  for (const PlyElement& element : header.elements)
    for (uint64_t row = 0; row < element.rows; ++row) takePlyRow(input, header.format, element, row, cells);
}

SculptPart readPly(const fs::path& file, const std::string& bytes, Warnings& warnings) {
  PlyInput input{file, bytes, {bytes}};
  PlyHeader header = readPlyHeader(input);
  SculptPart part;
  part.name = file.stem().string();
  PlyReader reader{input, std::move(header), part};
  for (const PlyElement& element : reader.header.elements) {
    if (element.name == "vertex")
      reader.readVertices(element);
    else if (element.name == "face" || element.name == "tristrips")
      reader.readFaces(element, element.name == "tristrips");
    else
      for (uint64_t row = 0; row < element.rows; ++row) takePlyRow(reader.input, reader.header.format, element, row, reader.cells);
  }
  warnings.add(WarningKind::kPartIgnored, file.string() + ": points and lines have no surface and were ignored", reader.flat);
  warnings.add(WarningKind::kDegenerateTriangle, file.string() + ": polygons that intersect themselves were cut as a fan", reader.crossed);
  return part;
}

}  // namespace cloudbake
