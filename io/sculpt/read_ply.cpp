// The mesh of a PLY: an element "vertex" with positions, normals, UVs and colours, and an element "face" with a list of corners, UVs of the
// corners, colours and materials, in any order. Names of properties are those that Blender, MeshLab, Houdini, assimp and three.js write.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <span>
#include <unordered_map>

#include "core/error.h"
#include "io/sculpt/corner_mesh.h"
#include "io/sculpt/ply_header.h"
#include "io/sculpt/read_mesh.h"
#include "io/sculpt/sculpt_images.h"
#include "io/sculpt/vertex_colors.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

using Names = std::array<std::string_view, 4>;
constexpr std::array<Names, 3> kPosition{{{"x"}, {"y"}, {"z"}}}, kNormal{{{"nx"}, {"ny"}, {"nz"}}},
    kColor{{{"red", "r", "diffuse_red"}, {"green", "g", "diffuse_green"}, {"blue", "b", "diffuse_blue"}}};
constexpr std::array<Names, 2> kUv{{{"u", "s", "texture_u", "tx"}, {"v", "t", "texture_v", "ty"}}};
constexpr std::array<Names, 1> kAlpha{{{"alpha", "a", "diffuse_alpha"}}}, kCorners{{{"vertex_indices", "vertex_index"}}},
    kCornerUvs{{{"texcoord"}}}, kImageNumber{{{"texnumber"}}}, kMaterialIndex{{{"material_index", "material_indices"}}},
    kShininess{{{"specular_power"}}}, kOpacity{{{"opacity"}}};

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

std::optional<size_t> columnOf(const PlyElement& element, const std::array<Names, 1>& names, bool list = false) {
  const auto columns = columnsOf(element, names, list);
  return columns ? std::optional((*columns)[0]) : std::nullopt;
}

// The colours of an element, as the file has them.
struct ColorColumns {
  std::optional<std::array<size_t, 3>> rgb;
  std::optional<size_t> alpha;
  std::array<PlyType, 4> types{};
  std::vector<VertexColor> values{};

  explicit ColorColumns(const PlyElement& element) : rgb(columnsOf(element, kColor)), alpha(columnOf(element, kAlpha)) {
    for (size_t i = 0; rgb && i < 3; ++i) types[i] = element.properties[(*rgb)[i]].type;
    if (alpha) types[3] = element.properties[*alpha].type;
  }

  // Linear colours. Bytes run to 255; the largest number of a column says how far those of other types run.
  std::vector<VertexColor> decoded() && {
    for (size_t i = 0; i < (alpha ? 4 : 3); ++i) {
      float largest = types[i] == PlyType::kUint8 ? 255 : 0;
      for (size_t k = 0; k < (i < 3 ? 3 : 4); ++k)  // of the columns of one type
        for (const VertexColor& color : values)
          if (types[k] == types[i]) largest = std::fmax(largest, color[k]);
      for (VertexColor& color : values) color[i] /= fullColor(largest);
    }
    decodeVertexColors(values, 1);
    return std::move(values);
  }
};

// Values that corners share, each once, in order of first use.
struct UvTable {
  std::vector<Vec2> values{};
  std::unordered_map<uint64_t, int> known{};
  int add(Vec2 uv) {
    const uint64_t bits = uint64_t(std::bit_cast<uint32_t>(uv.x + 0.0F)) << 32 | std::bit_cast<uint32_t>(uv.y + 0.0F);
    const auto [entry, added] = known.try_emplace(bits, int(values.size()));
    if (added) values.push_back(uv);
    return entry->second;
  }
};

// Reads one element after the other.
struct PlyReader {
  PlyInput input;
  const PlyHeader header;
  Warnings& warnings;
  std::vector<std::string_view> cells{};  // of the row
  std::vector<int> indices{};             // of the row's list

  std::vector<Vec3> positions{}, normals{};
  std::vector<Vec2> uvs{};
  std::vector<VertexColor> colors{}, face_colors{};
  CornerMesh mesh{};  // corners: position, UV of the corner, colour of the face
  UvTable corner_uvs{};
  std::vector<SculptMaterial> materials{};
  uint64_t flat = 0, odd_uvs = 0, odd_images = 0;

  std::string file() const { return input.file.string(); }
  int line() const { return header.format == PlyFormat::kText ? input.scanner.line : 0; }
  [[noreturn]] void fail(const std::string& what) const { throw InputError(file(), line(), what); }

  float number(const PlyElement& element, uint64_t row, size_t column) const {
    const auto number = plyNumber(cells[column], element.properties[column].type, header.format);
    if (!number)
      fail("a value of " + element.name + " " + std::to_string(row) + " is not a number (" + quotedWord(cells[column]) +
           "); repair the file");
    return *number;
  }
  template <size_t kCount>
  std::array<float, kCount> numbers(const PlyElement& element, uint64_t row, const std::array<size_t, kCount>& columns) const {
    std::array<float, kCount> values{};
    for (size_t i = 0; i < kCount; ++i) values[i] = number(element, row, columns[i]);
    return values;
  }
  float finiteNumber(const PlyElement& element, uint64_t row, size_t column) const {
    const float value = number(element, row, column);
    if (!std::isfinite(value)) fail("a value of " + element.name + " " + std::to_string(row) + " is not finite; repair the file");
    return value;
  }
  VertexColor color(const PlyElement& element, uint64_t row, const ColorColumns& columns) const {
    const auto value = [&](size_t column) { return finiteNumber(element, row, column); };
    const auto& [red, green, blue] = *columns.rgb;
    return {value(red), value(green), value(blue), columns.alpha ? value(*columns.alpha) : 1};
  }
  // A number of a list that the file has elsewhere; −1 if it can be none.
  int place(const PlyElement& element, uint64_t row, size_t column) const {
    const float value = finiteNumber(element, row, column);
    return value >= 0 && value < 1e6F ? int(value) : -1;
  }

  void readVertices(const PlyElement& element) {
    const auto position = columnsOf(element, kPosition), normal = columnsOf(element, kNormal);
    const auto uv = columnsOf(element, kUv);
    ColorColumns of_vertices(element);
    if (!position) throw InputError(file(), element.line, "the vertices have no x, y and z; export the file again");
    for (uint64_t row = 0; row < element.rows; ++row) {
      takePlyRow(input, header.format, element, row, cells);
      const auto p = numbers(element, row, *position);
      positions.push_back({p[0], p[1], p[2]});
      if (normal) {
        const auto n = numbers(element, row, *normal);
        normals.push_back({n[0], n[1], n[2]});
      }
      if (uv) {
        const auto t = numbers(element, row, *uv);
        uvs.push_back({t[0], 1 - t[1]});
      }
      if (of_vertices.rgb) of_vertices.values.push_back(color(element, row, of_vertices));
    }
    colors = std::move(of_vertices).decoded();
    countOtherUvs(element, uv.has_value());
  }

  // Properties with names of UVs that are not read.
  void countOtherUvs(const PlyElement& element, bool has_uvs) {
    for (const PlyProperty& property : element.properties) {
      const auto is_one_of = [&](const Names& names) { return std::find(names.begin(), names.end(), property.name) != names.end(); };
      const bool is_read = has_uvs && (is_one_of(kUv[0]) || is_one_of(kUv[1]));
      const bool looks_so =
          property.name.starts_with("tex") || property.name.starts_with("uv") || is_one_of(kUv[0]) || is_one_of(kUv[1]) ||
          (property.name.size() == 2 && property.name.find_first_of("uvst") == 0 && property.name[1] >= '0' && property.name[1] <= '9');
      if (looks_so && !is_read)
        warnings.add(WarningKind::kTextureIgnored, file() + ": the property '" + property.name + "' of the vertices is not read");
    }
  }

  void readFaces(const PlyElement& element) {
    const auto list = columnOf(element, kCorners, true), uv_list = columnOf(element, kCornerUvs, true);
    const auto image = columnOf(element, kImageNumber), material = columnOf(element, kMaterialIndex);
    ColorColumns of_faces(element);
    if (!list) throw InputError(file(), element.line, "the faces have no list vertex_indices; export the file again");
    for (uint64_t row = 0; row < element.rows; ++row) {
      takePlyRow(input, header.format, element, row, cells);
      takeIndices(element.properties[*list], cells[*list], row, 0);
      if (indices.size() < 3) {
        ++flat;
        continue;
      }
      const size_t first = mesh.corners.size();
      for (const int vertex : indices) mesh.corners.push_back({vertex, -1, -1});
      if (uv_list) takeUvs(element.properties[*uv_list], cells[*uv_list], first);
      const int chosen = material ? place(element, row, *material) : image ? place(element, row, *image) : 0;
      if (of_faces.rgb) {
        for (size_t i = first; i < mesh.corners.size(); ++i) mesh.corners[i][2] = int(of_faces.values.size());
        of_faces.values.push_back(color(element, row, of_faces));
      }
      mesh.faces.push_back({first, uint32_t(indices.size()), 0, chosen});
    }
    face_colors = std::move(of_faces).decoded();
  }

  // The indices of a list, from `least` on. The vertices may come later in the file, so that their number is not known yet.
  void takeIndices(const PlyProperty& property, std::string_view values, uint64_t row, int least) {
    indices.clear();
    while (!values.empty()) {
      const std::string_view value = takePlyValue(values, property.type, header.format);
      const auto index = plyIndex(value, property.type, header.format);
      if (!index || *index < least || *index > INT32_MAX || (!positions.empty() && *index >= int64_t(positions.size())))
        fail(vertexFault("face " + std::to_string(row), index ? std::to_string(*index) : vertexText(value)));
      indices.push_back(int(*index));
    }
  }
  std::string vertexFault(const std::string& face, const std::string& vertex) const {
    const std::string number = positions.empty() ? "" : " of " + std::to_string(positions.size());
    return face + " uses vertex " + vertex + number + "; the file is damaged, export it again";
  }
  // A value that is no index. The bytes of a float are no text.
  std::string vertexText(std::string_view value) const { return header.format == PlyFormat::kText ? quotedWord(value) : "(a fraction)"; }

  // u and v of every corner of the last face.
  void takeUvs(const PlyProperty& property, std::string_view values, size_t first) {
    std::vector<float> found;
    while (!values.empty()) {
      const std::string_view value = takePlyValue(values, property.type, header.format);
      const auto number = plyNumber(value, property.type, header.format);
      if (!number) fail("a UV is not a number (" + quotedWord(value) + "); repair the file");
      found.push_back(*number);
    }
    if (found.size() != 2 * (mesh.corners.size() - first)) {
      odd_uvs += !found.empty();
      return;
    }
    for (size_t i = 0; i < found.size(); i += 2) mesh.corners[first + i / 2][1] = corner_uvs.add({found[i], 1 - found[i + 1]});
  }

  // Strips of triangles: every corner after the first two makes a triangle with the two before it, turned every other time, and −1 begins a
  // new strip (Stanford's scans have them).
  void readStrips(const PlyElement& element) {
    const auto list = columnOf(element, kCorners, true);
    if (!list) throw InputError(file(), element.line, "the strips have no list vertex_indices; export the file again");
    for (uint64_t row = 0; row < element.rows; ++row) {
      takePlyRow(input, header.format, element, row, cells);
      takeIndices(element.properties[*list], cells[*list], row, -1);
      for (std::span<const int> rest = indices; !rest.empty();) {
        const auto size = size_t(std::find(rest.begin(), rest.end(), -1) - rest.begin());
        addStrip(rest.first(size));
        rest = rest.subspan(std::min(size + 1, rest.size()));
      }
    }
  }
  void addStrip(std::span<const int> strip) {
    for (size_t i = 2; i < strip.size(); ++i) {
      const size_t turned = i % 2;
      const std::array<int, 3> t{strip[i - 2 + turned], strip[i - 1 - turned], strip[i]};
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;  // only joins strips
      mesh.faces.push_back({mesh.corners.size(), 3, 0, 0});
      for (const int vertex : t) mesh.corners.push_back({vertex, -1, -1});
    }
  }

  // The materials of assimp's exporter and others: the Phong model, of which glTF has the colour, its alpha and the roughness.
  void readMaterials(const PlyElement& element) {
    ColorColumns diffuse(element);
    const auto shininess = columnOf(element, kShininess), opacity = columnOf(element, kOpacity);
    for (uint64_t row = 0; row < element.rows; ++row) {
      takePlyRow(input, header.format, element, row, cells);
      SculptMaterial& material = materials.emplace_back();
      material.name = "material " + std::to_string(row);
      if (shininess) material.roughness = std::sqrt(2 / (std::fmax(finiteNumber(element, row, *shininess), 0.0F) + 2));
      if (opacity) material.base_color[3] = std::clamp(finiteNumber(element, row, *opacity), 0.0F, 1.0F);
      if (diffuse.rgb) diffuse.values.push_back(color(element, row, diffuse));
    }
    const bool has_alpha = diffuse.alpha.has_value();
    const std::vector<VertexColor> linear = std::move(diffuse).decoded();
    for (size_t i = 0; i < linear.size(); ++i) {
      for (size_t k = 0; k < (has_alpha ? 4 : 3); ++k) materials[i].base_color[k] = std::clamp(linear[i][k], 0.0F, 1.0F);
      materials[i].blended = materials[i].base_color[3] < 1;
    }
  }

  void readElement(const PlyElement& element) {
    if (element.name == "vertex")
      readVertices(element);
    else if (element.name == "face")
      readFaces(element);
    else if (element.name == "tristrips")
      readStrips(element);
    else if (element.name == "material")
      readMaterials(element);
    else
      for (uint64_t row = 0; row < element.rows; ++row) takePlyRow(input, header.format, element, row, cells);
  }

  // A material per image of the header's comments, unless the file has materials.
  void makeMaterials(const ReadSettings& settings, Sculpt& sculpt) {
    ImageCollector images{input.file, settings, sculpt.images, warnings};
    for (const std::string& texture : materials.empty() ? header.textures : std::vector<std::string>{}) {
      SculptMaterial& material = sculpt.materials.emplace_back();
      material.name = fs::path(texture).stem().string();
      material.base_color_texture.image = images.fromFile(texture, "material '" + material.name + "'");
    }
    if (!materials.empty()) sculpt.materials = std::move(materials);
    for (CornerFace& face : mesh.faces) {
      const bool known = face.material >= 0 && size_t(face.material) < sculpt.materials.size();
      odd_images += !known && !sculpt.materials.empty();
      if (!known) face.material = -1;
    }
  }

  SculptPart fillPart(const PartVertices& vertices) const {
    SculptPart part;
    part.name = input.file.stem().string();
    const bool own_uvs = !corner_uvs.values.empty(), own_colors = !face_colors.empty() && colors.empty();
    if (own_uvs && !uvs.empty()) part.more_uvs.emplace_back();
    uint64_t without_uv = 0;
    for (const auto& [position, uv, color] : vertices.distinct) {
      const auto i = size_t(position);
      part.positions.push_back(positions[i]);
      if (!normals.empty()) part.normals.push_back(normals[i]);
      if (own_uvs) part.uvs.push_back(uv < 0 ? Vec2{} : corner_uvs.values[size_t(uv)]);
      if (!uvs.empty()) (own_uvs ? part.more_uvs[0] : part.uvs).push_back(uvs[i]);
      if (!colors.empty()) part.colors.push_back(colors[i]);
      if (own_colors) part.colors.push_back(color < 0 ? VertexColor{1, 1, 1, 1} : face_colors[size_t(color)]);
      without_uv += own_uvs && uv < 0;
    }
    warnings.add(WarningKind::kMissingUvSet, file() + ": some corners have a UV and others have none; the missing UVs are 0", without_uv);
    return part;
  }

  // Colours of faces that are equal get one number, and none if the vertices have colours.
  void shareFaceColors() {
    if (!colors.empty()) {
      warnings.add(WarningKind::kMaterialIgnored, file() + ": the colours of the faces are not kept, because the vertices have colours",
                   face_colors.size());
      for (Corner& corner : mesh.corners) corner[2] = -1;
      return;
    }
    std::map<VertexColor, int> known;
    std::vector<int> shared(face_colors.size());
    for (size_t i = 0; i < face_colors.size(); ++i) shared[i] = known.try_emplace(face_colors[i], int(i)).first->second;
    for (Corner& corner : mesh.corners)
      if (corner[2] >= 0) corner[2] = shared[size_t(corner[2])];
  }

  // Faces may come before the vertices. Their rows are not known any more, because flat ones are not kept.
  void checkCorners() const {
    for (const Corner& corner : mesh.corners)
      if (size_t(corner[0]) >= positions.size()) throw InputError(file(), vertexFault("a face", std::to_string(corner[0])));
  }

  Sculpt sculpt(const ReadSettings& settings) {
    Sculpt sculpt;
    checkCorners();
    makeMaterials(settings, sculpt);
    shareFaceColors();
    const std::vector<PartFaces> parts = facesOfParts(mesh);
    std::vector<uint32_t> last_of(positions.size(), kNobody);
    bool all_kept = parts.size() == 1;
    if (parts.size() > 1) sculpt.nodes.push_back({input.file.stem().string(), -1, {}});
    for (const PartFaces& faces : parts) {
      auto kept = keptVertices(mesh, faces, positions.size(), parts.size() == 1);
      all_kept = all_kept && kept;
      const PartVertices vertices = kept ? std::move(*kept) : splitCorners(mesh, faces, last_of);
      SculptPart part = fillPart(vertices);
      part.node = int(sculpt.nodes.size()) - 1;
      part.material = faces.material;
      cutFaces(input.file, mesh, faces, vertices.corners, part, warnings);
      sculpt.parts.push_back(std::move(part));
    }
    if (!all_kept) countUnreferenced(input.file, mesh, positions.size(), warnings);
    return sculpt;
  }
};

}  // namespace

Sculpt readPly(const fs::path& file, const std::string& bytes, const ReadSettings& settings, Warnings& warnings) {
  std::string mended;
  PlyInput input = openPly(file, mendPly(file, bytes, mended));
  PlyHeader header = readPlyHeader(input);
  PlyReader reader{input, std::move(header), warnings};
  for (const PlyElement& element : reader.header.elements) reader.readElement(element);
  Sculpt sculpt = reader.sculpt(settings);
  warnings.add(WarningKind::kPartIgnored, file.string() + ": points and lines have no surface and were ignored", reader.flat);
  warnings.add(WarningKind::kMissingUvSet,
               file.string() + ": the list texcoord of a face does not have two numbers per corner; its UVs are 0", reader.odd_uvs);
  warnings.add(WarningKind::kMaterialIgnored, file.string() + ": a face names a texture or material that is not in the file",
               reader.odd_images);
  return sculpt;
}

}  // namespace cloudbake
