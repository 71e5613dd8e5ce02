// Plays a sequence (`cloudbake sequence --as picture`), lit like any cloud, for Godot 3 (GLES3). Made by cloudbake @version@.
// cloudbake_sequence.gd sets what changes.
#include "godot.gdshaderinc"
#include "noise.glsl"
#include "soft.glsl"

// The picture of the keys: linear values, without filter and mip levels.
uniform sampler2D sequence_keys;

// GLES3 converts what texelFetch reads, as if it were a colour of sRGB.
vec3 sequenceKey(vec2 at) {
	return textureLod(sequence_keys, (at + 0.5) / vec2(textureSize(sequence_keys, 0)), 0.0).rgb;
}
#include "godot_sequence.gdshaderinc"

uniform vec2 shown = vec2(0.0, 1.0);    // between which thresholds of the dither it is drawn

void vertex() {
	mat3 to_world = mat3(WORLD_MATRIX);
	vec3 normal;
	vec4 lobe;
	VERTEX = sequenceVertex(UV, normal, lobe);
	lit = lightOf(lobeInWorld(lobe, to_world), normalInWorld(normal, to_world), half_lambert, volume_gain);
}

void fragment() {
	float threshold = ditherThreshold(FRAGCOORD.xy);
	if (threshold < shown.x || threshold >= shown.y) {
		discard;
	}
	vec3 color = colorOf(lit, (CAMERA_MATRIX * vec4(VERTEX, 0.0)).xyz);
	ALBEDO = tone_curve ? srgbToLinear(toneMap(color, exposure)) : color * exposure;
}
