#include "io/sculpt/file_frame.h"

#include <charconv>
#include <cmath>

#include "core/error.h"
#include "core/sculpt.h"
#include "core/text/scan.h"
#include "io/sculpt/xml_tags.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// The number with the fewest digits that gives this float: 0.0254, not 0.02539999969.
double asWritten(float value) {
  char digits[32];
  const auto end = std::to_chars(std::begin(digits), std::end(digits), value).ptr;
  return parseNumber({digits, size_t(end - digits)}).value_or(value);
}

double unitNamed(const fs::path& file, const std::string& format, std::string_view name) {
  static constexpr std::pair<std::string_view, double> kUnits[] = {{"micron", 1e-6},     {"millimeter", 1e-3}, {"millimeters", 1e-3},
                                                                   {"centimeter", 1e-2}, {"inch", 0.0254},     {"foot", 0.3048},
                                                                   {"feet", 0.3048},     {"meter", 1}};
  for (const auto& [unit, metres] : kUnits)
    if (lowerCase(name) == unit) return metres;
  throw InputError(file.string(), "the " + format + " has the unit " + quotedWord(name) +
                                      ", which is none of its format; export it again, in millimetres");
}

// The unit attribute of the file's first element.
FileFrame printedFrame(const fs::path& file, std::string_view xml, const std::string& format) {
  FileFrame frame;
  const auto root = XmlTags(xml).next();
  frame.metres_per_unit = unitNamed(file, format, root ? attributeOf(*root, "unit").value_or("millimeter") : "millimeter");
  frame.says_unit = true;
  return frame;
}

int axisOf(const FbxProperties& settings, std::string_view name, int otherwise) {
  const auto found = settings.find(name);
  if (found == settings.end()) return otherwise;
  const double value = found->second[0];
  return value == 0 || value == 1 || value == 2 || value == -1 ? int(value) : 99;
}

}  // namespace

Affine FileFrame::toScene() const {
  std::array<double, 3> x{}, y{};
  x[size_t(right)] = right_sign, y[size_t(up)] = up_sign;
  const double z_sign = is_left_handed ? -1 : 1;
  std::array<double, 3> z{x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
  for (double& value : z) value *= z_sign;
  Affine frame{{{x, y, z}}, {0, 0, 0}};
  for (auto& row : frame.linear)
    for (double& value : row) value *= metres_per_unit;
  return frame;
}

ReadSettings FileFrame::wanted(const ReadSettings& settings) const {
  ReadSettings wanted = settings;
  if (settings.frame_if_unstated && says_unit) wanted.metres_per_unit.reset();
  if (settings.frame_if_unstated && says_axes) wanted.up_axis.reset();
  return wanted;
}

FileFrame FileFrame::replacedBy(const ReadSettings& settings) const {
  FileFrame frame = *this;
  frame.metres_per_unit = settings.metres_per_unit.value_or(metres_per_unit);
  if (settings.up_axis) {
    frame.up = int(*settings.up_axis), frame.up_sign = 1;
    frame.right = frame.up == 0 ? 1 : 0, frame.right_sign = frame.up == 0 ? -1 : 1;
    frame.is_left_handed = false;
  }
  return frame;
}

std::string FileFrame::text(const ReadSettings& settings) const {
  enum Source { kGiven, kFile, kAssumed };
  const Source unit = settings.metres_per_unit ? kGiven : says_unit ? kFile : kAssumed;
  const Source axis = settings.up_axis ? kGiven : says_axes ? kFile : kAssumed;
  const char* source = unit == kGiven && axis == kGiven       ? "as given"
                       : unit == kFile && axis == kFile       ? "as the file says"
                       : unit == kAssumed && axis == kAssumed ? "assumed, the file does not say"
                       : unit != kGiven && axis != kGiven     ? "one as the file says, the other assumed"
                       : unit == kFile || axis == kFile       ? "one given, the other as the file says"
                                                              : "one given, the other assumed";
  const FileFrame frame = replacedBy(settings);
  return frameText(frame.metres_per_unit, "XYZ"[frame.up], frame.up_sign < 0, source) + (frame.is_left_handed ? "; left-handed" : "");
}

FileFrame frameOfFbx(const fs::path& file, const FbxProperties& settings) {
  FileFrame frame;
  frame.unit_name = "centimetres";
  frame.right = axisOf(settings, "CoordAxis", 0), frame.up = axisOf(settings, "UpAxis", 1);
  frame.right_sign = axisOf(settings, "CoordAxisSign", 1), frame.up_sign = axisOf(settings, "UpAxisSign", 1);
  const auto unit = settings.find("UnitScaleFactor");  // centimetres
  frame.says_unit = unit != settings.end(), frame.says_axes = settings.contains("UpAxis");
  frame.metres_per_unit = frame.says_unit ? unit->second[0] / 100 : 0.01;
  const auto is_axis = [](int axis) { return axis >= 0 && axis <= 2; };
  if (!is_axis(frame.right) || !is_axis(frame.up) || frame.right == frame.up || std::abs(frame.right_sign) != 1 ||
      std::abs(frame.up_sign) != 1 || !(frame.metres_per_unit > 0) || !std::isfinite(frame.metres_per_unit))
    throw InputError(file.string(), "the axes or the unit in the FBX are invalid; export it again");
  // The third axis has a sign of its own. It says the handedness, unless it repeats one of the others.
  const int front = axisOf(settings, "FrontAxis", 99), front_sign = axisOf(settings, "FrontAxisSign", 99);
  if (!is_axis(front) || front == frame.up || front == frame.right || std::abs(front_sign) != 1) return frame;
  const double completed = frame.right_sign * frame.up_sign * (frame.up == (frame.right + 1) % 3 ? 1 : -1);
  frame.is_left_handed = completed != front_sign;
  return frame;
}

FileFrame frameOfCollada(const fs::path& file, const Affine& root) {
  for (const int up : {1, 2, 0}) {
    FileFrame frame;
    frame.up = up;
    if (up == 0) frame.right = 1, frame.right_sign = -1;
    const double metres = root.linear[2][up == 2 ? 1 : 2] * (up == 2 ? -1 : 1);
    frame.metres_per_unit = metres;
    if (frame.toScene().linear != root.linear || !(metres > 0) || !std::isfinite(metres)) continue;
    frame.metres_per_unit = asWritten(float(metres));
    frame.says_unit = frame.says_axes = true;  // the format has defaults
    return frame;
  }
  throw InputError(file.string(), "the unit of the Collada scene is invalid; correct <unit meter=\"…\"/>");
}

FileFrame frameOf3mf(const fs::path& file, std::string_view model) {
  FileFrame frame = printedFrame(file, model, "3MF");
  frame.up = 2;
  frame.says_axes = true;
  return frame;
}

FileFrame frameOfAmf(const fs::path& file, std::string_view xml) { return printedFrame(file, xml, "AMF"); }

}  // namespace cloudbake
