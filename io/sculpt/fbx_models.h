// The models of an FBX with what assimp does not hand over: who is hidden, and how each is placed below its parent.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/affine.h"

namespace cloudbake {

/// The numbers of a property, "Lcl Translation" and the like; zeros after the last.
using FbxProperties = std::map<std::string, std::array<double, 3>, std::less<>>;

/// A Model. Its own properties have been completed by those of the file's template for models.
struct FbxModel {
  std::string name;  ///< without "Model::"
  FbxProperties properties;
  std::vector<size_t> children;  ///< indices into FbxModels::models, in the order of the file. May repeat, and may form circles
  bool in_hidden_layer = false;  ///< it belongs to a display layer that is not shown

  /// The first number of a property.
  std::optional<double> number(std::string_view property) const;
  std::array<double, 3> vector(std::string_view property, double otherwise) const;
  /// Whether its meshes are hidden, below a parent that is hidden or not. `inherited`: whether this also hides its children.
  bool isHidden(bool parent_is_hidden, bool& inherited) const;
};

struct FbxModels {
  std::vector<FbxModel> models;
  std::vector<size_t> roots;  ///< as FbxModel::children
  FbxProperties settings;     ///< the file's own GlobalSettings
};

/// Whether the bytes are those of the binary form.
bool isBinaryFbx(std::string_view bytes);

/// Reads an FBX of version 7, binary or text (core/text/plain_text.h), without its arrays. Throws InputError, with `file` for messages, if
/// it is damaged.
FbxModels readFbxModels(const std::string& file, std::string_view bytes);

/// Where a model lies.
struct FbxPlace {
  Affine to_parent;  ///< own space → the parent's, without `geometric`
  Affine geometric;  ///< the mesh's space → own space; children are not moved by it
  Affine global;     ///< own space → the file's, without `geometric`
  Affine rotation;   ///< the product of the rotations of the model and its parents
  std::array<double, 3> scale{1, 1, 1};
  bool is_exact = true;  ///< false if a rule of the model has no agreed meaning and the nearest one was followed
};
FbxPlace placeFbxModel(const FbxModel& model, const FbxPlace& parent);

}  // namespace cloudbake
