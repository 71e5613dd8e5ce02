#include "pipeline/scene/day.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/portable_math.h"
#include "preview/camera.h"

namespace cloudbake {

SunCircle::SunCircle(const SunAngles& noon)
    : rise_(directionFromAngles(noon.azimuth_degrees - 90, 0)), noon_(directionFromAngles(noon.azimuth_degrees, noon.elevation_degrees)) {}

Vec3 SunCircle::directionAt(double degrees) const {
  const SinCos angle = sinCosDegrees(degrees);
  return normalized(rise_ * float(angle.cos) + noon_ * float(angle.sin)).value_or(noon_);
}

SunAngles SunCircle::anglesAt(double degrees) const {
  const Vec3 sun = directionAt(degrees);
  const auto rounded = [](double angle) { return float(std::round(angle * 1e3) / 1e3); };
  return {rounded(atan2Degrees(sun.x, sun.z)), rounded(asinDegrees(std::clamp(double(sun.y), -1.0, 1.0)))};
}

Vec3 SunCircle::axis() const { return normalized(cross(rise_, noon_)).value_or(Vec3{0, 1, 0}); }

double Day::degreesAt(double time_seconds) const {
  const double days = hour / 24 + (seconds > 0 ? time_seconds / seconds : 0) - 0.25;
  return 360 * (days - std::floor(days));
}

std::string Day::clockAt(double time_seconds) const {
  const int minutes = int(std::lround(degreesAt(time_seconds) * 4) + 6 * 60) % (24 * 60);  // the sun rises at 6
  return fmt::format("{:02}:{:02}", minutes / 60, minutes % 60);
}

double moonDegrees(double sun_degrees, double phase_degrees) {
  return phase_degrees < 0 ? sun_degrees + (180 + phase_degrees) : sun_degrees - (180 - phase_degrees);
}

}  // namespace cloudbake
