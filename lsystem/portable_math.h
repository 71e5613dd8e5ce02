// Trigonometry in degrees, and powers, with the same bits on every x86-64 CPU. (Results of glibc's double functions differ between
// CPUs.) The relative error is about 1e-15. NaN and infinity propagate as in IEEE arithmetic.
#pragma once

namespace cloudbake {

struct SinCos {
  double sin = 0, cos = 1;
};

/// Sine and cosine of an angle in degrees; exact at multiples of 90.
SinCos sinCosDegrees(double degrees);
/// Angle of the vector (x, y) in degrees, (-180, 180]; 0 for the zero vector.
double atan2Degrees(double y, double x);
/// Inverse sine and cosine in degrees for x in [-1, 1].
double asinDegrees(double x);
double acosDegrees(double x);
/// x^y. Uses multiplications if y is a small integer and a square root if y is 0.5. NaN for a negative x and a y that is not whole.
double portablePow(double x, double y);

}  // namespace cloudbake
