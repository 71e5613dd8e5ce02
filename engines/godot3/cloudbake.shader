// Lights a mesh cloud by the four floats of each vertex, for Godot 3 (GLES2 and GLES3). Made by cloudbake @version@.
#include "godot.gdshaderinc"

vec3 linearToSrgb(vec3 color) {
	return mix(1.055 * pow(color, vec3(1.0 / 2.4)) - 0.055, 12.92 * color, vec3(lessThanEqual(color, vec3(0.0031308))));
}

void vertex() {
	mat3 to_world = mat3(WORLD_MATRIX);
	lit = lightOf(lobeInWorld(decodeLobe(UV, UV2, 0.0, density_max), to_world), normalInWorld(NORMAL, to_world), half_lambert, volume_gain);
}

void fragment() {
	vec3 color = colorOf(lit, (CAMERA_MATRIX * vec4(VERTEX, 0.0)).xyz);
	// GLES2 draws what the screen shows, GLES3 draws linear colours.
	if (tone_curve) {
		color = toneMap(color, exposure);
		ALBEDO = OUTPUT_IS_SRGB ? color : srgbToLinear(color);
	} else {
		color *= exposure;
		ALBEDO = OUTPUT_IS_SRGB ? linearToSrgb(color) : color;
	}
}
