// Options, clouds and files as the tests of pipeline/ need them.
#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bake/mesh/mesh_topology.h"
#include "core/error.h"
#include "core/text/numbers.h"
#include "io/gltf/asset/write.h"
#include "pipeline/fields/cloud.h"
#include "pipeline/options/resolve.h"
#include "tests/io/io_helpers.h"

namespace cloudbake {

/// "name=value" as the command line gives it to a command; "name" alone is "name=true".
inline Given option(const std::string& text, Command command = kBake) {
  const size_t equals = text.find('=');
  const std::string name = text.substr(0, equals);
  const Option* found = findOption(name, command);
  if (!found) throw std::invalid_argument("no option " + name);
  return {found, equals == std::string::npos ? "true" : text.substr(equals + 1), "", 0, 0};
}
inline std::vector<Given> options(const std::vector<std::string>& texts, Command command = kBake) {
  std::vector<Given> all;
  for (const std::string& text : texts) all.push_back(option(text, command));
  return all;
}
/// The same as a file at "bake.toml", one per line.
inline std::vector<Given> optionsInFile(const std::vector<std::string>& texts, Command command = kBake) {
  std::vector<Given> all = options(texts, command);
  for (size_t i = 0; i < all.size(); ++i) all[i].file = "bake.toml", all[i].line = int(i) + 1, all[i].column = 3;
  return all;
}

inline SourceSettings sourceOf(SourceKind kind, const std::filesystem::path& input = {}) {
  SourceSettings source;
  source.kind = kind;
  source.input = input;
  return source;
}
inline Settings settingsFor(const std::vector<std::string>& texts, SourceKind kind = SourceKind::kSculpt,
                            const std::filesystem::path& input = {}) {
  return resolve(sourceOf(kind, input), options(texts, isGrown(kind) ? kGrow : kBake));
}

/// A mesh as a sculpt of one part.
inline Cloud cloudOf(SurfaceMesh mesh, const std::string& name = "shape") {
  if (mesh.normals.empty()) mesh.normals = smoothNormals(mesh);
  Cloud cloud;
  cloud.sculpt.parts.push_back({name, mesh.positions, mesh.normals, {}, mesh.triangles, {}});
  cloud.closed = findDefects(mesh).unmatched_edges == 0;
  cloud.surface = std::move(mesh);
  return cloud;
}

/// A mesh as one part of a sculpt, and a GLB of such parts, each a node of its own.
inline SculptPart partOf(const SurfaceMesh& mesh, const std::string& name, int object, const Affine& to_scene = {}) {
  SculptPart part;
  part.name = name;
  part.positions = mesh.positions;
  part.normals = mesh.normals.empty() ? smoothNormals(mesh) : mesh.normals;
  part.triangles = mesh.triangles;
  part.to_scene = to_scene;
  part.object = object;
  return part;
}
inline std::filesystem::path writeParts(const TestFolder& folder, const std::string& name, const std::vector<SculptPart>& parts) {
  Sculpt sculpt;
  sculpt.parts = parts;
  std::vector<std::vector<Lobe>> lobes;
  for (const SculptPart& part : parts) lobes.emplace_back(part.positions.size(), Lobe{{0, 1, 0}, 1});
  Warnings warnings;
  return folder.write(name, encodeGlb(sculpt, lobes, {}, {}, warnings));
}

/// Positions and triangles as an OBJ that reads back to the same floats.
inline std::string objText(const SurfaceMesh& mesh) {
  std::string text;
  for (const Vec3& p : mesh.positions) text += "v " + shortestText(p.x) + " " + shortestText(p.y) + " " + shortestText(p.z) + "\n";
  for (const Triangle& t : mesh.triangles)
    text += "f " + std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " + std::to_string(t[2] + 1) + "\n";
  return text;
}

/// What an error of this kind says; empty where none is thrown.
template <class Kind = Error, class Run>
std::string refusalOf(const Run& run) {
  try {
    run();
  } catch (const Kind& error) {
    return error.what();
  }
  return "";
}

inline bool contains(const std::string& text, const std::string& piece) { return text.find(piece) != std::string::npos; }

}  // namespace cloudbake
