// A step of the painted look, which cloudbake_painted.gd makes. Depth carried beyond the clouds. Made by cloudbake @version@.
shader_type canvas_item;
render_mode unshaded, blend_disabled;

#include "spread.frag.glsl"
