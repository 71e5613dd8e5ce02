// The light of clouds in an engine: the unit vector to the sun, and linear colours.
uniform vec3 to_sun, sun_color, ambient_sky, ambient_ground;
