// The layout is that of docs/asset_format.md, "Packed". A vertex takes 16 bytes, in one interleaved buffer view:
//
//   0  POSITION, 3 × int16: the place on a grid
//   6  the root of d / d_max, uint16
//   8  o on the octahedron, 2 × int16
//  12  NORMAL, 3 × int8, and a byte of padding
//
// TEXCOORD_n+1 begins at byte 4, because accessors of vertices begin at whole words: its first number repeats z and is not read.
//
// The node of a mesh undoes the grid by a scale that is the same along all axes, so that directions stay. It is a power of two, so that
// places come back without rounding, and packing what was packed changes nothing. Lobes are stored in the space of the mesh, so d is
// divided by the scale. d_max is one per file. So meshes get about the same grid in the scene, whatever their nodes scale.
#include "io/gltf/asset/pack.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

#include "core/certificate.h"
#include "core/error.h"
#include "core/lobe_packing.h"
#include "core/seal.h"
#include "core/text/json.h"
#include "core/text/numbers.h"
#include "io/gltf/accessor.h"
#include "io/gltf/asset/decode.h"
#include "io/gltf/document.h"
#include "io/gltf/sculpt/load.h"
#include "io/gltf/value_types.h"

namespace cloudbake {

namespace {

constexpr int kByte = 5120, kShort = 5122, kTriangles = 4, kTriangleStrip = 5;
constexpr double kMostPlaces = 65532;  // of the grid along an axis: its middle is itself a place
// The codec of meshopt gains from small differences, so it gets a coarser grid of at least as many places, of which an edge of a cloud has
// some 40 (a cloud of n vertices is about √n / 2 edges across), and as few steps of d as keep three quarters of what the certificate
// allows.
constexpr double kCodecPlaces = 8190, kCodecPlacesPerEdge = 40;
constexpr int kCodecDensityBits = 8;
constexpr const char *kQuantisation = "KHR_mesh_quantization", *kMeshopt = "EXT_meshopt_compression";

// What would move with a node's grid.
constexpr const char* kDependants[] = {"children", "camera", "extensions"};

// The grid of a mesh: place = offset + scale · whole numbers.
struct Grid {
  double scale = 1;
  std::array<double, 3> offset{0, 0, 0};
  bool isNone() const { return scale == 1 && offset == std::array<double, 3>{0, 0, 0}; }
};

// The places of a mesh's vertices on its grid. Vertices of one place stay together, and others stay apart where a neighbouring place is
// free, because sheets that fall into one would be edges of four triangles.
class GridPlaces {
 public:
  using Place = std::array<int, 3>;
  Place of(const Grid& grid, const std::array<float, 3>& position) {
    const auto [known, is_new] = places_.try_emplace(position);
    if (!is_new) return known->second;
    std::array<double, 3> exact{};
    Place nearest{};
    for (size_t c = 0; c < 3; ++c) {
      exact[c] = (double(position[c]) - grid.offset[c]) / grid.scale;
      nearest[c] = int(std::lround(exact[c]));
    }
    known->second = taken_.contains(nearest) ? freeBeside(nearest, exact).value_or(nearest) : nearest;
    taken_.insert(known->second);
    return known->second;
  }

 private:
  // The free one of the 26 places around one that is nearest to a point.
  std::optional<Place> freeBeside(const Place& middle, const std::array<double, 3>& exact) const {
    std::optional<Place> best;
    double least = 0;
    for (int i = 0; i < 27; ++i) {
      const Place place{middle[0] + i % 3 - 1, middle[1] + i / 3 % 3 - 1, middle[2] + i / 9 - 1};
      if (std::any_of(place.begin(), place.end(), [](int x) { return x < INT16_MIN || x > INT16_MAX; }) || taken_.contains(place)) continue;
      double square = 0;
      for (size_t c = 0; c < 3; ++c) square += (place[c] - exact[c]) * (place[c] - exact[c]);
      if (!best || square < least) best = place, least = square;
    }
    return best;
  }

  struct Hash {
    template <class Number>
    size_t operator()(const std::array<Number, 3>& place) const {
      size_t hash = 0;
      for (const Number x : place) hash = hash * 0x9E3779B97F4A7C15U + std::bit_cast<uint32_t>(x + Number(0));  // −0 is 0
      return hash;
    }
  };
  std::unordered_map<std::array<float, 3>, Place, Hash> places_;
  std::unordered_set<Place, Hash> taken_;
};

// The bytes of a buffer view, and how the codec sees them.
struct View {
  std::string bytes;
  size_t stride = 0;                // of vertices that may be compressed; 0: it stays as it is
  std::vector<uint32_t> triangles;  // indices that may be compressed
  size_t vertices = 0;              // that they refer to
  std::string filtered{};           // instead of the bytes, for the filter OCTAHEDRAL
};

template <class T>
void store(std::string& bytes, size_t at, T value) {
  std::memcpy(&bytes[at], &value, sizeof value);
}

double longestColumn(const Affine& map) {
  double most = 0;
  for (size_t c = 0; c < 3; ++c) {
    double square = 0;
    for (size_t r = 0; r < 3; ++r) square += map.linear[r][c] * map.linear[r][c];
    most = std::max(most, std::sqrt(square));
  }
  return most;
}

// The power of two at or above a number.
double powerAbove(double value) {
  int exponent = 0;
  const double fraction = std::frexp(value, &exponent);
  return std::ldexp(fraction == 0.5 ? 0.5 : 1.0, exponent);
}

class Packer {
 public:
  // `spare_bits`: so many of the 16 of d stay zero.
  Packer(const std::filesystem::path& file, std::string_view glb, const AssetInfo& info, PackForm form, int spare_bits,
         std::optional<size_t> kept_views, Warnings& warnings)
      : file_(file), info_(info), form_(form), spare_bits_(spare_bits), kept_views_(kept_views), warnings_(warnings) {
    Warnings told_at_the_bake;
    loaded_ = loadGltf(file, glb, {}, told_at_the_bake);
    json_ = loaded_.document->json;
    readViews();
  }

  std::string packed() {
    const bool moves = countDeformed() > 0;
    separate();
    uses_ = useCounts();
    if (!moves) chooseGrids();
    info_.density_max = std::ldexp(largestDensity(), 2 * spare_bits_);
    for (const auto& [mesh, owner] : owners_) packMesh(mesh);
    addTriangles();
    placeAccessors();
    if (!moves)
      for (const auto& [mesh, owner] : owners_) placeMesh(mesh, owner);
    require(kQuantisation);
    certifyFile();
    writeInfoOf();
    return form_ == PackForm::kMeshopt ? compressed() : joined();
  }

  // The bound of its certificate.
  double bound() const { return info_.certificate->transmittance; }

 private:
  // --- Reading ---

  const tinygltf::Model& model() const { return loaded_.model; }
  std::vector<float> floats(int accessor, int width) const {
    return GltfAccessors{file_, model()}.readFloats(accessor, width, "an attribute");
  }
  Json& primitives(int mesh) { return json_["meshes"][size_t(mesh)]["primitives"]; }

  void readViews() {
    for (const Json& view : json_["bufferViews"]) {
      const std::vector<unsigned char>& buffer = model().buffers.at(size_t(wholeNumber(view.at("buffer")))).data;
      const auto begin = size_t(wholeNumber(view, "byteOffset", 0)), length = size_t(wholeNumber(view.at("byteLength")));
      if (begin > buffer.size() || length > buffer.size() - begin) throw InputError(file_.string(), "a buffer view ends beyond its buffer");
      views_.push_back({{buffer.begin() + ptrdiff_t(begin), buffer.begin() + ptrdiff_t(begin + length)}, 0, {}, 0});
    }
  }

  // Parts that joints or morph targets move. One of them keeps the positions of all parts, because there is one d_max.
  size_t countDeformed() {
    size_t count = 0;
    for (size_t i = 0; i < loaded_.sculpt.parts.size(); ++i) {
      const GltfPlace& place = loaded_.document->places[i];
      const Json& node = json_["nodes"][size_t(place.node)];
      bool moves = node.contains("skin");
      for (const Json& primitive : json_["meshes"][size_t(place.mesh)]["primitives"])
        moves = moves || (primitive.contains("targets") && !primitive["targets"].empty());
      count += moves;
      if (moves)
        warnings_.add(WarningKind::kPartNotPacked, "'" + loaded_.sculpt.parts[i].name +
                                                       "' is moved by joints or morph targets: all positions and normals of the file stay "
                                                       "floats, and only lobes are packed");
    }
    return count;
  }

  // Every mesh with lobes gets one node of its own.
  void separate() {
    const std::vector<int> meshes = separateMeshes(*loaded_.document, json_);
    for (size_t i = 0; i < meshes.size(); ++i) owners_.try_emplace(meshes[i], i);
    Json& nodes = json_["nodes"];
    for (size_t n = 0; n < nodes.size(); ++n) {  // others, which are hidden or of another scene, keep the mesh as it is
      const int mesh = int(wholeNumber(nodes[n], "mesh", -1));
      const auto owner = owners_.find(mesh);
      if (owner == owners_.end() || size_t(placeOf(owner->second).node) == n) continue;
      if (!copies_.contains(mesh)) {
        Json copy = json_["meshes"][size_t(mesh)];
        json_["meshes"].push_back(std::move(copy));
        copies_[mesh] = int(json_["meshes"].size()) - 1;
      }
      nodes[n]["mesh"] = copies_[mesh];
    }
  }

  const GltfPlace& placeOf(size_t part) const { return loaded_.document->places[part]; }

  // --- Grids ---

  Box boxOf(int mesh) {
    Box box;
    for (const Json& primitive : primitives(mesh)) {
      if (!primitive["attributes"].contains("POSITION")) continue;
      const std::vector<float> places = floats(int(wholeNumber(primitive["attributes"]["POSITION"])), 3);
      for (size_t i = 0; i + 2 < places.size(); i += 3) box.add({places[i], places[i + 1], places[i + 2]});
    }
    return box;
  }

  void chooseGrids() {
    std::map<int, Box> boxes;
    double places = kMostPlaces;
    if (form_ == PackForm::kMeshopt) {
      size_t vertices = 0;
      for (const SculptPart& part : loaded_.sculpt.parts) vertices += part.positions.size();
      places = std::min(places, std::max(kCodecPlaces, kCodecPlacesPerEdge * 2 * std::sqrt(double(vertices))));
    }
    double of_scene = 0;  // a step of the coarsest grid that a mesh needs
    const auto sizeOf = [&](size_t part) { return longestColumn(loaded_.sculpt.parts[part].to_scene); };
    for (const auto& [mesh, part] : owners_) {
      boxes[mesh] = boxOf(mesh);
      of_scene = std::max(of_scene, double(boxes[mesh].longestSide()) / places * sizeOf(part));
    }
    if (!(of_scene > 0)) return;
    for (const auto& [mesh, part] : owners_) {
      Grid& grid = grids_[mesh];
      grid.scale = powerAbove(of_scene / sizeOf(part));
      const Box& box = boxes[mesh];
      const std::array<double, 3> low{box.low.x, box.low.y, box.low.z}, high{box.high.x, box.high.y, box.high.z};
      double farthest = 0;
      for (size_t c = 0; c < 3; ++c) farthest = std::max({farthest, std::fabs(low[c]), std::fabs(high[c])});
      if (farthest <= grid.scale * kMostPlaces / 2) continue;  // the grid reaches the mesh from the origin
      for (size_t c = 0; c < 3; ++c) grid.offset[c] = grid.scale * std::round((low[c] + high[c]) / 2 / grid.scale);
    }
  }

  double scaleOf(int mesh) const {
    const auto found = grids_.find(mesh);
    return found == grids_.end() ? 1 : found->second.scale;
  }

  float largestDensity() {
    float most = 0;
    for (const auto& [mesh, part] : owners_)
      for (const Json& primitive : primitives(mesh)) {
        const Json& attributes = primitive["attributes"];
        const std::string second = uvSetName(info_.first_uv_set + 1);
        if (!hasLobes(attributes)) continue;
        const std::vector<float> values = floats(int(wholeNumber(attributes[second])), 2);
        for (size_t i = 1; i < values.size(); i += 2) most = std::max(most, float(double(values[i]) / scaleOf(mesh)));
      }
    return most > 0 ? most : 1;
  }

  bool hasLobes(const Json& attributes) const {
    return attributes.contains(uvSetName(info_.first_uv_set)) && attributes.contains(uvSetName(info_.first_uv_set + 1));
  }

  // --- Vertices ---

  int addView(View view, int target, size_t stride = 0) {
    Json json = {{"buffer", 0}, {"byteLength", view.bytes.size()}};
    if (stride != 0) json["byteStride"] = stride;
    if (target != 0) json["target"] = target;
    json_["bufferViews"].push_back(std::move(json));
    views_.push_back(std::move(view));
    return int(views_.size()) - 1;
  }

  static Json accessorOf(int view, size_t offset, int type, bool is_normalised, size_t count, const char* elements) {
    Json accessor = {{"bufferView", view}};
    if (offset != 0) accessor["byteOffset"] = offset;
    accessor["componentType"] = type;
    if (is_normalised) accessor["normalized"] = true;
    accessor["count"] = count;
    accessor["type"] = elements;
    return accessor;
  }

  // An accessor's number until placeAccessors; negative, so that none is taken for an old one.
  int addAccessor(Json accessor) {
    added_.push_back(std::move(accessor));
    return -int(added_.size());
  }

  // An attribute's accessor, until now.
  int take(Json& attributes, const std::string& name) {
    if (!attributes.contains(name)) return -1;
    const int accessor = int(wholeNumber(attributes[name]));
    replaced_.insert(size_t(accessor));
    return accessor;
  }

  void packMesh(int mesh) {
    const auto found = grids_.find(mesh);
    for (size_t p = 0; p < primitives(mesh).size(); ++p) {
      if (form_ == PackForm::kMeshopt) reorder(mesh, p);
      Json attributes = primitives(mesh)[p]["attributes"];
      if (found == grids_.end())
        packLobes(attributes);
      else if (attributes.contains("POSITION"))
        packVertices(mesh, attributes);
      primitives(mesh)[p]["attributes"] = std::move(attributes);
    }
  }

  std::vector<PackedLobe> lobesOf(int first, int second, double scale) {
    std::vector<PackedLobe> lobes;
    const std::vector<float> a = floats(first, 2), b = floats(second, 2);
    for (size_t i = 0; i + 1 < std::min(a.size(), b.size()); i += 2)
      lobes.push_back(quantisedLobe({{a[i], a[i + 1]}, {b[i], float(double(b[i + 1]) / scale)}}, info_.density_max));
    return lobes;
  }

  // Only the lobes, where positions stay: 8 bytes.
  void packLobes(Json& attributes) {
    if (!hasLobes(attributes)) return;
    const std::string first = uvSetName(info_.first_uv_set), second = uvSetName(info_.first_uv_set + 1);
    const std::vector<int> key{take(attributes, first), take(attributes, second)};
    std::vector<int>& accessors = known_[key];
    if (accessors.empty()) {
      const std::vector<PackedLobe> lobes = lobesOf(key[0], key[1], 1);
      View view{std::string(8 * lobes.size(), '\0'), 8, {}, 0};
      for (size_t v = 0; v < lobes.size(); ++v)
        store(view.bytes, 8 * v + 2, lobes[v].root), store(view.bytes, 8 * v + 4, lobes[v].u), store(view.bytes, 8 * v + 6, lobes[v].v);
      const int at = addView(std::move(view), kVertexTarget, 8);
      accessors.push_back(addAccessor(accessorOf(at, 4, kShort, true, lobes.size(), "VEC2")));
      accessors.push_back(addAccessor(accessorOf(at, 0, kUnsignedShort, true, lobes.size(), "VEC2")));
    }
    attributes[first] = accessors[0];
    attributes[second] = accessors[1];
  }

  // Positions, normals and lobes of a primitive; those of points and lines are positions.
  void packVertices(int mesh, Json& attributes) {
    const Grid& grid = grids_[mesh];
    const std::string first = uvSetName(info_.first_uv_set), second = uvSetName(info_.first_uv_set + 1);
    const bool has_lobes = hasLobes(attributes);
    const size_t count = size_t(wholeNumber(json_["accessors"][size_t(wholeNumber(attributes["POSITION"]))].at("count")));
    const bool has_normals =
        attributes.contains("NORMAL") && json_["accessors"][size_t(wholeNumber(attributes["NORMAL"]))].value("count", size_t(0)) == count;
    const std::vector<int> key{take(attributes, "POSITION"), has_normals ? take(attributes, "NORMAL") : -1,
                               has_lobes ? take(attributes, first) : -1, has_lobes ? take(attributes, second) : -1, mesh};
    std::vector<int>& accessors = known_[key];
    if (accessors.empty()) accessors = addBlock(grid, grid_places_[mesh], key, count);
    attributes["POSITION"] = accessors[0];
    if (has_normals) attributes["NORMAL"] = accessors[1];
    if (!has_lobes) return;
    attributes[first] = accessors[2];
    attributes[second] = accessors[3];
  }

  // The interleaved vertices. `key` has the accessors of position, normal and the two sets, −1 where there is none.
  std::vector<int> addBlock(const Grid& grid, GridPlaces& grid_places, const std::vector<int>& key, size_t count) {
    const bool has_normals = key[1] >= 0, has_lobes = key[2] >= 0;
    const bool are_apart = form_ == PackForm::kMeshopt;  // normals, because of their filter
    const size_t normal_at = has_lobes ? 12 : 8, stride = normal_at + (has_normals && !are_apart ? 4 : 0);
    View view{std::string(stride * count, '\0'), stride, {}, 0};
    const std::vector<float> places = floats(key[0], 3);
    std::array<int, 3> low{INT16_MAX, INT16_MAX, INT16_MAX}, high{INT16_MIN, INT16_MIN, INT16_MIN};
    for (size_t v = 0; v < count; ++v) {
      const GridPlaces::Place on_grid = grid_places.of(grid, {places[3 * v], places[3 * v + 1], places[3 * v + 2]});
      for (size_t c = 0; c < 3; ++c) {
        const auto place = int16_t(on_grid[c]);
        low[c] = std::min<int>(low[c], place), high[c] = std::max<int>(high[c], place);
        store(view.bytes, stride * v + 2 * c, place);
      }
    }
    if (has_lobes) {
      const std::vector<PackedLobe> lobes = lobesOf(key[2], key[3], grid.scale);
      if (lobes.size() != count) throw InputError(file_.string(), "a UV set has another number of vertices than its positions");
      for (size_t v = 0; v < count; ++v) {
        char* const at = &view.bytes[stride * v];
        std::memcpy(at + 6, &lobes[v].root, 2), std::memcpy(at + 8, &lobes[v].u, 2), std::memcpy(at + 10, &lobes[v].v, 2);
      }
    }
    if (has_normals && !are_apart) {
      const std::vector<float> normals = floats(key[1], 3);
      for (size_t i = 0; i < 3 * count; ++i)
        store(view.bytes, stride * (i / 3) + normal_at + i % 3, int8_t(std::lround(127 * std::clamp(double(normals[i]), -1.0, 1.0))));
    }
    const int at = addView(std::move(view), kVertexTarget, stride);
    Json position = accessorOf(at, 0, kShort, false, count, "VEC3");
    position["min"] = low, position["max"] = high;
    std::vector<int> accessors{addAccessor(std::move(position)), 0, 0, 0};
    if (has_normals)
      accessors[1] = addAccessor(accessorOf(are_apart ? addNormals(key[1]) : at, are_apart ? 0 : normal_at, kByte, true, count, "VEC3"));
    if (!has_lobes) return accessors;
    accessors[2] = addAccessor(accessorOf(at, 8, kShort, true, count, "VEC2"));
    accessors[3] = addAccessor(accessorOf(at, 4, kUnsignedShort, true, count, "VEC2"));
    return accessors;
  }

  // A view of normals as the filter leaves them, for readers that see no compression; it is compressed from what goes into the filter.
  int addNormals(int accessor) {
    const std::vector<float> normals = floats(accessor, 3);
    View view{std::string(normals.size() / 3 * 4, '\0'), 4, {}, 0};
    for (size_t i = 0; i < normals.size(); ++i)
      store(view.bytes, i / 3 * 4 + i % 3, int8_t(std::lround(127 * std::clamp(double(normals[i]), -1.0, 1.0))));
    view.filtered = filteredNormals(normals);
    return addView(std::move(view), kVertexTarget, 4);
  }

  // --- Triangles ---

  std::vector<uint32_t> trianglesOf(const Json& primitive) const {
    return GltfAccessors{file_, model()}.readIndices(int(wholeNumber(primitive.at("indices"))), "a primitive");
  }

  static bool isList(const Json& primitive) {
    return primitive.contains("indices") && wholeNumber(primitive, "mode", kTriangles) == kTriangles;
  }

  int addIndices(const std::vector<uint32_t>& indices, size_t vertices, bool are_triangles) {
    View view;
    const bool is_wide = vertices > 65535;
    for (const uint32_t index : indices) {
      const uint32_t wide = index;
      view.bytes.append(reinterpret_cast<const char*>(&wide), is_wide ? 4 : 2);  // little-endian
    }
    if (are_triangles) view.triangles = indices, view.vertices = vertices;
    const int at = addView(std::move(view), kIndexTarget);
    return addAccessor(accessorOf(at, 0, is_wide ? kUnsignedInt : kUnsignedShort, false, indices.size(), "SCALAR"));
  }

  size_t verticesOf(const Json& primitive) const {
    const int64_t position = wholeNumber(primitive.at("attributes").at("POSITION"));
    const Json& accessor = position < 0 ? added_[size_t(-position) - 1] : json_["accessors"][size_t(position)];
    return size_t(wholeNumber(accessor.at("count")));
  }

  // Strips, or lists for the codec. Lists that nothing changes stay.
  void addTriangles() {
    if (form_ == PackForm::kList) return;
    std::map<std::pair<int, size_t>, int> known;  // accessor and vertices → the new accessor, or the old one
    for (const auto& [mesh, owner] : owners_)
      for (Json& primitive : primitives(mesh)) {
        if (!isList(primitive) || wholeNumber(primitive["indices"]) < 0 || !primitive["attributes"].contains("POSITION")) continue;
        const int before = int(wholeNumber(primitive["indices"]));
        const size_t vertices = verticesOf(primitive);
        const auto [entry, is_new] = known.try_emplace({before, vertices}, before);
        if (is_new) {
          const std::vector<uint32_t> triangles = trianglesOf(primitive);
          const std::vector<uint32_t> strip = form_ == PackForm::kStrip ? stripOf(triangles, vertices) : std::vector<uint32_t>();
          if (form_ == PackForm::kMeshopt)
            entry->second = addIndices(triangles, vertices, true);
          else if (!strip.empty())
            entry->second = addIndices(strip, vertices, false);
        }
        if (entry->second == before) continue;
        replaced_.insert(size_t(before));
        primitive["indices"] = entry->second;
        if (form_ == PackForm::kStrip) primitive["mode"] = kTriangleStrip;
      }
  }

  // How often attributes, targets and indices use each accessor.
  std::map<int, int> useCounts() const {
    std::map<int, int> counts;
    for (const Json& mesh : json_["meshes"])
      for (const Json& primitive : mesh["primitives"]) {
        for (const Json& accessor : primitive["attributes"]) ++counts[int(wholeNumber(accessor))];
        for (const Json& target : primitive.value("targets", Json::array()))
          for (const Json& accessor : target) ++counts[int(wholeNumber(accessor))];
        if (primitive.contains("indices")) ++counts[int(wholeNumber(primitive["indices"]))];
      }
    return counts;
  }

  // Puts triangles and vertices in the order of the codec, if nothing else uses the vertices.
  void reorder(int mesh, size_t p) {
    Json& primitive = primitives(mesh)[p];
    if (!isList(primitive) || !hasLobes(primitive["attributes"]) || primitive.contains("targets") || primitive.contains("extensions"))
      return;
    if (uses_[int(wholeNumber(primitive["indices"]))] > 1) return;
    for (const Json& accessor : primitive["attributes"])
      if (uses_[int(wholeNumber(accessor))] > 1 || json_["accessors"][size_t(wholeNumber(accessor))].contains("sparse")) return;
    const size_t vertices = verticesOf(primitive);
    for (const Json& accessor : primitive["attributes"])
      if (json_["accessors"][size_t(wholeNumber(accessor))].value("count", size_t(0)) != vertices) return;
    std::vector<uint32_t> new_places;
    std::vector<uint32_t> triangles = orderedForCodec(trianglesOf(primitive), vertices, new_places);
    for (uint32_t& index : triangles) index = new_places[index];
    for (const Json& accessor : primitive["attributes"]) moveElements(int(wholeNumber(accessor)), new_places);
    writeIndicesOf(int(wholeNumber(primitive["indices"])), triangles);
  }

  // Writes an accessor's elements anew, tightly, into a view of their own, in the model and in the document.
  void moveElements(int index, const std::vector<uint32_t>& new_places) {
    tinygltf::Accessor& accessor = loaded_.model.accessors[size_t(index)];
    const tinygltf::BufferView& view = model().bufferViews.at(size_t(accessor.bufferView));
    const auto size = size_t(tinygltf::GetComponentSizeInBytes(uint32_t(accessor.componentType)) *
                             tinygltf::GetNumComponentsInType(uint32_t(accessor.type)));
    const size_t from = view.byteStride == 0 ? size : view.byteStride, stride = (size + 3) / 4 * 4;
    const std::vector<unsigned char>& buffer = model().buffers[size_t(view.buffer)].data;
    std::string bytes(stride * accessor.count, '\0');
    for (size_t v = 0; v < accessor.count; ++v)
      std::memcpy(&bytes[stride * new_places[v]], &buffer[view.byteOffset + accessor.byteOffset + from * v], size);
    replaceElements(index, std::move(bytes), stride, size);
  }

  void writeIndicesOf(int index, const std::vector<uint32_t>& triangles) {
    const auto size = size_t(tinygltf::GetComponentSizeInBytes(uint32_t(model().accessors[size_t(index)].componentType)));
    std::string bytes;
    for (const uint32_t corner : triangles) bytes.append(reinterpret_cast<const char*>(&corner), size);
    replaceElements(index, std::move(bytes), 0, size);
  }

  void replaceElements(int index, std::string bytes, size_t stride, size_t size) {
    tinygltf::Accessor& accessor = loaded_.model.accessors[size_t(index)];
    tinygltf::Buffer& buffer = loaded_.model.buffers.emplace_back();
    buffer.data.assign(bytes.begin(), bytes.end());
    tinygltf::BufferView& view = loaded_.model.bufferViews.emplace_back();
    view.buffer = int(model().buffers.size()) - 1;
    view.byteLength = bytes.size();
    view.byteStride = stride == size ? 0 : stride;
    Json& json = json_["accessors"][size_t(index)];
    json.erase("byteOffset");
    json["bufferView"] =
        addView({std::move(bytes), stride, {}, 0}, stride == 0 ? kIndexTarget : kVertexTarget, stride == size ? 0 : stride);
    accessor.bufferView = int(model().bufferViews.size()) - 1;
    accessor.byteOffset = 0;
  }

  // --- The document ---

  // Puts the new accessors in the places of those that are no longer used, and others behind them.
  void placeAccessors() {
    Json& accessors = json_["accessors"];
    std::vector<size_t> free;
    const std::set<size_t> used = accessorsInUse(json_);
    for (const size_t accessor : replaced_)
      if (!used.contains(accessor)) free.push_back(accessor);
    std::vector<size_t> places;
    for (size_t i = 0; i < added_.size(); ++i) {
      if (i < free.size()) {
        accessors[free[i]] = std::move(added_[i]);
        places.push_back(free[i]);
      } else {
        accessors.push_back(std::move(added_[i]));
        places.push_back(accessors.size() - 1);
      }
    }
    for (size_t i = added_.size(); i < free.size(); ++i) accessors[free[i]] = {{"componentType", kFloat}, {"count", 1}, {"type", "SCALAR"}};
    const auto settle = [&](Json& accessor) {
      if (wholeNumber(accessor) < 0) accessor = places[size_t(-wholeNumber(accessor)) - 1];
    };
    for (Json& mesh : json_["meshes"])
      for (Json& primitive : mesh["primitives"]) {
        for (Json& accessor : primitive["attributes"]) settle(accessor);
        if (primitive.contains("indices")) settle(primitive["indices"]);
      }
  }

  // The grid becomes a part of the node's transform, or of a node below it if anything else depends on the node.
  void placeMesh(int mesh, size_t part) {
    const Grid& grid = grids_[mesh];
    if (grid.isNone()) return;
    const auto index = size_t(placeOf(part).node);
    const bool is_alone =
        !json_.contains("animations") && !json_.contains("skins") &&
        std::none_of(std::begin(kDependants), std::end(kDependants), [&](const char* key) { return json_["nodes"][index].contains(key); });
    if (is_alone) {
      fold(grid, json_["nodes"][index]);
      return;
    }
    Json child = Json::object();
    if (json_["nodes"][index].contains("name")) child["name"] = json_["nodes"][index]["name"];
    child["mesh"] = json_["nodes"][index]["mesh"];
    fold(grid, child);
    json_["nodes"].push_back(std::move(child));
    Json& node = json_["nodes"][index];
    node.erase("mesh");
    Json children = Json::array({json_["nodes"].size() - 1});  // first, so that parts keep their order
    for (const Json& other : node.value("children", Json::array())) children.push_back(other);
    node["children"] = std::move(children);
  }

  // transform ∘ translation(offset) ∘ scale
  static void fold(const Grid& grid, Json& node) {
    if (node.contains("matrix")) {
      Json& m = node["matrix"];
      for (size_t r = 0; r < 3; ++r) {
        double moved = m.at(12 + r).get<double>();
        for (size_t c = 0; c < 3; ++c) moved += m.at(4 * c + r).get<double>() * grid.offset[c];
        m[12 + r] = moved;
        for (size_t c = 0; c < 3; ++c) m[4 * c + r] = m.at(4 * c + r).get<double>() * grid.scale;
      }
      return;
    }
    const auto numbers = [&](const char* key, std::vector<double> fallback) {
      if (node.contains(key)) fallback = node[key].get<std::vector<double>>();
      return fallback;
    };
    std::vector<double> translation = numbers("translation", {0, 0, 0}), scale = numbers("scale", {1, 1, 1});
    const std::vector<double> q = numbers("rotation", {0, 0, 0, 1});
    std::array<double, 3> v;
    for (size_t c = 0; c < 3; ++c) v[c] = scale.at(c) * grid.offset[c];
    // v + 2 w (q × v) + 2 q × (q × v)
    const std::array<double, 3> t{2 * (q.at(1) * v[2] - q.at(2) * v[1]), 2 * (q.at(2) * v[0] - q.at(0) * v[2]),
                                  2 * (q.at(0) * v[1] - q.at(1) * v[0])};
    const std::array<double, 3> turned{v[0] + q.at(3) * t[0] + q[1] * t[2] - q[2] * t[1], v[1] + q.at(3) * t[1] + q[2] * t[0] - q[0] * t[2],
                                       v[2] + q.at(3) * t[2] + q[0] * t[1] - q[1] * t[0]};
    for (size_t c = 0; c < 3; ++c) translation.at(c) += turned[c], scale[c] *= grid.scale;
    if (translation != std::vector<double>{0, 0, 0}) node["translation"] = translation;
    node["scale"] = scale;
  }

  void require(const char* extension) {
    for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
      Json& list = json_[key];
      if (!list.is_array()) list = Json::array();
      if (std::find(list.begin(), list.end(), extension) == list.end()) list.push_back(extension);
    }
  }

  static void visitViews(Json& node, const std::function<void(Json&)>& visit) {
    if (!node.is_structured()) return;
    for (auto item = node.begin(); item != node.end(); ++item)
      if (node.is_object() && item.key() == "bufferView" && item->is_number_integer())
        visit(*item);
      else
        visitViews(*item, visit);
  }

  // Views that nothing uses lose their bytes, and those of a new document also their numbers.
  void dropViews() {
    std::set<size_t> used;
    visitViews(json_, [&](Json& view) { used.insert(size_t(wholeNumber(view))); });
    Json& list = json_["bufferViews"];
    if (kept_views_) {
      // New views move into the places of old ones.
      for (size_t old = 0, last = list.size(); old < list.size(); ++old) {
        if (used.contains(old)) continue;
        while (last > old + 1 && !used.contains(last - 1)) --last;
        const size_t from = last - 1;
        if (from <= old || from < *kept_views_) {
          list[old] = {{"buffer", 0}, {"byteLength", 1}};
          views_[old] = {std::string(1, '\0'), 0, {}, 0};
          continue;
        }
        list[old] = list[from], views_[old] = views_[from];
        visitViews(json_, [&](Json& view) {
          if (wholeNumber(view) == int64_t(from)) view = old;
        });
        used.erase(from), used.insert(old);
      }
      while (!list.empty() && !used.contains(list.size() - 1)) list.erase(list.size() - 1), views_.pop_back();
      return;
    }
    std::map<size_t, size_t> places;
    Json kept = Json::array();
    std::vector<View> views;
    for (const size_t view : used) {
      places[view] = kept.size();
      kept.push_back(list[view]);
      views.push_back(std::move(views_[view]));
    }
    visitViews(json_, [&](Json& view) { view = places[size_t(wholeNumber(view))]; });
    json_["bufferViews"] = std::move(kept);
    views_ = std::move(views);
  }

  void writeInfoOf() {
    Json& metadata = json_["asset"]["extras"]["cloudbake"];
    Json written = writeInfo(info_);
    if (metadata.contains("source_generator")) written["source_generator"] = metadata["source_generator"];
    metadata = std::move(written);
  }

  std::string joined() {
    std::string binary;
    for (size_t i = 0; i < views_.size(); ++i) {
      binary.append((4 - binary.size() % 4) % 4, '\0');
      json_["bufferViews"][i]["byteOffset"] = binary.size();
      binary += views_[i].bytes;
    }
    json_["buffers"] = Json::array({{{"byteLength", binary.size()}}});
    return joinGlb(file_, json_.dump(), binary);
  }

  // The seal and the certificate are of the file as any program reads it.
  void certifyFile() {
    dropViews();
    info_.layout = kPackedLayoutName;
    Warnings told_at_the_bake;
    const LoadedGltf plain = loadGltf(file_, joined(), {}, told_at_the_bake);
    SealMaker seal;
    std::vector<std::vector<LobeUvs>> numbers;
    for (size_t i = 0; i < plain.sculpt.parts.size(); ++i) {
      std::vector<LobeUvs> uvs;
      for (const LobeUvs& stored : numbers.emplace_back(storedNumbers(plain, i, info_)))
        uvs.push_back(dequantisedLobe(stored, info_.density_max));
      seal.add(plain.sculpt.parts[i], uvs, storedHarmonics(plain, i, info_.harmonic_order));
    }
    std::vector<PackedPart> parts;
    for (size_t i = 0; i < numbers.size(); ++i) parts.push_back({plain.sculpt.parts[i], numbers[i]});
    info_.certificate = certify(parts, info_, certificateRange(info_));
    if (bound() > kMostPackedError && spare_bits_ == 0)
      throw InputError(file_.string(),
                       "--pack: the transmittance of a lobe may change by up to " + shortestText(info_.certificate->transmittance) +
                           ", more than 1/255, because the cloud is too thick for its extinction somewhere; leave out --pack, or "
                           "bake with a lower --extinction or with --fit-to volume");
    info_.seal.reset();
    if (const AssetSeal finished = seal.finished(info_); isFinite(finished)) info_.seal = finished;
  }

  // Views that the codec takes are compressed; the rest stays. A second buffer without bytes stands for what they become.
  std::string compressed() {
    std::string binary;
    size_t plain = 0;
    for (size_t i = 0; i < views_.size(); ++i) {
      View& view = views_[i];
      Json& json = json_["bufferViews"][i];
      binary.append((4 - binary.size() % 4) % 4, '\0');
      const bool is_index = !view.triangles.empty();
      if (!is_index && (view.stride == 0 || view.bytes.empty())) {
        json["byteOffset"] = binary.size();
        binary += view.bytes;
        continue;
      }
      const size_t size = is_index ? view.bytes.size() / view.triangles.size() : view.stride, count = view.bytes.size() / size;
      const std::string bytes = is_index ? compressedTriangles(view.triangles, view.vertices)
                                         : compressedVertices(view.filtered.empty() ? view.bytes : view.filtered, count, view.stride);
      plain = (plain + 3) / 4 * 4;
      json["buffer"] = 1;
      json["byteOffset"] = plain;
      plain += view.bytes.size();
      json["extensions"][kMeshopt] = {{"buffer", 0},
                                      {"byteOffset", binary.size()},
                                      {"byteLength", bytes.size()},
                                      {"byteStride", size},
                                      {"count", count},
                                      {"mode", is_index ? "TRIANGLES" : "ATTRIBUTES"}};
      if (!view.filtered.empty()) json["extensions"][kMeshopt]["filter"] = "OCTAHEDRAL";
      binary += bytes;
    }
    json_["buffers"] = Json::array({{{"byteLength", binary.size()}}});
    if (plain > 0) {
      json_["buffers"].push_back({{"byteLength", plain}, {"extensions", {{kMeshopt, {{"fallback", true}}}}}});
      require(kMeshopt);
    }
    return joinGlb(file_, json_.dump(), binary);
  }

  const std::filesystem::path& file_;
  AssetInfo info_;
  const PackForm form_;
  const int spare_bits_;
  const std::optional<size_t> kept_views_;
  Warnings& warnings_;
  LoadedGltf loaded_;
  Json json_;
  std::vector<View> views_;
  std::map<int, int> uses_;       // accessor → how often the file uses it before anything is packed
  std::map<int, size_t> owners_;  // mesh → its first part
  std::map<int, int> copies_;     // mesh → the copy that other nodes have
  std::map<int, Grid> grids_;     // per mesh
  std::map<int, GridPlaces> grid_places_;
  std::map<std::vector<int>, std::vector<int>> known_;
  std::vector<Json> added_;
  std::set<size_t> replaced_;
};

}  // namespace

std::string packGlb(const std::filesystem::path& file, std::string_view glb, const AssetInfo& info, PackForm form,
                    std::optional<size_t> kept_views, Warnings& warnings) {
  for (int spare_bits = form == PackForm::kMeshopt ? kCodecDensityBits : 0;; --spare_bits) {
    Warnings own;
    Packer packer(file, glb, info, form, spare_bits, kept_views, own);
    std::string packed = packer.packed();
    double over = 4.0 / 3 * packer.bound() / kMostPackedError;
    if (spare_bits == 0 || over <= 1) {
      for (const auto& [kind, entry] : own.entries()) warnings.add(kind, entry.first, entry.count);
      return packed;
    }
    for (; spare_bits > 1 && over > 2; over /= 2) --spare_bits;  // the bound is at most proportional to the step
  }
}

}  // namespace cloudbake
