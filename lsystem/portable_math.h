// Trigonometry in degrees and powers with the same bits on every x86-64 CPU (glibc's double functions differ between
// CPUs). Relative error about 1e-15. NaN and infinity follow from the operands as in IEEE arithmetic.
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
/// x^y; multiplications where y is a small integer, a root where y is 0.5. NaN for a negative x and a broken y.
double portablePow(double x, double y);

}  // namespace cloudbake
