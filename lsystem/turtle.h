// The turtle reads a module string and walks. It starts with its heading along +Y, up along +Z and right along +X, so a flat system lies
// in the XY plane.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/memory_budget.h"
#include "core/warnings.h"
#include "lsystem/double3.h"
#include "lsystem/module_string.h"

namespace cloudbake {

struct TurtleSettings {
  double step = 0.1;                     ///< length of F, world units
  double step_scale = 0.9;               ///< factor of `"`, divisor of `_`
  double angle = 28;                     ///< degrees
  double angle_scale = 0.7;              ///< factor of `;`, divisor of `@`
  double thickness = 0.1;                ///< width at the start, world units, > 0
  double thickness_scale = 0.9;          ///< factor of `!`, divisor of `?`
  double gravity = 7.5;                  ///< degrees that `T` turns a horizontal heading
  double uv_increment = 0.1;             ///< step of `'` and `#`
  double vertical_increment = 1;         ///< growth of `lage` per segment
  double random_scale = 0;               ///< lengths × (1 ± this); 0 … 1
  bool random_scale_all = false;         ///< applies random_scale to angles and widths too
  int segments = 1;                      ///< segments of one F, 1 … 10000
  bool continuous_length = true;         ///< lengths of the newest modules are multiplied by the fraction of the generation
  bool continuous_angles = true;         ///< their rotations too
  bool continuous_width = true;          ///< their widths, leaves and radii too
  bool pitch_up = false;                 ///< `&` pitches up and `^` down
  Double3 start_position{0, 0, 0};       ///< world units
  Double3 start_rotation{0, 0, 0};       ///< degrees about X, then Y, then Z
  int max_depth = 1000;                  ///< limit of open brackets
  uint64_t max_points = 2'000'000;       ///< limit of points, leaves and the attributes of all sets together
  uint64_t memory_limit = kMemoryLimit;  ///< bytes
};

/// A recorded point of a curve. World units.
struct TurtlePoint {
  Double3 position;
  Vec3 heading, up;
  double width = 0;     ///< width before growth
  double arc = 0;       ///< length walked from the root
  double lage = 0;      ///< segments from the root × vertical increment
  float u = 0, v = 0;   ///< colour index
  float growth = 1;     ///< factor of width and radius (continuous_width)
  int gen = 0;          ///< generation in which the module that recorded it was born
  int group = -1;       ///< -1 = none
  int previous = -1;    ///< the point at the other end of the edge to this one; -1 = a curve begins here
  int segments = 1;     ///< segments of the F that recorded it
  int section = 0;      ///< number of the point within its F, 1 … segments; 0 = the start of a curve
  int depth = 0;        ///< open brackets
  int attributes = -1;  ///< index into TurtlePath::attribute_sets, -1 = none
  uint64_t key = 0;     ///< key of the module that recorded it
};

/// An instance that J, K or M placed.
struct TurtleLeaf {
  char symbol = 'J';
  TurtlePoint point;                      ///< its position and state; `previous` is the branch's current point
  double scale = 0;                       ///< before growth
  std::array<double, 3> values{0, 0, 0};  ///< a, b, c, passed through
};

/// One value of a("name",v1,v2,v3).
struct TurtleAttribute {
  int name = 0;  ///< index into TurtlePath::texts
  int count = 1;
  std::array<double, 3> values{0, 0, 0};
};

struct TurtlePath {
  std::vector<TurtlePoint> points;  ///< in the order recorded
  std::vector<TurtleLeaf> leaves;
  std::vector<std::vector<Double3>> polygons;                ///< of { . }
  std::vector<std::vector<TurtleAttribute>> attribute_sets;  ///< attributes that apply at a point, each name once
  std::vector<std::string> texts;
  double thickness = 1;  ///< the width that the turtle started with
  double step = 1;       ///< the step that it started with, > 0
  std::string file;      ///< the grammar's file, for errors
};

/// Everything that `[` saves.
struct TurtleState {
  Double3 position, heading{0, 1, 0}, up{0, 0, 1};
  double step = 0, angle = 0, width = 0, arc = 0, lage = 0, u = 0, v = 0;
  int group = -1, current = -1, attributes = -1;
};

/// A walk in progress. Call `stepTurtle` once per module, in order.
struct TurtleWalk {
  const TurtleSettings* settings = nullptr;
  TurtleState state;
  std::vector<TurtleState> stack;
  std::vector<std::vector<Double3>> open_polygons;
  TurtlePath path;
  bool records = true;  ///< false: only the state is updated
  int next_group = 0;
  uint64_t attribute_values = 0;  ///< number of values in all attribute sets of the path
  uint64_t unmatched_pops = 0, unmatched_polygons = 0, zero_divisors = 0;
};

/// Starts a walk. `settings` must outlive it. Throws InputError for a setting out of its range.
TurtleWalk startWalk(const ModuleString& string, const TurtleSettings& settings);
/// Executes module `index` of the string. Throws InputError for a value that is not finite or an exceeded limit.
void stepTurtle(TurtleWalk& walk, const ModuleString& string, size_t index);

/// Walks the whole string. Warns (kGrammar) about brackets and polygon signs that match nothing and about divisions by 0.
TurtlePath runTurtle(const ModuleString& string, const TurtleSettings& settings, Warnings& warnings);

/// The value of an attribute at a point, or nullptr if the point does not have it.
const TurtleAttribute* findAttribute(const TurtlePath& path, const TurtlePoint& point, std::string_view name);

}  // namespace cloudbake
