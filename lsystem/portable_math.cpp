// Taylor series after an argument reduction that keeps them short. Only + - * / sqrt and exact functions are used.
//   sin, cos: degrees = 90 q + r with |r| <= 45 (exact, remquo), then to r^17 and r^16: the next term is below 3e-18
//   atan:     atan x = 2 atan(x / (1 + sqrt(1 + x²))) twice, then |x| <= tan(pi/16) = 0.199, to x^23
//   log:      x = m 2^e with m in [sqrt(1/2), sqrt 2), log m = 2 artanh((m-1)/(m+1)), to s^23
//   exp:      x = k ln 2 + r with |r| <= ln(2)/2, to r^15
#include "lsystem/portable_math.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/vec3.h"

namespace cloudbake {

namespace {

constexpr double kRadians = kPi / 180, kDegrees = 180 / kPi;
constexpr double kLn2High = 6.93147180369123816490e-01, kLn2Low = 1.90821492927058770002e-10;

// 1/n! for n = first, first + 2, …, with alternating signs.
constexpr std::array<double, 9> alternatingFactorials(int first) {
  std::array<double, 9> coefficients{};
  double value = 1;
  for (int k = 0; k < 9; ++k) {
    coefficients[size_t(k)] = value;
    value /= -double((first + 2 * k + 1) * (first + 2 * k + 2));
  }
  return coefficients;
}
constexpr std::array<double, 9> kSinTerms = alternatingFactorials(1), kCosTerms = alternatingFactorials(0);

// Σ terms[k] s^k by Horner's rule.
double sumSeries(const std::array<double, 9>& terms, double s) {
  double sum = terms[8];
  for (size_t k = 8; k-- > 0;) sum = terms[k] + s * sum;
  return sum;
}

// atan of x in [0, 1], radians.
double atanUnit(double x) {
  x = x / (1 + std::sqrt(1 + x * x));
  x = x / (1 + std::sqrt(1 + x * x));
  const double s = x * x;
  double sum = 1.0 / 23;
  for (int k = 21; k >= 1; k -= 2) sum = 1.0 / k - s * sum;
  return 4 * x * sum;
}

// Natural logarithm of a finite x > 0.
double logPositive(double x) {
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < 0.70710678118654752) {
    m *= 2;
    --exponent;
  }
  const double t = (m - 1) / (m + 1), s = t * t;
  double sum = 1.0 / 23;
  for (int k = 21; k >= 1; k -= 2) sum = 1.0 / k + s * sum;
  return exponent * kLn2High + (2 * t * sum + exponent * kLn2Low);
}

double expOf(double x) {
  if (x > 710) return std::numeric_limits<double>::infinity();
  if (x < -745) return 0;
  const double k = std::nearbyint(x * (1 / 0.693147180559945309417)), r = (x - k * kLn2High) - k * kLn2Low;
  double sum = 1;
  for (int n = 15; n >= 1; --n) sum = 1 + r / n * sum;
  return std::ldexp(sum, int(k));
}

double powInteger(double x, int n) {
  double result = 1;
  for (unsigned bits = unsigned(std::abs(n)); bits != 0; bits >>= 1, x *= x)
    if (bits & 1U) result *= x;
  return n < 0 ? 1 / result : result;
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

SinCos sinCosDegrees(double degrees) {
  int quadrant = 0;
  // Long double is used because the processor reduces it by 63 bits at a time. The remainder is exact either way.
  const double r = double(std::remquo(static_cast<long double>(withoutTurns(degrees)), 90.0L, &quadrant)) * kRadians,
               s = r * sumSeries(kSinTerms, r * r), c = sumSeries(kCosTerms, r * r);
  switch (unsigned(quadrant) & 3U) {
    case 0: return {s, c};
    case 1: return {c, -s};
    case 2: return {-s, -c};
    default: return {-c, s};
  }
}

double atan2Degrees(double y, double x) {
  const double ax = std::fabs(x), ay = std::fabs(y), large = std::fmax(ax, ay);
  if (!(large > 0)) return std::isnan(x) || std::isnan(y) ? std::numeric_limits<double>::quiet_NaN() : 0;
  double angle = atanUnit(std::fmin(ax, ay) / large) * kDegrees;
  if (ay > ax) angle = 90 - angle;
  if (x < 0) angle = 180 - angle;
  return y < 0 ? -angle : angle;
}

double asinDegrees(double x) { return atan2Degrees(x, std::sqrt((1 - x) * (1 + x))); }
double acosDegrees(double x) { return atan2Degrees(std::sqrt((1 - x) * (1 + x)), x); }

double portablePow(double x, double y) {
  if (y == std::floor(y) && std::fabs(y) <= 1024) return powInteger(x, int(y));
  if (y == 0.5) return std::sqrt(x);
  if (!(x > 0) || !std::isfinite(x) || !std::isfinite(y)) {
    if (x == 0 && y > 0) return 0;
    if (x == 0 && y < 0) return std::numeric_limits<double>::infinity();
    return std::numeric_limits<double>::quiet_NaN();
  }
  return expOf(y * logPositive(x));
}

}  // namespace cloudbake
