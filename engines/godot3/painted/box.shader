// A step of the painted look, which cloudbake_painted.gd makes. A blur along one axis. Made by cloudbake @version@.
shader_type canvas_item;
render_mode unshaded, blend_disabled;

#include "box.frag.glsl"
