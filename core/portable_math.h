// Functions of <cmath> that have the same bits with every C library and on every CPU. Those of C libraries differ in the last bit from each
// other, and glibc's functions of doubles also from CPU to CPU.
//
// Where a value reaches a file that the program writes, only these functions, those of core/exp_log.h, and the functions of <cmath> that
// are exact everywhere may be used (sqrt, fabs, floor, round, fmod, remainder, frexp, ldexp and the like): tests/repo/portable_math. Errors
// are in units in the last place (ulp) of the result and were measured by tests/core/portable_math_test.cpp, whose bounds they are.
#pragma once

namespace cloudbake {

struct SinCos {
  double sin = 0, cos = 1;
};

/// Sine and cosine of an angle in degrees, within 3 ulp for angles of any size; exact at multiples of 90. NaN for infinity.
SinCos sinCosDegrees(double degrees);
/// The tangent, within 6 ulp; infinite at odd multiples of 90.
double tanDegrees(double degrees);
/// The angle of the vector (x, y), in (−π, π] or (−180, 180], within 7 ulp; 0 for the zero vector. NaN if both are infinite.
double portableAtan2(double y, double x);
double atan2Degrees(double y, double x);
/// Inverse sine and cosine in degrees, within 7 ulp, for x in [−1, 1]; NaN beyond.
double asinDegrees(double x);
double acosDegrees(double x);

/// e^x within 1.1 ulp. Of a float it is the nearest float, but for a few of 10⁸ arguments.
double portableExp(double x);
float portableExp(float x);
/// The natural logarithm within 1 ulp; of a float likewise. −∞ for 0, NaN below.
double portableLog(double x);
float portableLog(float x);
/// x^y within 2 (1 + |y ln x|) ulp; of floats within 0.51 ulp. A whole y of at most 1024 means multiplications, within |y| ulp, and 0.5 a
/// square root. NaN for x < 0 and a y that is not whole.
double portablePow(double x, double y);
float portablePow(float x, float y);

}  // namespace cloudbake
