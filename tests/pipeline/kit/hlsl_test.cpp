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

TEST(Hlsl, CastsVectorsOfOneValue) {
  EXPECT_EQ(hlslOf("vec3(0.0) + vec2(g(a, b)).x"), "((float3)(0.0)) + ((float2)(g(a, b))).x");
  EXPECT_EQ(hlslOf("vec2(vec3(1.0).xy, ivec2(2))"), "float2(((float3)(1.0)).xy, ((int2)(2)))");
}

TEST(Hlsl, MakesStructuresByAFunction) {
  EXPECT_EQ(hlslOf("struct Sum {\n  vec4 a;  // of b, c\n  vec2 b, c;\n};\nSum s = Sum(vec4(0.0), b, c);"),
            "struct Sum {\n  float4 a;  // of b, c\n  float2 b, c;\n};\nSum makeSum(float4 a, float2 b, float2 c) {\n  Sum made;\n"
            "  made.a = a;\n  made.b = b;\n  made.c = c;\n  return made;\n}\nSum s = makeSum(((float4)(0.0)), b, c);");
}

TEST(Hlsl, HasUniformsThatAreSetAsFloats) {
  EXPECT_EQ(hlslOf("uniform highp sampler2D a, b;"), "Texture2D<float4> a, b;");
  EXPECT_EQ(hlslOf("uniform vec3 a, b;  // c"), "float3 a, b;  // c");
  EXPECT_EQ(hlslOf("uniform ivec2 a;\nuniform bool b, c;"),
            "float2 a_; static const int2 a = (int2)a_;\n"
            "float b_, c_; static const bool b = (bool)b_; static const bool c = (bool)c_;");
}

TEST(Hlsl, HasStaticVariablesForWhatAPassWrites) {
  EXPECT_EQ(hlslOf("out vec4 value;\nconst int N = 3;\nvoid f(out vec4 a) { const int m = 1; }\nvoid main() { value = vec4(1.0); }"),
            "static float4 value;\nstatic const int N = 3;\nvoid f(out float4 a) { const int m = 1; }\n"
            "void write() { value = ((float4)(1.0)); }");
}

TEST(Hlsl, MakesAPassOneStructure) {
  EXPECT_EQ(hlslStructure("Pass", "int f();\n",
                          "uniform ivec2 a;\nout vec4 value;\nstruct Sum {\n  vec2 b;\n};\n"
                          "void main() { value = vec4(Sum(vec2(a)).b, 0.0, 0.0); }\n"),
            "struct Sum {\n  float2 b;\n};\nstruct Pass {\nfloat4 gl_FragCoord;\nint f();\nint2 a;\nfloat4 value;\n"
            "Sum makeSum(float2 b) {\n  Sum made;\n  made.b = b;\n  return made;\n}\n"
            "void write() { value = float4(makeSum(((float2)(a))).b, 0.0, 0.0); }\n};\n");
}

}  // namespace
}  // namespace cloudbake
