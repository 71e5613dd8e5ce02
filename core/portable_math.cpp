// Taylor series after an argument reduction that keeps them short (J.-M. Muller, "Elementary Functions: Algorithms and Implementation", 3rd
// edition, 2016, chapters 9 and 11; the logarithm of 2 in two parts, so that its multiples are exact: W. Cody, W. Waite, "Software Manual
// for the Elementary Functions", 1980). Only + - * / sqrt, integers and exact functions are used.
//   sin, cos: degrees = 90 q + r with |r| <= 45 (exact), then to r^17 and r^16: the next term is below 3e-18
//   atan:     atan x = 2 atan(x / (1 + sqrt(1 + x²))) twice, then |x| <= tan(pi/16) = 0.199, to x^23
//   log:      x = m 2^e with m = 1 + f in [sqrt(1/2), sqrt 2) and t = f / (2 + f), log m = 2 artanh t, to t^25. As 2 t = f - t f, it is
//             f - (f²/2 - t (f²/2 + R)) with R = 2 t² (1/3 + t²/5 + …), whose first term has no rounding
//   exp:      x = k ln 2 + r with |r| <= ln(2)/2, to r^14
#include "core/portable_math.h"

#include <array>
#include <bit>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/vec3.h"

namespace cloudbake {

namespace {

static_assert(FLT_EVAL_METHOD == 0 && std::numeric_limits<double>::is_iec559, "every operation must round to its own type");

constexpr double kRadians = kPi / 180, kDegrees = 180 / kPi;
constexpr double kLn2High = 6.93147180369123816490e-01, kLn2Low = 1.90821492927058770002e-10;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

template <size_t N>
using Terms = std::array<double, N>;

// 1/n! for n = first, first + step, …, of which each is `sign` times the other.
template <size_t N>
constexpr Terms<N> factorials(int first, int step, double sign) {
  Terms<N> terms{};
  double value = 1;
  for (int n = 2; n <= first; ++n) value /= n;
  for (size_t k = 0; k < N; ++k) {
    terms[k] = value;
    const int n = first + int(k) * step;
    for (int i = 1; i <= step; ++i) value /= n + i;
    value *= sign;
  }
  return terms;
}

// 1/first, sign/(first + 2), 1/(first + 4), …
constexpr Terms<12> oddParts(int first, double sign) {
  Terms<12> terms{};
  double value = 1;
  for (size_t k = 0; k < terms.size(); ++k, value *= sign) terms[k] = value / (first + 2 * int(k));
  return terms;
}

constexpr Terms<9> kSinTerms = factorials<9>(1, 2, -1), kCosTerms = factorials<9>(0, 2, -1);
constexpr Terms<13> kExpTerms = factorials<13>(2, 1, 1);
constexpr Terms<12> kAtanTerms = oddParts(1, -1), kArtanhTerms = oddParts(3, 1);

// Σ terms[k] s^k, the even and the odd powers each by Horner's rule: a processor computes both side by side.
template <size_t N>
double sumSeries(const Terms<N>& terms, double s) {
  const double square = s * s;
  double even = 0, odd = 0;
  for (size_t k = N; k-- > 0;) {
    double& sum = k % 2 == 0 ? even : odd;
    sum = terms[k] + square * sum;
  }
  return even + s * odd;
}

// The nearest whole number, for |x| < 2^51.
double nearest(double x) { return (x + 0x1.8p52) - 0x1.8p52; }

// 2^n for a normal result.
double powerOfTwo(int n) { return std::bit_cast<double>(uint64_t(n + 1023) << 52U); }

// atan of x in [0, 1], radians.
double atanUnit(double x) {
  x = x / (1 + std::sqrt(1 + x * x));
  x = x / (1 + std::sqrt(1 + x * x));
  return 4 * x * sumSeries(kAtanTerms, x * x);
}

// atan2 where a turn has `turn` units, of which a radian has `radian`.
double atan2In(double y, double x, double turn, double radian) {
  const double ax = std::fabs(x), ay = std::fabs(y), large = ax > ay ? ax : ay;
  if (!(large > 0)) return std::isnan(x) || std::isnan(y) ? kNan : 0;
  double angle = atanUnit((ax > ay ? ay : ax) / large) * radian;
  if (ay > ax) angle = turn / 4 - angle;
  if (x < 0) angle = turn / 2 - angle;
  return y < 0 ? -angle : angle;
}

double powInteger(double x, int n) {
  double result = 1, power = x;
  for (unsigned bits = unsigned(std::abs(n)); bits != 0; bits >>= 1, power *= power)
    if (bits & 1U) result *= power;
  if (n >= 0) return result;
  return std::isinf(result) && !std::isinf(x) ? powInteger(1 / x, -n) : 1 / result;
}

// The same angle within one turn, exactly. From 2^53 on all numbers are whole, m 2^k; 2^(k+12) = 2^k modulo 360 for k >= 3.
double withoutTurns(double degrees) {
  if (!(std::fabs(degrees) >= 0x1p53) || std::isinf(degrees)) return degrees;
  int exponent = 0;
  const int64_t m = int64_t(std::ldexp(std::frexp(std::fabs(degrees), &exponent), 53)), k = exponent - 53;
  const int64_t power = int64_t(1) << (k < 3 ? k : 3 + (k - 3) % 12);
  return std::copysign(double(m % 360 * power % 360), degrees);
}

}  // namespace

// 90 q has no more than 53 bits, and the difference is exact because both are within a factor of 2 (P. Sterbenz, "Floating-Point
// Computation", 1974).
SinCos sinCosDegrees(double degrees) {
  const double angle = withoutTurns(degrees);
  if (!(std::fabs(angle) < 0x1p53)) return {kNan, kNan};
  const double quarters = nearest(angle / 90), r = (angle - 90 * quarters) * kRadians;
  const double s = r * sumSeries(kSinTerms, r * r), c = sumSeries(kCosTerms, r * r);
  switch (uint64_t(int64_t(quarters)) & 3U) {
    case 0: return {s, c};
    case 1: return {c, 0 - s};  // 0 and not −0 where s is 0
    case 2: return {0 - s, -c};
    default: return {-c, s};
  }
}

double tanDegrees(double degrees) {
  const SinCos angle = sinCosDegrees(degrees);
  return angle.sin / angle.cos;
}

double portableAtan2(double y, double x) { return atan2In(y, x, 2 * kPi, 1); }
double atan2Degrees(double y, double x) { return atan2In(y, x, 360, kDegrees); }

double asinDegrees(double x) { return atan2Degrees(x, std::sqrt((1 - x) * (1 + x))); }
double acosDegrees(double x) { return atan2Degrees(std::sqrt((1 - x) * (1 + x)), x); }

double portableExp(double x) {
  if (!(x < 710)) return std::isnan(x) ? kNan : kInfinity;
  if (x < -746) return 0;
  const double k = nearest(x * (1 / 0.693147180559945309417)), r = (x - k * kLn2High) - k * kLn2Low;
  const int n = int(k), half = n / 2;
  return (1 + (r + r * r * sumSeries(kExpTerms, r))) * powerOfTwo(half) * powerOfTwo(n - half);
}

double portableLog(double x) {
  if (!(x > 0)) return x == 0 ? -kInfinity : kNan;
  if (std::isinf(x)) return x;
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < 0.70710678118654752) {
    m *= 2;
    --exponent;
  }
  const double f = m - 1, t = f / (2 + f), half_square = 0.5 * f * f, rest = 2 * t * t * sumSeries(kArtanhTerms, t * t);
  return exponent * kLn2High - ((half_square - (t * (half_square + rest) + exponent * kLn2Low)) - f);
}

double portablePow(double x, double y) {
  if (y == std::floor(y) && std::fabs(y) <= 1024) return powInteger(x, int(y));
  if (y == 0.5) return std::sqrt(x);
  return portableExp(y * portableLog(x));
}

float portableExp(float x) { return float(portableExp(double(x))); }
float portableLog(float x) { return float(portableLog(double(x))); }
float portablePow(float x, float y) { return float(portablePow(double(x), double(y))); }

}  // namespace cloudbake
