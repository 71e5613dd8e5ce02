// The painted clouds over the rest of the scene, by depth. Made by cloudbake @version@.
#include "godot_composite.gdshaderinc"

void vertex() {
	POSITION = vec4(VERTEX.xy, 0.0, 1.0);
}

void fragment() {
	ivec2 at = ivec2(FRAGCOORD.xy);
	vec3 on_screen = 2.0 * vec3(SCREEN_UV, texelFetch(DEPTH_TEXTURE, at, 0).r) - 1.0;
	vec4 p = visibleChannels(at, solidDistance(on_screen, INV_PROJECTION_MATRIX));
	ALBEDO = cloudsColor(p, at);
	ALPHA = p.z;
}
