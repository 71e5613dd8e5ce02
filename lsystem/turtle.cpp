// Houdini's turtle, as the L-system notes, section 4, describe it. State: position, heading H, up U; right R = H × U.
//   + -  H' = cos a H ± sin a R        & ^  H' = cos a H ∓ sin a U        \ /  U' = cos a U ± sin a R
//   T    rotates H towards -Y by g sin∠(H,-Y) degrees, never past the vertical
//   $    rolls until U is nearest to world +Y, after aiming H at a point if one is given
// After The Algorithmic Beauty of Plants, chapter 1, with left and right exchanged.
#include "lsystem/turtle.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/parallel.h"
#include "core/portable_math.h"
#include "lsystem/keys.h"

namespace cloudbake {

namespace {

// One module with the walk that executes it.
struct Step {
  TurtleWalk& walk;
  const ModuleString& string;
  const Module& module;

  double argument(size_t k, double fallback) const { return argumentOr(string, module, k, fallback); }
  double signedDraw(DrawChannel channel, uint64_t n) const { return 2 * drawUniform(module.key, channel, n) - 1; }
};

[[noreturn]] void fail(const ModuleString& string, const std::string& message) { throw InputError(string.file, message); }

// --- Rotations ---

void turnRight(TurtleState& s, double degrees) {
  const SinCos a = sinCosDegrees(degrees);
  s.heading = s.heading * a.cos + cross(s.heading, s.up) * a.sin;
}

void pitchDown(TurtleState& s, double degrees) {
  const SinCos a = sinCosDegrees(degrees);
  const Double3 heading = s.heading;
  s.heading = heading * a.cos - s.up * a.sin;
  s.up = s.up * a.cos + heading * a.sin;
}

void rollClockwise(TurtleState& s, double degrees) {
  const SinCos a = sinCosDegrees(degrees);
  s.up = s.up * a.cos + cross(s.heading, s.up) * a.sin;
}

Double3 rotateAround(Double3 v, Double3 unit_axis, const SinCos& a) {
  return v * a.cos + cross(unit_axis, v) * a.sin + unit_axis * (dot(unit_axis, v) * (1 - a.cos));
}

// Rotates heading and up by the smallest rotation that turns the heading towards a unit vector, by at most `degrees`. A negative
// `degrees` turns it away, at most to the opposite direction. Does nothing if the two are collinear.
void rotateTowards(TurtleState& s, Double3 target, double degrees) {
  const Double3 axis = cross(s.heading, target);
  const double sine = length(axis);
  if (sine < 1e-12) return;
  const double between = atan2Degrees(sine, dot(s.heading, target));
  const SinCos a = sinCosDegrees(std::clamp(degrees, between - 180, between));
  s.heading = rotateAround(s.heading, axis * (1 / sine), a);
  s.up = rotateAround(s.up, axis * (1 / sine), a);
}

void bendByGravity(TurtleState& s, double gravity) {
  const Double3 down{0, -1, 0};
  rotateTowards(s, down, gravity * length(cross(s.heading, down)));
}

// `$`: aims at a point if one is given, then rolls until up is nearest to +Y. A vertical heading is not rolled.
void rollUpright(const Step& step) {
  TurtleState& s = step.walk.state;
  if (step.module.argument_count > 0) {
    const Double3 target{step.argument(0, 0), step.argument(1, 0), step.argument(2, 0)};
    const Double3 way = target - s.position;
    const double distance = length(way);
    if (!std::isfinite(distance)) fail(step.string, "the point of $(x,y,z) is too far away: keep positions below 1e150");
    if (distance > 0) {
      const bool straight_behind = dot(way, s.heading) < 0 && length(cross(way, s.heading)) < 1e-12 * distance;
      if (straight_behind)
        turnRight(s, 180);
      else
        rotateTowards(s, way * (1 / distance), 180);
    }
  }
  const Double3 world_up{0, 1, 0};
  const Double3 wanted = world_up - s.heading * s.heading.y;
  const double size = length(wanted);
  if (size > 1e-9) s.up = wanted * (1 / size);
}

// Rounding errors grow exponentially with every rotation that mixes heading and up, so these are made orthonormal again long before the
// errors show. Short walks keep the bits of the plain formulas.
void straighten(TurtleState& s) {
  constexpr double kDrift = 1e-13;
  const double drift =
      std::max({std::fabs(dot(s.heading, s.heading) - 1), std::fabs(dot(s.up, s.up) - 1), std::fabs(dot(s.heading, s.up))});
  if (!(drift > kDrift)) return;
  s.heading = s.heading * (1 / length(s.heading));
  s.up = s.up - s.heading * dot(s.heading, s.up);
  s.up = s.up * (1 / length(s.up));
}

// The angle of a rotation: the argument or `fallback`, with growth and random scale.
double rotationOf(const Step& step, double fallback) {
  const TurtleSettings& settings = *step.walk.settings;
  double degrees = step.argument(0, fallback);
  if (settings.continuous_angles) degrees *= growthOf(step.string, step.module);
  if (settings.random_scale_all && settings.random_scale != 0)
    degrees *= 1 + settings.random_scale * step.signedDraw(DrawChannel::kAngle, 0);
  return degrees;
}

void rotate(const Step& step) {
  TurtleState& s = step.walk.state;
  const double pitch_sense = step.walk.settings->pitch_up ? -1 : 1;
  switch (step.module.symbol) {
    case '+': turnRight(s, rotationOf(step, s.angle)); break;
    case '-': turnRight(s, -rotationOf(step, s.angle)); break;
    case '&': pitchDown(s, pitch_sense * rotationOf(step, s.angle)); break;
    case '^': pitchDown(s, -pitch_sense * rotationOf(step, s.angle)); break;
    case '\\': rollClockwise(s, rotationOf(step, s.angle)); break;
    case '/': rollClockwise(s, -rotationOf(step, s.angle)); break;
    case '|': turnRight(s, rotationOf(step, 180)); break;
    case '*': rollClockwise(s, rotationOf(step, 180)); break;
    case 'T': bendByGravity(s, rotationOf(step, step.walk.settings->gravity)); break;
    case '$': rollUpright(step); break;
    case '~': {
      const double range = rotationOf(step, 180);
      pitchDown(s, range * step.signedDraw(DrawChannel::kTumble, 0));
      rollClockwise(s, range * step.signedDraw(DrawChannel::kTumble, 1));
      turnRight(s, range * step.signedDraw(DrawChannel::kTumble, 2));
      break;
    }
    default: break;
  }
  straighten(s);
}

// --- Moves ---

TurtlePoint pointAt(const Step& step, double width, int segments, int section) {
  const TurtleState& s = step.walk.state;
  TurtlePoint point;
  point.position = s.position;
  point.heading = toFloat(s.heading);
  point.up = toFloat(s.up);
  point.width = width;
  point.arc = s.arc;
  point.lage = s.lage;
  point.u = float(s.u);
  point.v = float(s.v);
  point.growth = step.walk.settings->continuous_width ? float(growthOf(step.string, step.module)) : 1;
  point.gen = step.module.birth;
  point.group = s.group;
  point.previous = s.current;
  point.segments = segments;
  point.section = section;
  point.depth = int(step.walk.stack.size());
  point.attributes = s.attributes;
  point.key = step.module.key;
  return point;
}

void checkRoom(const Step& step) {
  const TurtleWalk& walk = step.walk;
  if (walk.path.points.size() + walk.path.leaves.size() + walk.attribute_values >= walk.settings->max_points)
    fail(step.string, "the turtle makes more than " + std::to_string(walk.settings->max_points) +
                          " points, leaves and attributes: use fewer generations, segments or a(…), or raise max_points");
}

void recordPoint(const Step& step, double width, int segments, int section) {
  TurtleWalk& walk = step.walk;
  if (!walk.records) return;
  checkRoom(step);
  walk.path.points.push_back(pointAt(step, width, segments, section));
  walk.state.current = int(walk.path.points.size()) - 1;
}

void advance(const Step& step, double distance) {
  TurtleState& s = step.walk.state;
  s.position = s.position + s.heading * distance;
  s.arc += std::fabs(distance);
  if (!isFinite(toFloat(s.position)))
    fail(step.string, std::string("the turtle leaves the range of numbers at a \"") + step.module.symbol + "\" of generation " +
                          std::to_string(step.module.birth) + ": use smaller lengths or fewer generations");
}

double lengthOf(const Step& step) {
  const TurtleSettings& settings = *step.walk.settings;
  double distance = step.argument(0, step.walk.state.step);
  if (step.module.symbol == 'H' || step.module.symbol == 'h') distance *= 0.5;
  if (settings.continuous_length) distance *= growthOf(step.string, step.module);
  if (settings.random_scale != 0) distance *= 1 + settings.random_scale * step.signedDraw(DrawChannel::kLength, 0);
  return distance;
}

int segmentsOf(const Step& step) {
  const double asked = step.argument(2, step.walk.settings->segments);
  if (!(asked >= 1 && asked <= 10000))
    fail(step.string, std::string("the third argument of ") + step.module.symbol + " (segments) must be from 1 to 10000");
  return int(std::floor(asked + 1e-6));
}

void drawSegment(const Step& step) {
  TurtleState& s = step.walk.state;
  const TurtleSettings& settings = *step.walk.settings;
  const double distance = lengthOf(step);
  double width = step.argument(1, s.width);
  if (settings.random_scale_all && settings.random_scale != 0) width *= 1 + settings.random_scale * step.signedDraw(DrawChannel::kWidth, 0);
  const int segments = segmentsOf(step);
  if (s.current < 0) recordPoint(step, width, segments, 0);
  const Double3 start = s.position;
  const double start_arc = s.arc;
  for (int k = step.walk.records ? 1 : segments; k <= segments; ++k) {
    s.position = start;
    s.arc = start_arc;
    advance(step, distance * (double(k) / segments));
    if (k == segments) s.lage += settings.vertical_increment;
    recordPoint(step, width, segments, k);
  }
}

void placeLeaf(const Step& step) {
  TurtleWalk& walk = step.walk;
  if (!walk.records) return;
  checkRoom(step);
  TurtleLeaf leaf{step.module.symbol, pointAt(step, walk.state.width, 1, 0), step.argument(0, walk.state.step), {}};
  for (size_t k = 0; k < 3; ++k) leaf.values[k] = step.argument(k + 2, 0);
  walk.path.leaves.push_back(leaf);
}

void move(const Step& step) {
  TurtleState& s = step.walk.state;
  switch (step.module.symbol) {
    case 'F':
    case 'H': drawSegment(step); break;
    case 'f':
    case 'h':
      advance(step, lengthOf(step));
      s.current = -1;
      break;
    case 'G':
      advance(step, lengthOf(step));
      s.lage += step.walk.settings->vertical_increment;
      break;
    default: placeLeaf(step); break;
  }
}

// --- Scales, colour, groups, attributes ---

void scale(const Step& step, double& value, double fallback, bool divides) {
  double factor = step.argument(0, fallback);
  if (divides && factor == 0) {
    ++step.walk.zero_divisors;
    factor = 1;
  }
  value = divides ? value / factor : value * factor;
  if (!std::isfinite(value))
    fail(step.string, std::string("the scales \"") + step.module.symbol + "\" leave the range of numbers at generation " +
                          std::to_string(step.module.birth) + ": use scales nearer to 1 or fewer generations");
}

void changeState(const Step& step) {
  TurtleState& s = step.walk.state;
  const TurtleSettings& settings = *step.walk.settings;
  switch (step.module.symbol) {
    case '"': scale(step, s.step, settings.step_scale, false); break;
    case '_': scale(step, s.step, settings.step_scale, true); break;
    case '!': scale(step, s.width, settings.thickness_scale, false); break;
    case '?': scale(step, s.width, settings.thickness_scale, true); break;
    case ';': scale(step, s.angle, settings.angle_scale, false); break;
    case '@': scale(step, s.angle, settings.angle_scale, true); break;
    case '\'': s.u += step.argument(0, settings.uv_increment); break;
    case '#': s.v += step.argument(0, settings.uv_increment); break;
    default: break;
  }
}

void setGroup(const Step& step) {
  TurtleWalk& walk = step.walk;
  const double group = step.argument(0, walk.next_group);
  if (!(group >= -1 && group <= 1e9)) fail(step.string, "g(i) takes a group number from 0 to 1e9, or -1 for none");
  walk.state.group = int(std::floor(group + 1e-6));
  walk.next_group = std::max(walk.next_group, walk.state.group + 1);
}

void setAttribute(const Step& step) {
  TurtleWalk& walk = step.walk;
  if (step.module.text < 0 || !walk.records) return;
  checkRoom(step);
  auto& sets = walk.path.attribute_sets;
  TurtleAttribute attribute{step.module.text, std::clamp(int(step.module.argument_count) - 1, 1, 3), {}};
  for (size_t k = 0; k < 3; ++k) attribute.values[k] = step.argument(k + 1, 0);
  auto set = walk.state.attributes < 0 ? std::vector<TurtleAttribute>{} : sets[size_t(walk.state.attributes)];
  const auto same = std::find_if(set.begin(), set.end(), [&](const TurtleAttribute& a) { return a.name == attribute.name; });
  if (same == set.end())
    set.push_back(attribute);
  else
    *same = attribute;
  walk.attribute_values += set.size();
  sets.push_back(std::move(set));
  walk.state.attributes = int(sets.size()) - 1;
}

// --- Brackets and polygons ---

void branch(const Step& step) {
  TurtleWalk& walk = step.walk;
  if (step.module.symbol == '[') {
    if (int(walk.stack.size()) >= walk.settings->max_depth)
      fail(step.string, "more than " + std::to_string(walk.settings->max_depth) + " open brackets: close branches, or raise max_depth");
    walk.stack.push_back(walk.state);
  } else if (walk.stack.empty()) {
    ++walk.unmatched_pops;
  } else {
    walk.state = walk.stack.back();
    walk.stack.pop_back();
  }
}

void drawPolygon(const Step& step) {
  TurtleWalk& walk = step.walk;
  if (!walk.records) return;
  if (step.module.symbol == '{') {
    walk.open_polygons.emplace_back();
  } else if (walk.open_polygons.empty()) {
    ++walk.unmatched_polygons;
  } else if (step.module.symbol == '.') {
    walk.open_polygons.back().push_back(walk.state.position);
  } else {
    walk.path.polygons.push_back(std::move(walk.open_polygons.back()));
    walk.open_polygons.pop_back();
  }
}

void checkSettings(const ModuleString& string, const TurtleSettings& s) {
  for (const double value :
       {s.step, s.step_scale, s.angle, s.angle_scale, s.thickness_scale, s.gravity, s.uv_increment, s.vertical_increment,
        s.start_position.x, s.start_position.y, s.start_position.z, s.start_rotation.x, s.start_rotation.y, s.start_rotation.z})
    if (!std::isfinite(value)) fail(string, "a turtle setting is not finite: give every setting a number");
  if (!(s.thickness > 0) || !std::isfinite(s.thickness)) fail(string, "the turtle's thickness must be positive");
  if (!(s.random_scale >= 0 && s.random_scale <= 1)) fail(string, "random_scale must be from 0 to 1");
  if (s.segments < 1 || s.segments > 10000) fail(string, "segments must be from 1 to 10000");
}

}  // namespace

TurtleWalk startWalk(const ModuleString& string, const TurtleSettings& settings) {
  checkSettings(string, settings);
  TurtleWalk walk;
  walk.settings = &settings;
  TurtleState& s = walk.state;
  s.position = settings.start_position;
  s.step = settings.step;
  s.angle = settings.angle;
  s.width = settings.thickness;
  const Double3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const double angles[3] = {settings.start_rotation.x, settings.start_rotation.y, settings.start_rotation.z};
  for (size_t k = 0; k < 3; ++k) {
    const SinCos a = sinCosDegrees(angles[k]);
    s.heading = rotateAround(s.heading, axes[k], a);
    s.up = rotateAround(s.up, axes[k], a);
  }
  return walk;
}

void stepTurtle(TurtleWalk& walk, const ModuleString& string, size_t index) {
  const Step step{walk, string, string.modules[index]};
  switch (step.module.symbol) {
    case 'F':
    case 'H':
    case 'G':
    case 'f':
    case 'h':
    case 'J':
    case 'K':
    case 'M': move(step); break;
    case '+':
    case '-':
    case '&':
    case '^':
    case '\\':
    case '/':
    case '|':
    case '*':
    case '~':
    case 'T':
    case '$': rotate(step); break;
    case '"':
    case '_':
    case '!':
    case '?':
    case ';':
    case '@':
    case '\'':
    case '#': changeState(step); break;
    case '[':
    case ']': branch(step); break;
    case '{':
    case '.':
    case '}': drawPolygon(step); break;
    case 'g': setGroup(step); break;
    case 'a': setAttribute(step); break;
    default: break;
  }
}

TurtlePath runTurtle(const ModuleString& string, const TurtleSettings& settings, Warnings& warnings) {
  TurtleWalk walk = startWalk(string, settings);
  walk.path.texts = string.texts;
  walk.path.thickness = settings.thickness;
  walk.path.step = settings.step == 0 ? 1 : std::fabs(settings.step);
  walk.path.file = string.file;
  const auto draws =
      std::count_if(string.modules.begin(), string.modules.end(), [](const Module& m) { return m.symbol == 'F' || m.symbol == 'H'; });
  const uint64_t points = std::min<uint64_t>(uint64_t(draws) * uint64_t(settings.segments) + 1, settings.max_points);
  requireMemory({"a turtle's path of " + std::to_string(points) + " points", double(points) * sizeof(TurtlePoint),
                 "use fewer generations or segments, or lower max_points"},
                settings.memory_limit, string.file);
  walk.path.points.reserve(points);
  for (size_t i = 0; i < string.modules.size(); ++i) {
    throwIfLoopsStop();
    stepTurtle(walk, string, i);
  }

  const std::string place = string.file.empty() ? "" : string.file + ": ";
  warnings.add(WarningKind::kGrammar, place + "a \"]\" closes no branch and was ignored", walk.unmatched_pops);
  warnings.add(WarningKind::kGrammar, place + "a \".\" or \"}\" is outside a polygon and was ignored", walk.unmatched_polygons);
  warnings.add(WarningKind::kGrammar, place + "a polygon \"{\" is never closed and was dropped", walk.open_polygons.size());
  warnings.add(WarningKind::kGrammar, place + "a scale divides by 0, which counts as 1", walk.zero_divisors);
  return std::move(walk.path);
}

const TurtleAttribute* findAttribute(const TurtlePath& path, const TurtlePoint& point, std::string_view name) {
  if (point.attributes < 0) return nullptr;
  for (const TurtleAttribute& attribute : path.attribute_sets[size_t(point.attributes)])
    if (path.texts[size_t(attribute.name)] == name) return &attribute;
  return nullptr;
}

}  // namespace cloudbake
