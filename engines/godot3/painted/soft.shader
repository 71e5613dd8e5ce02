// A step of the painted look, which cloudbake_painted.gd makes. Light and opacity after the boxes. Made by cloudbake @version@.
shader_type canvas_item;
render_mode unshaded, blend_disabled;

#include "soft.frag.glsl"
