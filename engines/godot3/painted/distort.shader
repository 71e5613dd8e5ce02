// A step of the painted look, which cloudbake_painted.gd makes. The swirls. Made by cloudbake @version@.
shader_type canvas_item;
render_mode unshaded, blend_disabled;

#include "noise.glsl"
#include "channel_sum.glsl"
#include "distort.frag.glsl"
