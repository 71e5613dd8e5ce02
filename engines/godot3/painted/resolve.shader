// A step of the painted look, which cloudbake_painted.gd makes. The mean of the samples of each pixel. Made by cloudbake @version@.
shader_type canvas_item;
render_mode unshaded, blend_disabled;

#include "channel_sum.glsl"
#include "godot_resolve.gdshaderinc"
