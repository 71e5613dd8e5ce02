// GLSL in the language of Godot. tests/godot/painted has Godot compile what the kit has of it, and compares what it draws.
#include "pipeline/kit/gdshader.h"

#include <gtest/gtest.h>

namespace cloudbake {
namespace {

TEST(Gdshader, HasAUniformPerLine) {
  EXPECT_EQ(gdshaderOf("uniform highp sampler2D a, b;  // two\n"), "uniform highp sampler2D a;\nuniform highp sampler2D b;  // two\n");
  const char* const depth = "uniform sampler2D depth : hint_depth_texture, filter_nearest;\n";
  EXPECT_EQ(gdshaderOf(depth), depth);
  const char* const own = "uniform float a : hint_range(0.0, 1.0) = 0.5;    // a, b\nuniform vec3 b = vec3(1.0, 2.0, 3.0);\n";
  EXPECT_EQ(gdshaderOf(own), own);
}

TEST(Gdshader, HasNoUnsignedLiterals) {
  EXPECT_EQ(gdshaderOf("x = y >> 16u;"), "x = y >> uint(16);");
  EXPECT_EQ(gdshaderOf("x * 0x7feb352du + 0x846ca68bu"), "x * uint(2146121005) + uint(-2073254261)");
  EXPECT_EQ(gdshaderOf("f(0xFFFFFFFFu, 1.5e3, 0x10)"), "f(uint(-1), 1.5e3, 0x10)");
}

TEST(Gdshader, AssignsAnExclusiveOrInTwoSteps) { EXPECT_EQ(gdshaderOf("  x ^= x >> 15u;\n"), "  x = x ^ (x >> uint(15));\n"); }

TEST(Gdshader, HasNoStructs) {
  EXPECT_EQ(gdshaderOf("struct Sum {\n  vec4 a;  // the first\n  vec2 b;\n};\n\nvoid add(float w, inout Sum sum) {\n  sum.a += w;\n}\n"),
            "void add(float w, inout vec4 sum_a, inout vec2 sum_b) {\n  sum_a += w;\n}\n");
  EXPECT_EQ(
      gdshaderOf("struct S { vec2 a; float b; };\nfloat f() {\n  S s = S(vec2(0.0, 1.0), g(1u, 2.0));\n  return h(s, 1.0) + s.b;\n}\n"),
      "float f() {\n  vec2 s_a = vec2(0.0, 1.0); float s_b = g(uint(1), 2.0);\n  return h(s_a, s_b, 1.0) + s_b;\n}\n");
}

TEST(Gdshader, AVariableIsOfItsFunction) {
  EXPECT_EQ(gdshaderOf("struct S { float a; };\nvoid f(S s) { g(s); }\nvoid h(float s) { g(s); }\n"),
            "void f(float s_a) { g(s_a); }\nvoid h(float s) { g(s); }\n");
  EXPECT_EQ(gdshaderOf("struct S { float a; };\nvoid f(S s) { g(t.s); }\n"), "void f(float s_a) { g(t.s); }\n");
}

TEST(Gdshader, HasNoReturnInFragment) {
  EXPECT_EQ(gdshaderOf("out vec4 value;\n\nvoid main() {\n  if (gl_FragCoord.x < 1.0) {\n    return;\n  }\n  value = vec4(1.0);\n}\n"),
            "vec4 valueAt(vec2 pixel_place) {\n  vec4 value = vec4(0.0);\n  if (pixel_place.x < 1.0) {\n    return value;\n  }\n"
            "  value = vec4(1.0);\n  return value;\n}\n\nvoid fragment() {\n  COLOR = valueAt(FRAGCOORD.xy);\n}\n");
}

TEST(Gdshader, LeavesCommentsAndFunctions) {
  const char* const text = "// uniform a, b; struct S, 5u and x ^= y.\nfloat f(float x) {\n  return x;  // gl_FragCoord\n}\n";
  EXPECT_EQ(gdshaderOf(text), text);
}

}  // namespace
}  // namespace cloudbake
