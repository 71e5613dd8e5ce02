// The look of mesh clouds with soft rims, without passes after the clouds, for Godot 3 (GLES3): choose it as the Shader of an asset's
// material. It also has fades, levels of detail that are dithered, and lamps. Made by cloudbake @version@.
#include "godot_soft.gdshaderinc"

void vertex() {
	mat3 to_world = mat3(WORLD_MATRIX);
	vec4 lobe = lobeInWorld(decodeLobe(UV, UV2, 0.0, density_max), to_world);
	vec3 facing = normalInWorld(NORMAL, to_world);
	lit = lightOf(lobe, facing, half_lambert, volume_gain);
	lamp_light = lampsAt(lobe, (WORLD_MATRIX * vec4(VERTEX, 1.0)).xyz, facing);
	own_place = VERTEX;
}

void fragment() {
	float depth = 2.0 * texelFetch(DEPTH_TEXTURE, ivec2(FRAGCOORD.xy), 0).r - 1.0;
	float solid = -placeInView(vec3(2.0 * SCREEN_UV - 1.0, depth), INV_PROJECTION_MATRIX).z;
	float opacity = fadeOf(-VERTEX.z) * fadeBetween(solid + VERTEX.z, 0.0, soft_distance) * rimOf(abs(dot(NORMAL, VIEW)), TIME);
	if (isLeftOut(opacity, FRAGCOORD.xy)) {
		discard;
	}
	vec3 color = colorOf(lit, (CAMERA_MATRIX * vec4(VERTEX, 0.0)).xyz) + lamp_light;
	ALBEDO = tone_curve ? srgbToLinear(toneMap(color, exposure)) : color * exposure;
}
