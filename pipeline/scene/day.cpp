#include "pipeline/scene/day.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "preview/camera.h"

namespace cloudbake {

SunCircle::SunCircle(const SunAngles& noon)
    : rise_(directionFromAngles(noon.azimuth_degrees - 90, 0)), noon_(directionFromAngles(noon.azimuth_degrees, noon.elevation_degrees)) {}

Vec3 SunCircle::directionAt(double degrees) const {
  const double angle = degrees * kPi / 180;
  return normalized(rise_ * float(std::cos(angle)) + noon_ * float(std::sin(angle))).value_or(noon_);
}

SunAngles SunCircle::anglesAt(double degrees) const {
  const Vec3 sun = directionAt(degrees);
  const auto rounded = [](double radians) { return float(std::round(radians * 180e3 / kPi) / 1e3); };
  return {rounded(std::atan2(double(sun.x), double(sun.z))), rounded(std::asin(std::clamp(double(sun.y), -1.0, 1.0)))};
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
