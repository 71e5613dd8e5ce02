// Lights a mesh cloud by the four floats of each vertex, for Godot 3 (GLES2 and GLES3). Made by cloudbake @version@.
// cloudbake_import.gd makes a material of it for every asset; cloudbake_sun.gd turns to_sun. All colours are linear, and may be over 1.
shader_type spatial;
render_mode unshaded;

// The functions come first: Godot 3 takes no parameter that has the name of an earlier uniform. Uniforms and the two stages are below.
#include "lobe.glsl"
#include "light.glsl"
#include "tone.glsl"

// What the bake recorded in asset.extras.cloudbake. cloudbake_import.gd sets these three.
uniform float exponent = @exponent@;    // k
uniform float bias = @bias@;    // b, in the asset's units
uniform float extinction = @extinction@;    // sigma, per unit of the asset: more of it is a denser cloud
// If you scale the whole asset in your scene, set this to the same scale. The asset keeps its look then.
uniform float placed_scale = 1.0;

// The light. The defaults are those of `cloudbake preview --look plain` by day.
uniform vec3 to_sun = vec3(0.83651630, 0.5, -0.22414386);    // to the sun, in the world
uniform vec3 sun_color = vec3(1.08, 0.96, 0.78);
uniform vec3 ambient_sky = vec3(0.09, 0.15, 0.27);    // from above
uniform vec3 ambient_ground = vec3(0.028, 0.045, 0.082);    // from below, and in the depth of the cloud
uniform float half_lambert : hint_range(0.0, 1.0) = 0.5;    // 1: the lobe alone; less: surfaces that face away from the sun are darker
// The phase term: clouds shine around the sun. The painted look of `cloudbake preview` has a share of 0.45; 0 leaves it out.
uniform float phase_share : hint_range(0.0, 1.0) = 0.0;
uniform float phase_asymmetry : hint_range(-0.95, 0.95) = 0.7;    // over 0: light is scattered forwards
uniform float phase_limit = 6.0;    // the phase function is cut here

uniform float exposure = 1.0;
uniform bool tone_curve = true;    // the curve of `cloudbake preview`; switch it off if your Environment has a tone mapper

varying vec2 lit;    // the shares of the light of sun and sky

// Normals move by the inverse transpose. This is it times the determinant, whose sign a mirror changes.
vec3 normalInWorld(vec3 normal, mat3 to_world) {
	vec3 x = cross(to_world[1], to_world[2]);
	vec3 moved = normal.x * x + normal.y * cross(to_world[2], to_world[0]) + normal.z * cross(to_world[0], to_world[1]);
	return normalize(moved * sign(dot(to_world[0], x)));
}

vec3 linearToSrgb(vec3 color) {
	return mix(1.055 * pow(color, vec3(1.0 / 2.4)) - 0.055, 12.92 * color, vec3(lessThanEqual(color, vec3(0.0031308))));
}

vec3 srgbToLinear(vec3 color) {
	return mix(pow((color + 0.055) / 1.055, vec3(2.4)), color / 12.92, vec3(lessThanEqual(color, vec3(0.04045))));
}

void vertex() {
	mat3 to_world = mat3(WORLD_MATRIX);
	vec4 lobe = lobeInWorld(unpackLobe(UV, UV2, 0.0), to_world);
	vec2 shape = vec2(exponent, bias * placed_scale);
	float sigma = extinction / placed_scale;
	vec3 sun = normalize(to_sun);
	lit.x = lobeTransmittance(lobe, sun, shape, sigma) * surfaceFactor(normalInWorld(NORMAL, to_world), sun, half_lambert);
	lit.y = lobeTransmittance(lobe, vec3(0.0, 1.0, 0.0), shape, sigma);
}

void fragment() {
	vec3 view = normalize((CAMERA_MATRIX * vec4(VERTEX, 0.0)).xyz);
	float phase = phaseFactor(view, normalize(to_sun), phase_share, phase_asymmetry, phase_limit);
	vec3 color = cloudColor(lit.x, lit.y, sun_color * phase, ambient_sky, ambient_ground);
	// GLES2 draws what the screen shows, GLES3 draws linear colours.
	if (tone_curve) {
		color = toneMap(color, exposure);
		ALBEDO = OUTPUT_IS_SRGB ? color : srgbToLinear(color);
	} else {
		color *= exposure;
		ALBEDO = OUTPUT_IS_SRGB ? linearToSrgb(color) : color;
	}
}
