// A shader of GLSL in the shading language of Godot, for the engine kit.
#pragma once

#include <string>
#include <string_view>

namespace cloudbake {

/// The same shader in the language that Godot 3 and Godot 4 have in common, which has less than GLSL ES 3.00:
/// - a uniform per line;
/// - no structs: `Sum sum` with the fields x and y becomes `sum_x`, `sum_y` (not for what a function returns, nor for arrays);
/// - no unsigned literals: `5u` becomes `uint(5)`; no `^=`;
/// - no `return` in the main function: of a shader that writes `out vec4 value`, main becomes a function of a place of the picture, in
///   pixels as gl_FragCoord.xy, whose value `fragment` gives to COLOR. Only main may use gl_FragCoord.
/// Text that is in Godot's language already stays as it is.
std::string gdshaderOf(std::string_view glsl);

}  // namespace cloudbake
