// Which SIMD targets of Highway the CPU supports, without libhwy, which calibrates a timer for 4 ms whenever it is loaded.
#pragma once

#include <hwy/targets.h>

#include <cstdint>

#if HWY_ARCH_X86 && defined(__GNUC__)
#include <cpuid.h>
#endif

namespace cloudbake {

#if HWY_ARCH_X86 && defined(__GNUC__)
#define CLOUDBAKE_FINDS_SIMD_TARGETS 1

/// The targets that kernels are compiled for and that the CPU and the operating system support, as a mask of HWY_ constants. It equals
/// hwy::SupportedTargets() & HWY_TARGETS. The features of a target are those in Highway's g3doc/quick_reference.md.
inline int64_t supportedSimdTargets() {
  __builtin_cpu_init();
  // What clang's __builtin_cpu_supports has no words for.
  const auto word = [](unsigned leaf) {
    unsigned eax = 0, ebx = 0, ecx = 0, edx = 0;
    return __get_cpuid(leaf, &eax, &ebx, &ecx, &edx) ? ecx : 0;
  };
  const bool f16c = word(1) & bit_F16C, lzcnt = word(0x80000001) & bit_LZCNT;
  const bool ssse3 = __builtin_cpu_supports("ssse3");
  const bool sse4 = ssse3 && __builtin_cpu_supports("sse4.1") && __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("pclmul") &&
                    __builtin_cpu_supports("aes");
  const bool avx2 = sse4 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
                    __builtin_cpu_supports("bmi2") && f16c && lzcnt;
  const bool avx3 = avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
                    __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd");
  const int64_t found = HWY_EMU128 | (ssse3 ? HWY_SSSE3 : 0) | (sse4 ? HWY_SSE4 : 0) | (avx2 ? HWY_AVX2 : 0) | (avx3 ? HWY_AVX3 : 0);
  return found & HWY_TARGETS;
}
#endif

}  // namespace cloudbake
