// From the light of sun and sky at a vertex to the colour of a pixel. The same as cloudColor (preview/mesh_clouds/lit_mesh.h) and
// phaseFactor (preview/mesh_clouds/post.h). Colours are linear.

// The colour of a cloud that receives the shares 'sun' and 'sky' of the light.
vec3 cloudColor(float sun, float sky, vec3 sun_color, vec3 ambient_sky, vec3 ambient_ground) {
  return mix(ambient_ground, sun_color, sun) + mix(ambient_ground, ambient_sky, sky);
}

// The light that fog scatters around the sun: 'scatter' is its strength and exponent. Unit vectors.
vec3 scatteredLight(vec3 view, vec3 to_sun, vec3 sun_color, vec2 scatter) {
  return scatter.x > 0.0 ? sun_color * (scatter.x * pow(max(0.0, dot(view, to_sun)), scatter.y)) : vec3(0.0, 0.0, 0.0);
}

// Henyey and Greenstein's phase function times 4 pi; 'cosine' is of the angle by which light is scattered.
float henyeyGreenstein(float cosine, float asymmetry) {
  float square = 1.0 + asymmetry * asymmetry - 2.0 * asymmetry * cosine;
  return (1.0 - asymmetry * asymmetry) / (square * sqrt(square));
}

// The factor of the sun's colour for a view, a unit vector from the eye. share 0.0 leaves the phase out.
float phaseFactor(vec3 view, vec3 to_sun, float share, float asymmetry, float limit) {
  return 1.0 + share * (min(henyeyGreenstein(dot(view, to_sun), asymmetry), limit) - 1.0);
}
