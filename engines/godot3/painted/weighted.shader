// A step of the painted look, which cloudbake_painted.gd makes. What the boxes average. Made by cloudbake @version@.
shader_type canvas_item;
render_mode unshaded, blend_disabled;

#include "weighted.frag.glsl"
