// FBX files of cubes, in the text form and in both binary forms.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace cloudbake {

struct FbxElement {
  using Value = std::variant<int64_t, double, std::string, std::vector<double>, std::vector<int64_t>>;
  std::string name;
  std::vector<Value> values{};
  std::vector<FbxElement> children{};
};

/// A model of a test: a cube of one metre around its origin if `is_cube`, else nothing. Parent 0 is the scene.
struct TestModel {
  int64_t id;
  std::string name;
  int64_t parent = 0;
  std::vector<std::pair<std::string, std::vector<double>>> properties{};
  bool is_cube = true;
};

inline FbxElement fbxProperties(const std::vector<std::pair<std::string, std::vector<double>>>& properties) {
  FbxElement all{"Properties70"};
  for (const auto& [name, numbers] : properties) {
    // The types by which assimp reads them
    const bool is_whole = name.ends_with("Axis") || name.ends_with("Sign") || name == "RotationOrder" || name == "InheritType";
    const bool is_flag = name == "Show" || name == "RotationActive";
    const std::string type = name.starts_with("Lcl") || name.starts_with("Visibility") ? name
                             : numbers.size() == 3                                     ? "Vector3D"
                             : is_whole                                                ? "int"
                             : is_flag                                                 ? "bool"
                                                                                       : "double";
    FbxElement one{"P", {name, type, "", ""}};
    for (const double number : numbers) {
      if (is_whole || is_flag)
        one.values.emplace_back(int64_t(number));
      else
        one.values.emplace_back(number);
    }
    all.children.push_back(one);
  }
  return all;
}

inline const std::vector<std::pair<std::string, std::vector<double>>> kFbxCentimetres{
    {"UpAxis", {1}},    {"UpAxisSign", {1}},    {"FrontAxis", {2}},      {"FrontAxisSign", {1}},
    {"CoordAxis", {0}}, {"CoordAxisSign", {1}}, {"UnitScaleFactor", {1}}};

inline std::vector<FbxElement> fbxOf(const std::vector<TestModel>& models,
                                     const std::vector<std::pair<std::string, std::vector<double>>>& settings = kFbxCentimetres,
                                     const std::vector<std::pair<std::string, std::vector<double>>>& defaults = {}) {
  FbxElement objects{"Objects"}, links{"Connections"};
  for (const TestModel& model : models) {
    if (model.is_cube) {
      const std::vector<double> corners{-50, -50, -50, 50, -50, -50, -50, 50, -50, 50, 50, -50,
                                        -50, -50, 50,  50, -50, 50,  -50, 50, 50,  50, 50, 50};
      const std::vector<int64_t> quads{0, 2, 3, -2, 4, 5, 7, -7, 0, 1, 5, -5, 2, 6, 7, -4, 0, 4, 6, -3, 1, 3, 7, -6};
      objects.children.push_back({"Geometry",
                                  {model.id + 1000, "Geometry::" + model.name, "Mesh"},
                                  {{"Vertices", {corners}}, {"PolygonVertexIndex", {quads}}, {"GeometryVersion", {int64_t(124)}}}});
      links.children.push_back({"C", {"OO", model.id + 1000, model.id}});
    }
    objects.children.push_back({"Model",
                                {model.id, "Model::" + model.name, model.is_cube ? "Mesh" : "Null"},
                                {{"Version", {int64_t(232)}}, fbxProperties(model.properties), {"Culling", {"CullingOff"}}}});
    links.children.push_back({"C", {"OO", model.id, model.parent}});
  }
  FbxElement definitions{"Definitions", {}, {{"Version", {int64_t(100)}}}};
  if (!defaults.empty())
    definitions.children.push_back({"ObjectType", {"Model"}, {{"PropertyTemplate", {"FbxNode"}, {fbxProperties(defaults)}}}});
  return {{"FBXHeaderExtension", {}, {{"FBXHeaderVersion", {int64_t(1003)}}, {"FBXVersion", {int64_t(7400)}}}},
          {"GlobalSettings", {}, {{"Version", {int64_t(1000)}}, fbxProperties(settings)}},
          definitions,
          objects,
          links};
}

inline std::string numbersText(const auto& numbers) {
  std::string text;
  for (const auto number : numbers) text += (text.empty() ? "" : ",") + std::to_string(number);
  return text;
}

inline std::string fbxText(const std::vector<FbxElement>& elements) {
  std::string text;
  for (const FbxElement& element : elements) {
    text += element.name + ": ";
    bool is_first = true;
    for (const auto& value : element.values) {
      text += std::exchange(is_first, false) ? "" : ",";
      if (const auto* written = std::get_if<std::string>(&value)) text += "\"" + *written + "\"";
      if (const auto* whole = std::get_if<int64_t>(&value)) text += std::to_string(*whole);
      if (const auto* number = std::get_if<double>(&value)) text += std::to_string(*number);
      if (const auto* many = std::get_if<std::vector<double>>(&value))
        text += "*" + std::to_string(many->size()) + " {\n a: " + numbersText(*many) + "\n}";
      if (const auto* many = std::get_if<std::vector<int64_t>>(&value))
        text += "*" + std::to_string(many->size()) + " {\n a: " + numbersText(*many) + "\n}";
    }
    if (!element.children.empty()) text += " {\n" + fbxText(element.children) + "}";
    text += "\n";
  }
  return text;
}

inline std::string littleEndian(uint64_t value, size_t size) {
  std::string bytes;
  for (size_t i = 0; i < size; ++i) bytes += char(value >> (8 * i));
  return bytes;
}

/// The elements at offset `at` of a file, and the zeros that end them below the top.
inline std::string fbxElements(const std::vector<FbxElement>& elements, size_t at, size_t word, bool is_top) {
  std::string bytes;
  for (const FbxElement& element : elements) {
    std::string values;
    for (const auto& value : element.values) {
      if (const auto* written = std::get_if<std::string>(&value)) {
        const size_t colons = written->find("::");
        const std::string stored =
            colons == std::string::npos ? *written : written->substr(colons + 2) + std::string("\0\1", 2) + written->substr(0, colons);
        values += "S" + littleEndian(stored.size(), 4) + stored;
      }
      if (const auto* whole = std::get_if<int64_t>(&value))
        values += element.name == "Model" || element.name == "Geometry" || element.name == "C" ? "L" + littleEndian(uint64_t(*whole), 8)
                                                                                               : "I" + littleEndian(uint64_t(*whole), 4);
      if (const auto* number = std::get_if<double>(&value)) values += "D" + littleEndian(std::bit_cast<uint64_t>(*number), 8);
      if (const auto* many = std::get_if<std::vector<double>>(&value)) {
        values += "d" + littleEndian(many->size(), 4) + littleEndian(0, 4) + littleEndian(8 * many->size(), 4);
        for (const double one : *many) values += littleEndian(std::bit_cast<uint64_t>(one), 8);
      }
      if (const auto* many = std::get_if<std::vector<int64_t>>(&value)) {
        values += "i" + littleEndian(many->size(), 4) + littleEndian(0, 4) + littleEndian(4 * many->size(), 4);
        for (const int64_t one : *many) values += littleEndian(uint64_t(one), 4);
      }
    }
    const size_t begin = at + bytes.size(), inside = begin + 3 * word + 1 + element.name.size() + values.size();
    const std::string children = element.children.empty() ? "" : fbxElements(element.children, inside, word, false);
    bytes += littleEndian(inside + children.size(), word) + littleEndian(element.values.size(), word) + littleEndian(values.size(), word) +
             char(element.name.size()) + element.name + values + children;
  }
  return bytes + (is_top ? std::string(160, '\0') : std::string(3 * word + 1, '\0'));
}

/// 32-bit numbers before version 7500.
inline std::string fbxBinary(const std::vector<FbxElement>& elements, uint32_t version) {
  const std::string header = "Kaydara FBX Binary  " + std::string("\0\x1A\0", 3) + littleEndian(version, 4);
  return header + fbxElements(elements, header.size(), version >= 7500 ? 8 : 4, true);
}

}  // namespace cloudbake
