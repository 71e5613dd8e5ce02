// Wavefront OBJ: "Advanced Visualizer Manual", appendix B1 (Wavefront, 1995). tinyobjloader parses the file. It reads a word that is
// not a number as 0 and does not join continued lines, so both are handled here first.
#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <unordered_map>

#include "core/error.h"
#include "core/text/scan.h"
#include "io/sculpt/read_mesh.h"
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

// Data that the callbacks of tinyobjloader collect.
struct ObjData {
  const fs::path& file;
  std::vector<Vec3> positions, normals;
  std::vector<Vec2> uvs;
  std::vector<Corner> corners;       // corners of all faces, one after the other
  std::vector<uint32_t> face_sizes;  // corners per face
  std::vector<int> face_lines;       // line of each face
  uint64_t small_faces = 0;          // faces of fewer than three corners
  size_t faces_met = 0;              // faces with corners, of any number
};

// Joins lines that end in a backslash with the next line. Line numbers stay right.
std::string joinContinuedLines(std::string text) {
  for (size_t at = text.find('\\'); at != std::string::npos; at = text.find('\\', at + 1)) {
    const size_t end = at + 1 < text.size() && text[at + 1] == '\r' ? at + 2 : at + 1;
    if (end < text.size() && text[end] == '\n') std::fill(text.begin() + std::ptrdiff_t(at), text.begin() + std::ptrdiff_t(end) + 1, ' ');
  }
  return text;
}

// Checks that every v, vn and vt consists of numbers, and those of v are finite. Collects the line of each face.
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
    if (key == "p" || key == "l")
      warnings.add(WarningKind::kPartIgnored,
                   data.file.string() + ":" + std::to_string(scanner.line) + ": points and lines have no surface and are ignored");
    const size_t needed = key == "v" || key == "vn" ? 3 : key == "vt" ? 1 : 0;
    if (needed == 0) continue;
    size_t words = 0;
    for (std::string_view word = takeWord(rest); !word.empty() && words < 3; word = takeWord(rest), ++words) {
      const auto number = parseNumber(word);
      if (number && std::isfinite(float(*number))) continue;
      const std::string which = key == "v" ? "vertex " + std::to_string(vertex) : "this '" + std::string(key) + "'";
      throw InputError(data.file.string(), scanner.line,
                       "a coordinate of " + which + " is not a finite number ('" + std::string(word.substr(0, 20)) + "'); repair the file");
    }
    if (words < needed)
      throw InputError(data.file.string(), scanner.line,
                       "'" + std::string(key) + "' needs " + std::to_string(needed) + " numbers; the file is damaged, export it again");
    vertex += key == "v";
  }
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
  data.corners.insert(data.corners.end(), corners.begin(), corners.end());
  data.face_sizes.push_back(uint32_t(count));
}

void parseObj(const std::string& text, ObjData& data) {
  tinyobj::callback_t callbacks;
  callbacks.vertex_cb = [](void* user, float x, float y, float z, float) { static_cast<ObjData*>(user)->positions.push_back({x, y, z}); };
  callbacks.normal_cb = [](void* user, float x, float y, float z) { static_cast<ObjData*>(user)->normals.push_back({x, y, z}); };
  callbacks.texcoord_cb = [](void* user, float x, float y, float) { static_cast<ObjData*>(user)->uvs.push_back({x, 1 - y}); };
  callbacks.index_cb = [](void* user, tinyobj::index_t* indices, int count) { addFace(*static_cast<ObjData*>(user), indices, count); };
  std::istringstream stream(text);
  std::string warning, error;
  if (!tinyobj::LoadObjWithCallback(stream, callbacks, &data, nullptr, &warning, &error))
    throw InputError(data.file.string(), "not a readable OBJ: " + error + "; export it again");
}

// Makes one vertex per distinct corner, in order of first use.
SculptPart splitCorners(const ObjData& data, std::vector<uint32_t>& vertices, Warnings& warnings) {
  SculptPart part;
  const auto has = [&](int field) {
    return std::any_of(data.corners.begin(), data.corners.end(), [&](const Corner& c) { return c[field] >= 0; });
  };
  const bool has_uvs = has(1), has_normals = has(2);
  std::unordered_map<Corner, uint32_t, CornerHash> known;
  std::vector<bool> used(data.positions.size());
  uint64_t without_uv = 0;
  for (const Corner& corner : data.corners) {
    const auto [entry, added] = known.try_emplace(corner, uint32_t(part.positions.size()));
    vertices.push_back(entry->second);
    if (!added) continue;
    used[size_t(corner[0])] = true;
    part.positions.push_back(data.positions[size_t(corner[0])]);
    if (has_uvs) part.uvs.push_back(corner[1] >= 0 ? data.uvs[size_t(corner[1])] : Vec2{});
    if (has_normals) part.normals.push_back(corner[2] >= 0 ? data.normals[size_t(corner[2])] : Vec3{});
    without_uv += has_uvs && corner[1] < 0;
  }
  warnings.add(WarningKind::kMissingUvSet, data.file.string() + ": some corners have a UV and others have none; the missing UVs are 0",
               without_uv);
  warnings.add(WarningKind::kUnreferencedVertex, data.file.string() + ": positions that no face uses were left out",
               uint64_t(std::count(used.begin(), used.end(), false)));
  return part;
}

}  // namespace

SculptPart readObj(const fs::path& file, const std::string& bytes, Warnings& warnings) {
  if (bytes.find('\0') != std::string::npos)
    throw InputError(file.string(), "not an OBJ text in UTF-8 (it holds zero bytes); save it as UTF-8 or export it again");
  const std::string text = bytes.find('\\') == std::string::npos ? bytes : joinContinuedLines(bytes);
  ObjData data{file, {}, {}, {}, {}, {}, {}, 0};
  checkLines(text, data, warnings);
  parseObj(text, data);
  warnings.add(WarningKind::kDegenerateTriangle, file.string() + ": faces with fewer than three corners were ignored", data.small_faces);

  // With positions only, keep the file's vertices. With UVs or normals, make one vertex per distinct corner.
  const bool plain = std::all_of(data.corners.begin(), data.corners.end(), [](const Corner& c) { return c[1] < 0 && c[2] < 0; });
  std::vector<uint32_t> vertices;
  SculptPart part;
  if (plain) {
    for (const Corner& corner : data.corners) vertices.push_back(uint32_t(corner[0]));
    part.positions = std::move(data.positions);
  } else {
    part = splitCorners(data, vertices, warnings);
  }
  part.name = file.stem().string();

  size_t first = 0;
  uint64_t crossed = 0;
  for (const uint32_t size : data.face_sizes) {
    crossed += !triangulatePolygon(std::span(vertices).subspan(first, size), part.positions, part.triangles);
    first += size;
  }
  warnings.add(WarningKind::kDegenerateTriangle, file.string() + ": polygons that intersect themselves were cut as a fan", crossed);
  return part;
}

}  // namespace cloudbake
