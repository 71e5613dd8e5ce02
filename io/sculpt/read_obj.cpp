// Wavefront OBJ: "Advanced Visualizer Manual", appendix B1 (Wavefront, 1995). The lines are scanned here, in one pass: tinyobjloader, which
// reads the material libraries, takes a word that is not a number for 0, does not round correctly, and knows no lines.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>

#include "core/error.h"
#include "core/text/plain_text.h"
#include "core/text/scan.h"
#include "core/vertex_normals.h"
#include "io/sculpt/corner_mesh.h"
#include "io/sculpt/read_mesh.h"
#include "io/sculpt/read_mtl.h"
#include "io/sculpt/triangulate.h"
#include "io/sculpt/vertex_colors.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

constexpr VertexColor kNoColor{0, 0, 0, -1};  // of a position that has none

// What the lines say.
struct ObjData {
  const fs::path& file;
  std::vector<Vec3> positions{}, normals{};
  std::vector<Vec2> uvs{};
  std::vector<VertexColor> colors{};  // of each position; empty if no position has one
  CornerMesh mesh{};                  // corners: position, UV, normal
  std::vector<int> smoothing{};       // of each face: its smoothing group, 0 for none
  int smoothing_group = 0;            // the current one
  uint64_t small_faces = 0;           // faces of fewer than three corners

  // Objects and groups become nodes; a group is a child of its object. A group becomes a node with its first face.
  std::vector<SculptNode> nodes{};
  std::vector<int> object_of_node{};
  std::map<std::pair<int, std::string>, int> known_groups{};  // parent and name → node
  int object = -1;                                            // the current object's node
  std::string group{};                                        // the current group, or nothing
  std::vector<std::string> materials{};                       // in order of first use
  std::map<std::string, int> known_materials{};
  std::string material{};                           // the current material's name, or nothing
  std::optional<int> face_node{}, face_material{};  // of a face here, once one is known
};

// Joins lines that end in a backslash with the next line. Line numbers stay right.
void joinContinuedLines(std::string& text) {
  for (size_t at = text.find('\\'); at != std::string::npos; at = text.find('\\', at + 1)) {
    const size_t end = at + 1 < text.size() && text[at + 1] == '\r' ? at + 2 : at + 1;
    if (end < text.size() && text[end] == '\n') std::fill(text.begin() + std::ptrdiff_t(at), text.begin() + std::ptrdiff_t(end) + 1, ' ');
  }
}

int addNode(ObjData& data, int parent, const std::string& name) {
  const int index = int(data.nodes.size());
  data.nodes.push_back({name, parent, {}});
  data.object_of_node.push_back(parent < 0 ? index : data.object_of_node[size_t(parent)]);
  return index;
}

// Groups of one name and one object are one group.
int groupNamed(ObjData& data, int parent, const std::string& name) {
  const auto [entry, added] = data.known_groups.try_emplace({parent, name}, int(data.nodes.size()));
  if (added) addNode(data, parent, name);
  return entry->second;
}

// The node of a face: its group, else its object, else one that is named after the file. "default" is the format's name for no group.
int currentNode(ObjData& data) {
  if (!data.face_node) {
    if (!data.group.empty() && data.group != "default")
      data.face_node = groupNamed(data, data.object, data.group);
    else
      data.face_node = data.object >= 0 ? data.object : groupNamed(data, -1, data.file.stem().string());
  }
  return *data.face_node;
}

int currentMaterial(ObjData& data) {
  if (!data.face_material && data.material.empty()) data.face_material = -1;
  if (!data.face_material) {
    const auto [entry, added] = data.known_materials.try_emplace(data.material, int(data.materials.size()));
    if (added) data.materials.push_back(data.material);
    data.face_material = entry->second;
  }
  return *data.face_material;
}

void setGroup(ObjData& data, std::string_view names) {
  data.group.clear();
  data.face_node.reset();
  for (std::string_view name = takeWord(names); !name.empty(); name = takeWord(names))
    data.group.append(data.group.empty() ? "" : " ").append(name);
}

// Every `o` begins an object, even if another one has its name.
void setObject(ObjData& data, std::string_view name) {
  data.object = addNode(data, -1, std::string(trimmed(name)));
  data.group.clear();
  data.face_node.reset();
}

// One line, for messages.
struct Line {
  const fs::path& file;
  int number;
  std::string place() const { return file.string() + ":" + std::to_string(number); }
  [[noreturn]] void fail(const std::string& what) const { throw InputError(file.string(), number, what); }
};

// Counts what has no surface of triangles.
void countIgnored(const Line& line, std::string_view key, Warnings& warnings) {
  if (key == "p" || key == "l")
    warnings.add(WarningKind::kPartIgnored, line.place() + ": points and lines have no surface and are ignored");
  for (const char* free_form : {"curv", "curv2", "surf", "vp"})
    if (key == free_form)
      warnings.add(WarningKind::kCurveIgnored, line.place() + ": curves and free-form surfaces are ignored: export them as faces");
  if (key == "usemap" || key == "maplib")
    warnings.add(WarningKind::kTextureIgnored, line.place() + ": '" + std::string(key) + "' is ignored");
}

// The three numbers of v, vn or vt, of which `needed` must be there; the others are 0. `rest` keeps what follows.
Vec3 takeNumbers(const Line& line, std::string_view key, int needed, size_t vertex, std::string_view& rest) {
  std::array<float, 3> numbers{};
  int words = 0;
  for (; words < 3; ++words) {
    const std::string_view word = takeWord(rest);
    if (word.empty()) break;
    const auto number = parseFloat(word);
    if (!number || !std::isfinite(*number))
      line.fail("a coordinate of " + (key == "v" ? "vertex " + std::to_string(vertex) : "this '" + std::string(key) + "'") +
                " is not a finite number (" + quotedWord(word) + "); repair the file");
    numbers[size_t(words)] = *number;
  }
  if (words < needed)
    line.fail("'" + std::string(key) + "' needs " + std::to_string(needed) + " numbers; the file is damaged, export it again");
  return {numbers[0], numbers[1], numbers[2]};
}

// The colour after the coordinates: v x y z r g b.
void addColor(std::string_view rest, ObjData& data) {
  VertexColor color{1, 1, 1, 1};
  for (size_t i = 0; i < 3; ++i) {
    const auto number = parseFloat(takeWord(rest));
    if (!number || !std::isfinite(*number)) return;
    color[i] = *number;
  }
  data.colors.resize(data.positions.size(), kNoColor);
  data.colors.back() = color;
}

// Takes the index before the next slash, and the slash: of an OBJ (from 1, or from the end if negative), converted to one from 0. Nothing,
// and 0, are none where there may be none: −1.
int takeIndex(const Line& line, std::string_view& corner, size_t count, const char* what, bool may_miss) {
  const std::string_view word = corner.substr(0, corner.find('/'));
  corner.remove_prefix(std::min(word.size() + 1, corner.size()));
  const auto raw = parseInteger(word);
  if (may_miss && (word.empty() || raw == 0)) return -1;
  const int64_t index = !raw ? -1 : *raw > 0 ? *raw - 1 : *raw + int64_t(count);
  if (!raw || *raw == 0 || index < 0 || index >= int64_t(count))
    line.fail("a face uses " + std::string(what) + " " + (raw ? std::to_string(*raw) : quotedWord(word)) + " of " + std::to_string(count) +
              "; the file is damaged, export it again");
  return int(index);
}

// v, v/vt, v//vn or v/vt/vn.
Corner readCorner(const Line& line, std::string_view word, const ObjData& data) {
  const std::string_view whole = word;
  Corner corner{-1, -1, -1};
  corner[0] = takeIndex(line, word, data.positions.size(), "vertex", false);
  if (word.empty()) return corner;
  if (std::count(word.begin(), word.end(), '/') > 1)
    line.fail("a corner of a face has more than three indices (" + quotedWord(whole) + "); the file is damaged, export it again");
  corner[1] = takeIndex(line, word, data.uvs.size(), "UV", true);
  if (!word.empty()) corner[2] = takeIndex(line, word, data.normals.size(), "normal", true);
  return corner;
}

void addFace(const Line& line, std::string_view rest, ObjData& data) {
  std::vector<Corner>& corners = data.mesh.corners;
  const size_t first = corners.size();
  for (std::string_view word = takeWord(rest); !word.empty(); word = takeWord(rest)) corners.push_back(readCorner(line, word, data));
  const size_t size = corners.size() - first;
  if (size < 3) {
    corners.resize(first);
    ++data.small_faces;
    return;
  }
  data.mesh.faces.push_back({first, uint32_t(size), currentNode(data), currentMaterial(data)});
  data.smoothing.push_back(data.smoothing_group);
}

// `s 3`, `s off`; some programs write `s on`.
void setSmoothing(ObjData& data, std::string_view rest) {
  const std::string_view word = takeWord(rest);
  data.smoothing_group = int(std::clamp(parseInteger(word).value_or(word == "off" ? 0 : 1), 0LL, 1LL << 30));
}

void readLines(std::string_view text, ObjData& data, Warnings& warnings) {
  LineScanner scanner{text};
  while (const auto found = scanner.next()) {
    std::string_view rest = *found;
    const Line line{data.file, scanner.line};
    const std::string_view key = takeWord(rest);
    if (key == "v") {
      data.positions.push_back(takeNumbers(line, key, 3, data.positions.size(), rest));
      addColor(rest, data);
    } else if (key == "f") {
      addFace(line, rest, data);
    } else if (key == "vn") {
      data.normals.push_back(takeNumbers(line, key, 3, 0, rest));
    } else if (key == "vt") {
      const Vec3 uv = takeNumbers(line, key, 1, 0, rest);
      data.uvs.push_back({uv.x, 1 - uv.y});
    } else if (key == "g") {
      setGroup(data, rest);
    } else if (key == "o") {
      setObject(data, rest);
    } else if (key == "s") {
      setSmoothing(data, rest);
    } else if (key == "usemtl") {
      data.material = trimmed(rest);
      data.face_material.reset();
    } else {
      countIgnored(line, key, warnings);
    }
  }
  if (!data.colors.empty()) data.colors.resize(data.positions.size(), kNoColor);
  decodeVertexColors(data.colors);
}

// Nodes in the order of the file, an object's groups after it, and the materials of a node in order of first use.
std::vector<PartFaces> partsInOrder(const ObjData& data) {
  std::vector<PartFaces> parts = facesOfParts(data.mesh);
  std::stable_sort(parts.begin(), parts.end(), [&](const PartFaces& a, const PartFaces& b) {
    const auto order = [&](const PartFaces& part) { return std::pair(data.object_of_node[size_t(part.node)], part.node); };
    return order(a) < order(b);
  });
  return parts;
}

// Corners without a normal get one, if their smoothing groups say how: that of the surface of the group, or of the face alone if it is in
// none. A file without smoothing groups gets no normals.
void addNormalsOfGroups(ObjData& data) {
  const auto is_smooth = [&](size_t face) {
    const auto corners = data.mesh.cornersOf(face);
    return data.smoothing[face] > 0 && std::any_of(corners.begin(), corners.end(), [](const Corner& corner) { return corner[2] < 0; });
  };
  size_t smooth = 0;
  while (smooth < data.mesh.faces.size() && !is_smooth(smooth)) ++smooth;
  if (smooth == data.mesh.faces.size()) return;

  // A vertex for every position of a group, and for every corner of a face without a group.
  std::unordered_map<uint64_t, uint32_t> known;
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  std::vector<uint32_t> vertices(data.mesh.corners.size());
  for (size_t face = 0; face < data.mesh.faces.size(); ++face) {
    const auto [first, size, node, material] = data.mesh.faces[face];
    for (size_t i = first; i < first + size; ++i) {
      const auto position = size_t(data.mesh.corners[i][0]);
      vertices[i] = uint32_t(positions.size());
      if (data.smoothing[face] > 0)
        vertices[i] = known.try_emplace(uint64_t(data.smoothing[face]) << 32 | position, vertices[i]).first->second;
      if (vertices[i] == positions.size()) positions.push_back(data.positions[position]);
    }
    triangulatePolygon(std::span(vertices).subspan(first, size), positions, triangles);
  }
  const int begin = int(data.normals.size());
  const std::vector<Vec3> normals = vertexNormals(positions, triangles);
  data.normals.insert(data.normals.end(), normals.begin(), normals.end());
  for (size_t i = 0; i < vertices.size(); ++i)
    if (data.mesh.corners[i][2] < 0) data.mesh.corners[i][2] = begin + int(vertices[i]);
}

SculptPart fillPart(const ObjData& data, const PartVertices& vertices, Warnings& warnings) {
  SculptPart part;
  const auto has = [&](int field) {
    return std::any_of(vertices.distinct.begin(), vertices.distinct.end(), [&](const Corner& c) { return c[field] >= 0; });
  };
  const auto has_color = [&](const Corner& c) { return !data.colors.empty() && data.colors[size_t(c[0])][3] >= 0; };
  const bool has_uvs = has(1), has_normals = has(2), colored = std::any_of(vertices.distinct.begin(), vertices.distinct.end(), has_color);
  uint64_t without_uv = 0, without_color = 0;
  for (const Corner& corner : vertices.distinct) {
    part.positions.push_back(data.positions[size_t(corner[0])]);
    if (has_uvs) part.uvs.push_back(corner[1] >= 0 ? data.uvs[size_t(corner[1])] : Vec2{});
    if (has_normals) part.normals.push_back(corner[2] >= 0 ? data.normals[size_t(corner[2])] : Vec3{});
    if (colored) part.colors.push_back(has_color(corner) ? data.colors[size_t(corner[0])] : VertexColor{1, 1, 1, 1});
    without_uv += has_uvs && corner[1] < 0;
    without_color += colored && !has_color(corner);
  }
  warnings.add(WarningKind::kMissingUvSet, data.file.string() + ": some corners have a UV and others have none; the missing UVs are 0",
               without_uv);
  warnings.add(WarningKind::kMissingColor, data.file.string() + ": some vertices have a colour and others have none; these became white",
               without_color);
  return part;
}

}  // namespace

Sculpt readObj(const fs::path& file, const std::string& bytes, const ReadSettings& settings, Warnings& warnings) {
  std::string mended, joined;
  std::string_view text = plainText(bytes, file.string(), mended);
  if (text.find('\0') != text.npos) throw InputError(file.string(), "not an OBJ text (it holds zero bytes); export it again");
  if (text.find('\\') != text.npos) {
    joined = text;
    joinContinuedLines(joined);
    text = joined;
  }
  ObjData data{file};
  // Lines are seldom shorter. What is not used takes no memory, only addresses.
  data.positions.reserve(text.size() / 32), data.mesh.faces.reserve(text.size() / 16), data.mesh.corners.reserve(text.size() / 6);
  readLines(text, data, warnings);
  warnings.add(WarningKind::kDegenerateTriangle, file.string() + ": faces with fewer than three corners were ignored", data.small_faces);

  // With positions only, keep the file's vertices. With UVs or normals, make one vertex per distinct corner.
  const std::vector<Corner>& corners = data.mesh.corners;
  const bool plain = std::all_of(corners.begin(), corners.end(), [](const Corner& c) { return c[1] < 0 && c[2] < 0; });
  addNormalsOfGroups(data);
  const std::vector<PartFaces> parts = partsInOrder(data);
  std::vector<uint32_t> last_of(data.positions.size(), kNobody);
  bool all_kept = parts.size() == 1;
  Sculpt sculpt;
  for (const PartFaces& faces : parts) {
    auto kept = plain ? keptVertices(data.mesh, faces, data.positions.size(), parts.size() == 1) : std::nullopt;
    all_kept = all_kept && kept;
    const PartVertices vertices = kept ? std::move(*kept) : splitCorners(data.mesh, faces, last_of);
    SculptPart part = fillPart(data, vertices, warnings);
    part.name = data.nodes[size_t(faces.node)].name;
    part.node = faces.node;
    part.object = data.object_of_node[size_t(faces.node)];
    part.material = faces.material;
    cutFaces(file, data.mesh, faces, vertices.corners, part, warnings);
    sculpt.parts.push_back(std::move(part));
  }
  if (!all_kept) countUnreferenced(file, data.mesh, data.positions.size(), warnings);
  sculpt.nodes = std::move(data.nodes);
  readMaterials(file, text, data.materials, settings, sculpt, warnings);
  return sculpt;
}

}  // namespace cloudbake
