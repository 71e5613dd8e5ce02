#include "pipeline/check/name_change.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/portable_math.h"

namespace cloudbake {

namespace {

constexpr double kEverywhere = 0.95;      // of the vertices, for what is to hold everywhere
constexpr double kMany = 0.8;             // of the right lobes, found at other vertices of the same mesh
constexpr double kSameAngle_degrees = 1;  // two directions are the same
constexpr double kSameRatio = 0.03;       // two thicknesses are the same
constexpr double kFew = 0.1;              // of one thing beside the other
constexpr double kWrongLight = 0.02;      // rms of T from which on a lobe is wrong
constexpr double kPart = 0.6;             // of the vertices: fewer wrong ones are a part

constexpr const char* kBakeAnew = "bake the mesh as it is now";
constexpr const char* kKeepSets = "export the UV sets as they were, or bake as the last step";

bool sameThickness(double a, double b, double scale) { return std::fabs(a - b) <= kSameRatio * std::max({a, b, 0.01 * scale}); }
bool sameDirection(Vec3 a, Vec3 b) { return angleDegrees(a, b) <= kSameAngle_degrees; }

// What differs at the vertices, one by one.
struct Differences {
  size_t wrong = 0, wrong_thickness = 0, wrong_direction = 0, inverted = 0, zero = 0;
  std::vector<double> angles;  // of wrong directions
};

Differences differencesOf(const ChangedLobes& lobes, double scale) {
  Differences found;
  for (size_t i = 0; i < lobes.vertices.size(); ++i) {
    const Lobe &stored = lobes.stored[lobes.vertices[i]], &right = lobes.right[i];
    const bool thickness = sameThickness(stored.thickness, right.thickness, scale),
               direction = sameDirection(stored.direction, right.direction);
    found.wrong += lobes.errors[i] > kWrongLight;
    found.wrong_thickness += !thickness;
    found.wrong_direction += !direction;
    found.zero += !thickness && stored.thickness == 0;
    if (direction) continue;
    found.angles.push_back(angleDegrees(stored.direction, right.direction));
    found.inverted += sameDirection(-stored.direction, right.direction);
  }
  return found;
}

// The share of the right lobes that some other vertex has.
double shareFoundElsewhere(const ChangedLobes& lobes, double scale) {
  std::vector<uint32_t> order(lobes.stored.size());
  for (uint32_t v = 0; v < order.size(); ++v) order[v] = v;
  const auto thinner = [&](uint32_t a, uint32_t b) { return lobes.stored[a].thickness < lobes.stored[b].thickness; };
  std::erase_if(order, [&](uint32_t v) { return !std::isfinite(lobes.stored[v].thickness); });
  std::sort(order.begin(), order.end(), thinner);
  constexpr double kThickness = 0.01;  // of the mean
  const double least_cosine = sinCosDegrees(kSameAngle_degrees).cos;
  size_t found = 0;
  for (const Lobe& right : lobes.right) {
    const auto least = float(right.thickness - kThickness * scale), most = float(right.thickness + kThickness * scale);
    auto at =
        std::lower_bound(order.begin(), order.end(), least, [&](uint32_t v, float value) { return lobes.stored[v].thickness < value; });
    for (; at != order.end() && lobes.stored[*at].thickness <= most; ++at)
      if (dot(lobes.stored[*at].direction, right.direction) > least_cosine) {
        ++found;
        break;
      }
  }
  return double(found) / double(lobes.right.size());
}

double medianAngle(std::vector<double> values) {
  const auto middle = values.begin() + ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Of thicknesses that are wrong where directions are right.
AssetFault nameThickness(const ChangedLobes& lobes, const Differences& found, double percent) {
  std::vector<float> stored, right;
  for (size_t i = 0; i < lobes.vertices.size(); ++i)
    stored.push_back(lobes.stored[lobes.vertices[i]].thickness), right.push_back(lobes.right[i].thickness);
  std::sort(stored.begin(), stored.end());
  std::sort(right.begin(), right.end());
  double apart = 0, sum = 0;
  for (size_t i = 0; i < stored.size(); ++i) apart += std::fabs(double(stored[i]) - right[i]), sum += right[i];
  std::string what = fmt::format("o is right, but d is wrong at {:.3g} % of the vertices", percent);
  if (double(found.zero) > (1 - kFew) * double(found.wrong_thickness))
    what = fmt::format("d is 0 at {:.3g} % of the vertices", percent);
  else if (apart < 0.05 * sum)
    what = "o is right, but d is that of other vertices";
  return {"thickness", what, kKeepSets};
}

}  // namespace

std::optional<AssetFault> nameConstant(const ChangedLobes& lobes) {
  const auto range = [](const auto& thicknessAt, size_t count) {
    double least = INFINITY, most = 0;
    for (size_t i = 0; i < count; ++i) least = std::min<double>(least, thicknessAt(i)), most = std::max<double>(most, thicknessAt(i));
    return std::pair(least, most);
  };
  const auto stored = range([&](size_t i) { return lobes.stored[i].thickness; }, lobes.stored.size());
  const auto right = range([&](size_t i) { return lobes.right[i].thickness; }, lobes.right.size());
  constexpr double kNone = 1e-5, kSome = 0.01;
  if (!(stored.second - stored.first <= kNone * std::max(stored.second, right.second))) return std::nullopt;
  if (!(right.second - right.first >= kSome * right.second)) return std::nullopt;
  return AssetFault{"thickness", "d is the same at all vertices", kKeepSets};
}

AssetFault nameChange(const ChangedLobes& lobes) {
  const auto count = double(lobes.vertices.size());
  double scale = 0;
  for (const Lobe& right : lobes.right) scale += right.thickness / count;
  const Differences found = differencesOf(lobes, scale);
  const auto percent = [&](size_t vertices) { return 100 * double(vertices) / count; };

  const size_t off = std::max(found.wrong_thickness, found.wrong_direction);
  const auto isMostly = [](size_t one, size_t other) { return one > 0 && double(other) <= kFew * double(one); };
  if (isMostly(found.wrong_thickness, found.wrong_direction)) return nameThickness(lobes, found, percent(found.wrong_thickness));
  if (isMostly(found.wrong_direction, found.wrong_thickness)) {
    if (double(found.inverted) > (1 - kFew) * double(found.wrong_direction))
      return {"direction", fmt::format("o points out of the cloud at {:.3g} % of the vertices", percent(found.wrong_direction)), kKeepSets};
    return {"direction",
            fmt::format("d is right, but o is off by {:.3g}° (median) at {:.3g} % of the vertices", medianAngle(found.angles),
                        percent(found.wrong_direction)),
            kKeepSets};
  }
  if (const double elsewhere = shareFoundElsewhere(lobes, scale);
      double(off) > (1 - kEverywhere) * count && elsewhere > (lobes.same_mesh ? kMany : kEverywhere))
    return {"permuted",
            fmt::format("the lobes are those of other vertices: {:.3g} % of the right ones are there, but elsewhere", 100 * elsewhere),
            kKeepSets};
  if (found.wrong > 0 && double(found.wrong) < kPart * count && double(off) < kPart * count)
    return {"part",
            fmt::format("the lobes are wrong at {:.3g} % of the vertices and right at the others: a part of them was replaced{}",
                        percent(std::max(found.wrong, off)), lobes.same_mesh ? "" : ", or the mesh was changed there"),
            kBakeAnew};
  if (lobes.same_mesh) return {"stale", "the lobes are those of another mesh", kBakeAnew};
  return {"stale", "the lobes are those of another mesh, or the mesh has changed since the bake", kBakeAnew};
}

}  // namespace cloudbake
