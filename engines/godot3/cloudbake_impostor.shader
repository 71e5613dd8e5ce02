// Draws a lobe impostor (`cloudbake impostor`), which turns to the camera and is lit like the cloud, for Godot 3 (GLES3). Made by
// cloudbake @version@.
// cloudbake_import.gd makes a material for every impostor; cloudbake_sun.gd turns to_sun. All colours are linear, and may be over 1.
shader_type spatial;
render_mode unshaded, blend_mix, depth_draw_never, cull_disabled;

// The pictures of the atlas: linear values, not those of sRGB.
uniform sampler2D impostor_lobe;
uniform sampler2D impostor_rest;
#include "godot_impostor.gdshaderinc"

void vertex() {
	bool has_perspective = PROJECTION_MATRIX[3][3] == 0.0;
	impostor_to_world = mat3(WORLD_MATRIX);
	vec3 center = (WORLD_MATRIX * vec4(impostor_center, 1.0)).xyz;
	vec3 towards = has_perspective ? CAMERA_MATRIX[3].xyz - center : CAMERA_MATRIX[2].xyz;
	vec3 own_eye = inverse(impostor_to_world) * towards / impostor_radius;
	impostor_to_eye = normalize(own_eye);
	impostor_place = impostorCorner(VERTEX.xy, own_eye, has_perspective);
	impostor_ray = impostorRay(impostor_place, own_eye, has_perspective);
	float side = 2.0 / (PROJECTION_MATRIX[1][1] * VIEWPORT_SIZE.y) * (has_perspective ? length(towards) : 1.0);
	float size = pow(abs(determinant(impostor_to_world)), 1.0 / 3.0) * impostor_radius;
	impostor_texels = impostorTexels(side, size, impostor_atlas.y);
	VERTEX = impostor_center + impostor_place * impostor_radius;
}

void fragment() {
	vec3 light = impostorLight(impostor_place, impostor_ray, impostor_to_eye, impostor_texels, impostor_to_world);
	vec3 color = colorOf(clamp(light.xy, 0.0, 1.0), (CAMERA_MATRIX * vec4(VERTEX, 0.0)).xyz);
	ALBEDO = tone_curve ? srgbToLinear(toneMap(color, exposure)) : color * exposure;
	ALPHA = light.z;
}
