// The same of a sequence as channels.shader of other clouds. Made by cloudbake @version@.
#include "godot_channels.gdshaderinc"

uniform sampler2D sequence_keys;
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
