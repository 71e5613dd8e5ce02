// Stands in for the maths library of another system: the functions whose last bit differs between libraries give the neighbouring number
// for two of three arguments. tests/cli/same_with_other_libm loads it before a program (LD_PRELOAD).
#include <dlfcn.h>

#include <bit>
#include <cmath>
#include <cstdint>

namespace {

template <class Function>
Function* found(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

// Results of few digits, such as exp(0) and pow(2, 3), are exact in every library.
template <class Float, class Bits, int kDigits>
Float nudged(Float x) {
  const Bits bits = std::bit_cast<Bits>(x);
  if (!std::isnormal(x) || (bits & ((Bits(1) << kDigits) - 1)) == 0) return x;
  const uint64_t choice = (uint64_t(bits) * 0x9E3779B97F4A7C15ULL >> 32U) % 3;
  return choice == 0 ? x : std::bit_cast<Float>(choice == 1 ? bits + 1 : bits - 1);
}
double otherwise(double x) { return nudged<double, uint64_t, 24>(x); }
float otherwise(float x) { return nudged<float, uint32_t, 8>(x); }

}  // namespace

// NOLINTBEGIN: the names and the parameters are those of <math.h>
#define ONE_OF(type, name)                                 \
  type name(type x) {                                      \
    static const auto original = found<type(type)>(#name); \
    return otherwise(original(x));                         \
  }
#define TWO_OF(type, name)                                       \
  type name(type x, type y) {                                    \
    static const auto original = found<type(type, type)>(#name); \
    return otherwise(original(x, y));                            \
  }
#define SINCOS_OF(type, name)                                            \
  void name(type x, type* sine, type* cosine) {                          \
    static const auto original = found<void(type, type*, type*)>(#name); \
    original(x, sine, cosine);                                           \
    *sine = otherwise(*sine), *cosine = otherwise(*cosine);              \
  }
#define ONE(name) ONE_OF(double, name) ONE_OF(float, name##f)
#define TWO(name) TWO_OF(double, name) TWO_OF(float, name##f)

extern "C" {
ONE(exp)
ONE(exp2)
ONE(expm1)
ONE(log)
ONE(log2)
ONE(log10)
ONE(log1p)
ONE(sin)
ONE(cos)
ONE(tan)
ONE(asin)
ONE(acos)
ONE(atan)
ONE(sinh)
ONE(cosh)
ONE(tanh)
ONE(cbrt)
ONE(erf)
TWO(pow)
TWO(atan2)
TWO(hypot)
SINCOS_OF(double, sincos)
SINCOS_OF(float, sincosf)
}
// NOLINTEND
