// A step of the painted look, which cloudbake_painted.gd makes. Noise wears the rims away. Made by cloudbake @version@.
shader_type canvas_item;
render_mode unshaded, blend_disabled;

#include "noise.glsl"
#include "view.glsl"
#include "erode.frag.glsl"
