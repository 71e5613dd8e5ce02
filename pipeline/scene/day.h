// The way of sun, moon and stars over a day.
#pragma once

#include <string>

#include "core/vec3.h"

namespace cloudbake {

/// Where the sun is, as on the command line.
struct SunAngles {
  float azimuth_degrees, elevation_degrees;
};

/// The great circle of the sun on a day on which it is highest at `noon`: through there, and through the horizon 90 degrees of azimuth
/// before, where its way begins.
class SunCircle {
 public:
  explicit SunCircle(const SunAngles& noon);
  /// Unit, so many degrees from the beginning.
  Vec3 directionAt(double degrees) const;
  /// The same as angles, rounded to a thousandth of a degree, so that they can be written down.
  SunAngles anglesAt(double degrees) const;
  /// Unit: the axis about which sky and sun turn, counter-clockwise for who looks along it from its tip.
  Vec3 axis() const;

 private:
  Vec3 rise_, noon_;
};

/// The hours of a scene.
struct Day {
  double hour = 12;    ///< of day at time 0, 0 … 24; the sun rises at 6 and is highest at 12
  double seconds = 0;  ///< of the scene's time in a day; 0: the hour does not change
  SunAngles noon{};    ///< of the highest sun

  /// Of the sun on its circle, 0 … 360.
  double degreesAt(double time_seconds) const;
  /// The time of day to the minute, as in "08:30"; "00:00" to "23:59".
  std::string clockAt(double time_seconds) const;
};

/// Where a moon of this phase (−180 … 180, 0 = full) is on the sun's circle when the sun is at `sun_degrees`: opposite if it is full,
/// behind the sun by 180 − phase if it grows, before it if it wanes (a negative phase).
double moonDegrees(double sun_degrees, double phase_degrees);

}  // namespace cloudbake
