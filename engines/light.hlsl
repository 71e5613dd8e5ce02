// From the light of sun and sky at a vertex to the colour of a pixel. The same functions as in preview/glsl/light.glsl. Colours are linear.

// The colour of a cloud that receives the shares `sun` and `sky` of the light.
float3 cloudColor(float sun, float sky, float3 sun_color, float3 ambient_sky, float3 ambient_ground) {
  return lerp(ambient_ground, sun_color, sun) + lerp(ambient_ground, ambient_sky, sky);
}

// Henyey and Greenstein's phase function times 4 pi; `cosine` is of the angle by which light is scattered.
float henyeyGreenstein(float cosine, float asymmetry) {
  float square = 1.0 + asymmetry * asymmetry - 2.0 * asymmetry * cosine;
  return (1.0 - asymmetry * asymmetry) / (square * sqrt(square));
}

// The factor of the sun's colour for a view, a unit vector from the eye. share 0.0 leaves the phase out.
float phaseFactor(float3 view, float3 to_sun, float share, float asymmetry, float limit) {
  return 1.0 + share * (min(henyeyGreenstein(dot(view, to_sun), asymmetry), limit) - 1.0);
}
