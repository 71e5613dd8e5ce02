// Wavefront OBJ: "Advanced Visualizer Manual", appendix B1 (Wavefront, 1995). tinyobjloader parses the file. It reads a word that is
// not a number as 0 and does not join continued lines, so both are handled here first.
#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <map>
#include <sstream>
#include <unordered_map>

#include "core/error.h"
#include "core/text/scan.h"
#include "io/sculpt/read_mesh.h"
#include "io/sculpt/read_mtl.h"
#include "io/sculpt/triangulate.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// One corner of a face: indices of position, UV and normal; −1 if it has none.
using Corner = std::array<int, 3>;

struct CornerHash {
  size_t operator()(const Corner& c) const {
    uint64_t h = 0;
    for (const int i : c) h = (h ^ uint32_t(i)) * 0x9E3779B97F4A7C15ULL, h ^= h >> 29;
    return size_t(h);
  }
};

using Color = std::array<float, 4>;
constexpr Color kNoColor{0, 0, 0, -1};  // of a position that has none

// A face with at least three corners.
struct Face {
  size_t first = 0;   // its corners are data.corners[first …]
  uint32_t size = 0;  // their number
  int node = 0;
  int material = -1;
};

// Data that the callbacks of tinyobjloader collect.
struct ObjData {
  const fs::path& file;
  std::vector<Vec3> positions{}, normals{};
  std::vector<Vec2> uvs{};
  std::vector<Color> colors{};    // of each position; empty if no position has one
  std::vector<Corner> corners{};  // corners of all faces, one after the other
  std::vector<Face> faces{};
  std::vector<int> face_lines{};  // line of each face
  uint64_t small_faces = 0;       // faces of fewer than three corners
  size_t faces_met = 0;           // faces with corners, of any number

  // Objects and groups become nodes; a group is a child of its object. A group becomes a node with its first face.
  std::vector<SculptNode> nodes{};
  std::vector<int> object_of_node{};
  std::map<std::pair<int, std::string>, int> known_nodes{};  // parent and name → node
  int object = -1;                                           // the current object's node
  std::string group{};                                       // the current group, or nothing
  std::vector<std::string> materials{};                      // in order of first use
  std::map<std::string, int> known_materials{};
  std::string material{};  // the current material's name, or nothing
};

// A carriage return that ends a line alone becomes a line feed, and other control characters between words become blanks, because the
// library and a LineScanner differ about them.
void makeBlanksPlain(std::string& text) {
  for (size_t at = text.find('\r'); at != text.npos; at = text.find('\r', at + 1))
    if (at + 1 == text.size() || text[at + 1] != '\n') text[at] = '\n';
  for (const char odd : {'\v', '\f'})
    for (size_t at = text.find(odd); at != text.npos; at = text.find(odd, at + 1)) text[at] = ' ';
}

// Joins lines that end in a backslash with the next line. Line numbers stay right.
void joinContinuedLines(std::string& text) {
  for (size_t at = text.find('\\'); at != std::string::npos; at = text.find('\\', at + 1)) {
    const size_t end = at + 1 < text.size() && text[at + 1] == '\r' ? at + 2 : at + 1;
    if (end < text.size() && text[end] == '\n') std::fill(text.begin() + std::ptrdiff_t(at), text.begin() + std::ptrdiff_t(end) + 1, ' ');
  }
}

// The colour after the coordinates: v x y z r g b.
void addColor(std::string_view rest, uint64_t vertex, ObjData& data) {
  Color color{1, 1, 1, 1};
  for (size_t i = 0; i < 3; ++i) {
    const auto number = parseFloat(takeWord(rest));
    if (!number || !std::isfinite(*number)) return;
    color[i] = *number;
  }
  data.colors.resize(size_t(vertex), kNoColor);
  data.colors.push_back(color);
}

// Counts what has no surface of triangles.
void countIgnored(const std::string& place, std::string_view key, Warnings& warnings) {
  if (key == "p" || key == "l") warnings.add(WarningKind::kPartIgnored, place + ": points and lines have no surface and are ignored");
  for (const char* free_form : {"curv", "curv2", "surf", "vp"})
    if (key == free_form)
      warnings.add(WarningKind::kCurveIgnored, place + ": curves and free-form surfaces are ignored: export them as faces");
  if (key == "usemap" || key == "maplib") warnings.add(WarningKind::kTextureIgnored, place + ": '" + std::string(key) + "' is ignored");
}

// Checks that every v, vn and vt consists of numbers, and those of v are finite. Collects the line of each face, and colours.
void checkLines(const std::string& text, ObjData& data, Warnings& warnings) {
  LineScanner scanner{text};
  uint64_t vertex = 0;
  while (const auto line = scanner.next()) {
    std::string_view rest = *line;
    const std::string_view key = takeWord(rest);
    if (key == "f") {
      if (takeWord(rest).empty())
        ++data.small_faces;  // the library ignores them
      else
        data.face_lines.push_back(scanner.line);
    }
    if (key.size() > 2 || key == "p" || key == "l" || key == "vp")
      countIgnored(data.file.string() + ":" + std::to_string(scanner.line), key, warnings);
    const size_t needed = key == "v" || key == "vn" ? 3 : key == "vt" ? 1 : 0;
    if (needed == 0) continue;
    size_t words = 0;
    for (std::string_view word = takeWord(rest); !word.empty(); word = takeWord(rest)) {
      ++words;
      const auto number = parseNumber(word);
      if (number && std::isfinite(float(*number))) {
        if (words == 3) break;
        continue;
      }
      const std::string which = key == "v" ? "vertex " + std::to_string(vertex) : "this '" + std::string(key) + "'";
      throw InputError(data.file.string(), scanner.line,
                       "a coordinate of " + which + " is not a finite number ('" + std::string(word.substr(0, 20)) + "'); repair the file");
    }
    if (words < needed)
      throw InputError(data.file.string(), scanner.line,
                       "'" + std::string(key) + "' needs " + std::to_string(needed) + " numbers; the file is damaged, export it again");
    if (key == "v") addColor(rest, vertex++, data);
  }
  if (!data.colors.empty()) data.colors.resize(size_t(vertex), kNoColor);
}

// Converts an OBJ index (from 1, or from the end if negative) to one from 0; −1 if the corner has none.
int resolveIndex(const ObjData& data, int raw, size_t count, const char* what, bool required) {
  if (raw == 0 && !required) return -1;
  const int index = raw > 0 ? raw - 1 : int(count) + raw;
  if (raw == 0 || index < 0 || size_t(index) >= count) {
    const size_t face = data.faces_met;
    throw InputError(data.file.string(), face < data.face_lines.size() ? data.face_lines[face] : 0,
                     "a face uses " + std::string(what) + " " + std::to_string(raw) + " of " + std::to_string(count) +
                         "; the file is damaged, export it again");
  }
  return index;
}

int nodeNamed(ObjData& data, int parent, const std::string& name) {
  const auto [entry, added] = data.known_nodes.try_emplace({parent, name}, int(data.nodes.size()));
  if (added) {
    data.nodes.push_back({name, parent, {}});
    data.object_of_node.push_back(parent < 0 ? entry->second : data.object_of_node[size_t(parent)]);
  }
  return entry->second;
}

// The node of a face: its group, else its object, else one that is named after the file. "default" is the format's name for no group.
int currentNode(ObjData& data) {
  if (!data.group.empty() && data.group != "default") return nodeNamed(data, data.object, data.group);
  return data.object >= 0 ? data.object : nodeNamed(data, -1, data.file.stem().string());
}

int currentMaterial(ObjData& data) {
  if (data.material.empty()) return -1;
  const auto [entry, added] = data.known_materials.try_emplace(data.material, int(data.materials.size()));
  if (added) data.materials.push_back(data.material);
  return entry->second;
}

void setGroup(ObjData& data, const char** names, int count) {
  data.group.clear();
  for (int i = 0; i < count; ++i) data.group += (i > 0 ? " " : "") + std::string(names[i]);
}

void setObject(ObjData& data, const char* name) {
  data.object = nodeNamed(data, -1, std::string(trimmed(name)));
  data.group.clear();
}

void addFace(ObjData& data, const tinyobj::index_t* indices, int count) {
  std::vector<Corner> corners;
  for (int i = 0; i < count; ++i)
    corners.push_back({resolveIndex(data, indices[i].vertex_index, data.positions.size(), "vertex", true),
                       resolveIndex(data, indices[i].texcoord_index, data.uvs.size(), "UV", false),
                       resolveIndex(data, indices[i].normal_index, data.normals.size(), "normal", false)});
  ++data.faces_met;
  if (count < 3) {
    ++data.small_faces;
    return;
  }
  data.faces.push_back({data.corners.size(), uint32_t(count), currentNode(data), currentMaterial(data)});
  data.corners.insert(data.corners.end(), corners.begin(), corners.end());
}

void parseObj(const std::string& text, ObjData& data) {
  tinyobj::callback_t callbacks;
  callbacks.vertex_cb = [](void* user, float x, float y, float z, float) { static_cast<ObjData*>(user)->positions.push_back({x, y, z}); };
  callbacks.normal_cb = [](void* user, float x, float y, float z) { static_cast<ObjData*>(user)->normals.push_back({x, y, z}); };
  callbacks.texcoord_cb = [](void* user, float x, float y, float) { static_cast<ObjData*>(user)->uvs.push_back({x, 1 - y}); };
  callbacks.index_cb = [](void* user, tinyobj::index_t* indices, int count) { addFace(*static_cast<ObjData*>(user), indices, count); };
  callbacks.object_cb = [](void* user, const char* name) { setObject(*static_cast<ObjData*>(user), name); };
  callbacks.group_cb = [](void* user, const char** names, int count) { setGroup(*static_cast<ObjData*>(user), names, count); };
  callbacks.usemtl_cb = [](void* user, const char* name, int) { static_cast<ObjData*>(user)->material = trimmed(name); };
  std::istringstream stream(text);
  std::string warning, error;
  if (!tinyobj::LoadObjWithCallback(stream, callbacks, &data, nullptr, &warning, &error))
    throw InputError(data.file.string(), "not a readable OBJ: " + error + "; export it again");
}

// The faces of one node and one material.
struct PartFaces {
  int node, material;
  std::vector<size_t> faces;
};

// Nodes in the order of the file, an object's groups after it, and the materials of a node in order of first use.
std::vector<PartFaces> facesOfParts(const ObjData& data) {
  std::vector<PartFaces> parts;
  std::map<std::pair<int, int>, size_t> known;
  for (size_t face = 0; face < data.faces.size(); ++face) {
    const auto [entry, added] = known.try_emplace({data.faces[face].node, data.faces[face].material}, parts.size());
    if (added) parts.push_back({data.faces[face].node, data.faces[face].material, {}});
    parts[entry->second].faces.push_back(face);
  }
  std::stable_sort(parts.begin(), parts.end(), [&](const PartFaces& a, const PartFaces& b) {
    const auto order = [&](const PartFaces& part) { return std::pair(data.object_of_node[size_t(part.node)], part.node); };
    return order(a) < order(b);
  });
  return parts;
}

// The vertices of a part: distinct corners of the file, and the part's corners as places in them.
struct PartVertices {
  std::vector<Corner> distinct;
  std::vector<uint32_t> corners;
};

// One vertex per distinct corner, in order of first use.
PartVertices splitCorners(const ObjData& data, const PartFaces& part) {
  PartVertices vertices;
  std::unordered_map<Corner, uint32_t, CornerHash> known;
  for (const size_t face : part.faces)
    for (const Corner& corner : std::span(data.corners).subspan(data.faces[face].first, data.faces[face].size)) {
      const auto [entry, added] = known.try_emplace(corner, uint32_t(vertices.distinct.size()));
      vertices.corners.push_back(entry->second);
      if (added) vertices.distinct.push_back(corner);
    }
  return vertices;
}

// The file's own vertices in their order: all if the file is one part, else those that the part uses.
PartVertices keptVertices(const ObjData& data, const PartFaces& part, bool all) {
  constexpr uint32_t kUnused = UINT32_MAX;
  std::vector<uint32_t> place(data.positions.size(), all ? 0 : kUnused);
  const auto for_each_corner = [&](const auto& body) {
    for (const size_t face : part.faces)
      for (const Corner& corner : std::span(data.corners).subspan(data.faces[face].first, data.faces[face].size)) body(size_t(corner[0]));
  };
  for_each_corner([&](size_t position) { place[position] = 0; });
  PartVertices vertices;
  for (size_t i = 0; i < place.size(); ++i)
    if (place[i] != kUnused) place[i] = uint32_t(vertices.distinct.size()), vertices.distinct.push_back({int(i), -1, -1});
  for_each_corner([&](size_t position) { vertices.corners.push_back(place[position]); });
  return vertices;
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
    if (colored) part.colors.push_back(has_color(corner) ? data.colors[size_t(corner[0])] : Color{1, 1, 1, 1});
    without_uv += has_uvs && corner[1] < 0;
    without_color += colored && !has_color(corner);
  }
  warnings.add(WarningKind::kMissingUvSet, data.file.string() + ": some corners have a UV and others have none; the missing UVs are 0",
               without_uv);
  warnings.add(WarningKind::kMissingColor, data.file.string() + ": some vertices have a colour and others have none; these became white",
               without_color);
  return part;
}

void cutFaces(const ObjData& data, const PartFaces& faces, const std::vector<uint32_t>& corners, SculptPart& part, Warnings& warnings) {
  size_t first = 0;
  uint64_t crossed = 0;
  for (const size_t face : faces.faces) {
    const uint32_t size = data.faces[face].size;
    crossed += !triangulatePolygon(std::span(corners).subspan(first, size), part.positions, part.triangles);
    first += size;
  }
  warnings.add(WarningKind::kDegenerateTriangle, data.file.string() + ": polygons that intersect themselves were cut as a fan", crossed);
}

void countUnreferenced(const ObjData& data, Warnings& warnings) {
  std::vector<bool> used(data.positions.size());
  for (const Corner& corner : data.corners) used[size_t(corner[0])] = true;
  warnings.add(WarningKind::kUnreferencedVertex, data.file.string() + ": positions that no face uses were left out",
               uint64_t(std::count(used.begin(), used.end(), false)));
}

}  // namespace

Sculpt readObj(const fs::path& file, const std::string& bytes, const ReadSettings& settings, Warnings& warnings) {
  if (bytes.find('\0') != std::string::npos)
    throw InputError(file.string(), "not an OBJ text in UTF-8 (it holds zero bytes); save it as UTF-8 or export it again");
  std::string text = bytes;
  makeBlanksPlain(text);
  joinContinuedLines(text);
  ObjData data{file};
  checkLines(text, data, warnings);
  parseObj(text, data);
  if (!data.colors.empty() && data.colors.size() != data.positions.size())
    throw InputError(file.string(), "its lines 'v' cannot be told apart; remove control characters, or export it again");
  warnings.add(WarningKind::kDegenerateTriangle, file.string() + ": faces with fewer than three corners were ignored", data.small_faces);

  // With positions only, keep the file's vertices. With UVs or normals, make one vertex per distinct corner.
  const bool plain = std::all_of(data.corners.begin(), data.corners.end(), [](const Corner& c) { return c[1] < 0 && c[2] < 0; });
  const std::vector<PartFaces> parts = facesOfParts(data);
  Sculpt sculpt;
  for (const PartFaces& faces : parts) {
    const PartVertices vertices = plain ? keptVertices(data, faces, parts.size() == 1) : splitCorners(data, faces);
    SculptPart part = fillPart(data, vertices, warnings);
    part.name = data.nodes[size_t(faces.node)].name;
    part.node = faces.node;
    part.object = data.object_of_node[size_t(faces.node)];
    part.material = faces.material;
    cutFaces(data, faces, vertices.corners, part, warnings);
    sculpt.parts.push_back(std::move(part));
  }
  if (!plain || parts.size() > 1) countUnreferenced(data, warnings);
  sculpt.nodes = std::move(data.nodes);
  readMaterials(file, text, data.materials, settings, sculpt, warnings);
  return sculpt;
}

}  // namespace cloudbake
