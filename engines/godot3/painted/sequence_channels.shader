// The same of a sequence as channels.shader of other clouds. Made by cloudbake @version@.
#include "godot_channels.gdshaderinc"

// The picture of the keys: linear values, without filter and mip levels.
uniform sampler2D sequence_keys;

// GLES3 converts what texelFetch reads, as if it were a colour of sRGB.
vec3 sequenceKey(vec2 at) {
	return textureLod(sequence_keys, (at + 0.5) / vec2(textureSize(sequence_keys, 0)), 0.0).rgb;
}
#include "godot_sequence.gdshaderinc"

void vertex() {
	mat3 to_world = mat3(WORLD_MATRIX);
	vec3 normal;
	vec4 lobe;
	VERTEX = sequenceVertex(UV, normal, lobe);
	lit = lightOf(lobeInWorld(lobe, to_world), normalInWorld(normal, to_world), painted_half_lambert, painted_volume_gain);
}

void fragment() {
	float away = -VERTEX.z;
	if (isLeftOut(fadeBetween(away, painted_near_fade.x, painted_near_fade.y), FRAGCOORD.xy)) {
		discard;
	}
	ALBEDO = channelsOf(lit, away, depth_range).xyw;
}
