// The shadow of a cloud on everything that is below it, multiplied onto the picture, for Godot 3 (GLES3). Made by cloudbake @version@.
#include "godot_shadow.gdshaderinc"

void vertex() {
	POSITION = vec4(VERTEX.xy, 0.0, 1.0);
}

void fragment() {
	float depth = texelFetch(DEPTH_TEXTURE, ivec2(FRAGCOORD.xy), 0).r;
	vec3 place = placeInView(2.0 * vec3(SCREEN_UV, depth) - 1.0, INV_PROJECTION_MATRIX);
	ALBEDO = vec3(depth < 1.0 ? lightAt((CAMERA_MATRIX * vec4(place, 1.0)).xyz) : 1.0);
}
