// The functions of a file of GLSL as HLSL, for the engine kit.
#pragma once

#include <string>
#include <string_view>

namespace cloudbake {

/// The same functions, with their comments: types and functions by the names of HLSL, and `mul(M, v)` for `M * v` where `mat3 M` is
/// declared in the text. Not for constructors of matrices, which take rows in HLSL,
/// nor for those of vectors that repeat one number (HLSL has none), nor for mod().
std::string hlslOf(std::string_view glsl);

}  // namespace cloudbake
