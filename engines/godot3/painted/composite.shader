// The painted clouds over the rest of the scene, by depth. Made by cloudbake @version@.
#include "godot_composite.gdshaderinc"

void vertex() {
	POSITION = vec4(VERTEX.xy, 0.0, 1.0);
}

void fragment() {
	ivec2 at = ivec2(FRAGCOORD.xy);
	float depth = 2.0 * texelFetch(DEPTH_TEXTURE, at, 0).r - 1.0;
	vec4 p = visibleChannels(at, -placeInView(vec3(2.0 * SCREEN_UV - 1.0, depth), INV_PROJECTION_MATRIX).z);
	ALBEDO = cloudsColor(p, at);
	ALPHA = p.z;
}
