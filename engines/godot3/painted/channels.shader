// What the painted look is made of: in place of a colour, the light of sun and sky and the depth. Made by cloudbake @version@.
#include "godot_channels.gdshaderinc"

void vertex() {
	mat3 to_world = mat3(WORLD_MATRIX);
	vec4 lobe = lobeInWorld(decodeLobe(UV, UV2, 0.0, density_max), to_world);
	lit = lightOf(lobe, normalInWorld(NORMAL, to_world), painted_half_lambert, painted_volume_gain);
}

void fragment() {
	float away = -VERTEX.z;
	if (isLeftOut(fadeBetween(away, painted_near_fade.x, painted_near_fade.y), FRAGCOORD.xy)) {
		discard;
	}
	ALBEDO = channelsOf(lit, away, depth_range).xyw;
}
