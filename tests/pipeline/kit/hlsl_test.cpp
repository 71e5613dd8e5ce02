// GLSL as HLSL. tests/browser/glsl.mjs compares what the kit has of it, value by value.
#include "pipeline/kit/hlsl.h"

#include <gtest/gtest.h>

namespace cloudbake {
namespace {

TEST(Hlsl, HasOtherNamesForTypesAndFunctions) {
  EXPECT_EQ(hlslOf("vec3 f(vec2 a, vec4 b) { return mix(vec3(a, 0.0), fract(b.xyz), b.w); }"),
            "float3 f(float2 a, float4 b) { return lerp(float3(a, 0.0), frac(b.xyz), b.w); }");
  EXPECT_EQ(hlslOf("ivec2 cells = ivec2(0, 1);"), "int2 cells = int2(0, 1);");
}

TEST(Hlsl, ChangesWholeWordsOutsideOfComments) {
  const char* const text = "// A mix of vec3, as vec3.\nfloat my_vec3 = mixed * vec3s;  // mix\n";
  EXPECT_EQ(hlslOf(text), text);
}

TEST(Hlsl, MultipliesMatricesByAFunction) {
  EXPECT_EQ(hlslOf("vec3 f(mat3 m, vec3 v) { return m * v; }"), "float3 f(float3x3 m, float3 v) { return mul(m, v); }");
  EXPECT_EQ(hlslOf("mat3 m; m * (v.xyz * v.w) + 1.0"), "float3x3 m; mul(m, v.xyz * v.w) + 1.0");
  EXPECT_EQ(hlslOf("mat3 m; g(m * n.xyz, 2.0)"), "float3x3 m; g(mul(m, n.xyz), 2.0)");
  EXPECT_EQ(hlslOf("mat3 m; m * mix(a, (b), c) * 2.0;"), "float3x3 m; mul(m, lerp(a, (b), c)) * 2.0;");
  EXPECT_EQ(hlslOf("mat3 m; mat3 n; m * (n * v)"), "float3x3 m; float3x3 n; mul(m, mul(n, v))");
}

TEST(Hlsl, LeavesOtherProducts) { EXPECT_EQ(hlslOf("mat3 m; float s; s * v; v * s"), "float3x3 m; float s; s * v; v * s"); }

}  // namespace
}  // namespace cloudbake
