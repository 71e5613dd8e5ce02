// A file of GLSL, functions or a pass, as HLSL, for the engine kit.
#pragma once

#include <string>
#include <string_view>

namespace cloudbake {

/// The same text, with its comments, in HLSL: types and functions by the names of HLSL, a cast for a vector of one value, `mul(M, v)` for
/// `M * v` where `mat3 M` is declared in the text, makeNAME(…) for the constructor of a structure NAME. Of a pass, `out` values are static
/// variables, main() is write(), and uniforms that are no floats are set as floats NAME_. texelFetch, textureSize and equal
/// are those of engines/glsl.hlsl, and gl_FragCoord is a variable. Not for constructors of matrices, which take rows in HLSL, nor for mod()
/// and comparisons of vectors.
std::string hlslOf(std::string_view glsl);

/// A pass, with the functions that it needs, as one HLSL structure, for places where no function can be declared, such as Unreal's Custom
/// nodes: its uniforms and what it writes are fields, `gl_FragCoord` is a field, and write() draws a pixel. `more` is HLSL for the
/// structure.
std::string hlslStructure(std::string_view name, std::string_view more, std::string_view glsl);

}  // namespace cloudbake
