// A model's own transform is  T · Roff · Rp · Rpre · R · Rpost⁻¹ · Rp⁻¹ · Soff · Sp · S · Sp⁻¹  (FBX SDK help, "Computing transformation
// matrices"). Its InheritType says how the parent's scale reaches it. With the parent's rotation R and scale S (which takes up any shear)
// and the model's own rotation r and scale s, the linear parts are (FBX SDK, sample "Transformations"):
//   0 RrSs: R·r·S·s      1 RSrs: R·S·r·s      2 Rrs: R·r·S·(the parent's own scale)⁻¹·s
// The origin is moved by the parent's whole transform in all three.
#include <algorithm>
#include <cmath>

#include "core/portable_math.h"
#include "io/sculpt/fbx_models.h"

namespace cloudbake {

namespace {

using Vector = std::array<double, 3>;

Affine moved(const Vector& by, double sign = 1) { return {Affine().linear, {sign * by[0], sign * by[1], sign * by[2]}}; }

Affine scaledBy(const Vector& by) { return {{{{by[0], 0, 0}, {0, by[1], 0}, {0, 0, by[2]}}}, {0, 0, 0}}; }

Affine turned(size_t axis, double degrees) {
  Affine turn;
  const auto [sine, cosine] = sinCosDegrees(degrees);
  const size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  turn.linear[u][u] = turn.linear[v][v] = cosine;
  turn.linear[u][v] = -sine, turn.linear[v][u] = sine;
  return turn;
}

// The axes in the order in which they are turned about: FbxEuler::EOrder. The last, spheric XYZ, is read as XYZ by other programs too.
constexpr std::array<std::array<size_t, 3>, 7> kOrders{{{0, 1, 2}, {0, 2, 1}, {1, 2, 0}, {1, 0, 2}, {2, 0, 1}, {2, 1, 0}, {0, 1, 2}}};

Affine turnedBy(const Vector& degrees, size_t order = 0) {
  const auto [first, second, third] = kOrders[order];
  return compose(turned(third, degrees[third]), compose(turned(second, degrees[second]), turned(first, degrees[first])));
}

Affine withoutOffset(Affine map) {
  map.offset = {};
  return map;
}

// Whether a linear map is a scale alone (uniform: by one number), to nine digits.
bool isScale(const Affine& map, bool uniform) {
  double largest = 0, error = 0;
  for (size_t i = 0; i < 3; ++i) largest = std::max(largest, std::abs(map.linear[i][i]));
  for (size_t r = 0; r < 3; ++r)
    for (size_t c = 0; c < 3; ++c)
      error = std::max(error, std::abs(map.linear[r][c] - (r != c ? 0 : uniform ? map.linear[0][0] : map.linear[r][r])));
  return error <= 1e-9 * largest;
}

// The linear part of InheritType 0 or 2 in the parent's space. Nothing if the parent's scale has no inverse.
std::optional<Affine> inheritedLinear(const FbxPlace& parent, const Affine& turn, const Vector& scale, bool drops_scale, bool& is_exact) {
  const auto from_parent = inverted(withoutOffset(parent.global)), from_turned = inverted(parent.rotation);
  if (!from_parent || !from_turned) return std::nullopt;
  Affine parent_scale = compose(*from_turned, withoutOffset(parent.global));
  if (drops_scale) {
    const auto without = inverted(scaledBy(parent.scale));
    if (!without) return std::nullopt;
    parent_scale = compose(parent_scale, *without);
  }
  is_exact = isScale(parent_scale, false);
  return compose(*from_parent, compose(parent.rotation, compose(turn, compose(parent_scale, scaledBy(scale)))));
}

}  // namespace

FbxPlace placeFbxModel(const FbxModel& model, const FbxPlace& parent) {
  constexpr double kRrSs = 0, kRSrs = 1, kRrs = 2;
  const Vector none{0, 0, 0};
  const bool turns_freely = model.number("RotationActive").value_or(1) != 0 && model.number("RotationSpaceForLimitOnly").value_or(0) == 0;
  const double order = turns_freely ? model.number("RotationOrder").value_or(0) : 0;
  FbxPlace place;
  place.is_exact = order >= 0 && order < 6;
  place.scale = model.vector("Lcl Scaling", 1);
  const Affine post = turnedBy(turns_freely ? model.vector("PostRotation", 0) : none);
  const Affine turn = compose(
      turnedBy(turns_freely ? model.vector("PreRotation", 0) : none),
      compose(turnedBy(model.vector("Lcl Rotation", 0), order >= 0 && order <= 6 ? size_t(order) : 0), inverted(post).value_or(Affine())));

  const Vector turn_pivot = model.vector("RotationPivot", 0), scale_pivot = model.vector("ScalingPivot", 0);
  place.to_parent = moved(model.vector("Lcl Translation", 0));
  for (const Affine& step : {moved(model.vector("RotationOffset", 0)), moved(turn_pivot), turn, moved(turn_pivot, -1),
                             moved(model.vector("ScalingOffset", 0)), moved(scale_pivot), scaledBy(place.scale), moved(scale_pivot, -1)})
    place.to_parent = compose(place.to_parent, step);

  const double type = model.number("InheritType").value_or(kRSrs);
  const bool drops_scale = type == kRrs && parent.scale != Vector{1, 1, 1};
  if (type == kRrSs || type == kRrs) {
    const auto from_turned = inverted(parent.rotation);
    const bool is_plain = from_turned && isScale(compose(*from_turned, withoutOffset(parent.global)), true);
    if (!is_plain || drops_scale) {
      bool is_exact = false;
      const auto linear = inheritedLinear(parent, turn, place.scale, type == kRrs, is_exact);
      if (linear) place.to_parent.linear = linear->linear;
      place.is_exact &= is_exact;
    }
  } else {
    place.is_exact &= type == kRSrs;
  }
  place.geometric = compose(moved(model.vector("GeometricTranslation", 0)),
                            compose(turnedBy(model.vector("GeometricRotation", 0)), scaledBy(model.vector("GeometricScaling", 1))));
  place.global = compose(parent.global, place.to_parent);
  place.rotation = compose(parent.rotation, turn);
  return place;
}

}  // namespace cloudbake
