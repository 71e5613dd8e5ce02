// The soft look without passes after the clouds: opacity near rims, at other things, near the eye and far away. Needs noise.glsl.

// 0.0 at start, 1.0 at end, smooth in between; end may be less than start. Where both are the same it is a step, so 0.0 and 0.0 leave out
// the fade of what is not negative, such as a distance.
float fadeBetween(float x, float start, float end) {
  if (start == end) {
    return x < start ? 0.0 : 1.0;
  }
  float t = clamp((x - start) / (end - start), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

// Noise in the space of an object, 0 to 1, for 'rimOpacity'. 'frequency': its cells per unit; 'scrolled': how many cells it has moved.
float rimNoise(vec3 own_place, float frequency, vec3 scrolled) {
  return smoothstep(0.25, 0.75, fbmValue3(own_place * frequency + scrolled, 2, 0.6, 0u));
}

// The share of a surface that is drawn near the rim, 0 to 1. 'facing': |dot(normal, to_eye)| of unit vectors; 'noise' wears it away, 0 to
// 1, as erode.frag does; 'rim': the values of 'facing' where the surface begins and where it is whole, or 0.0 and 0.0 for a hard rim.
float rimOpacity(float facing, float noise, vec2 rim) {
  float whole = fadeBetween(facing, rim.x, rim.y);
  float taken = 0.75 * noise;
  return clamp((whole - taken) / (1.0 - taken), 0.0, 1.0);
}

// A threshold for a pixel, 0 to less than 1: a pixel is drawn if its opacity is above it. Interleaved gradient noise of J. Jimenez, "Next
// Generation Post Processing in Call of Duty: Advanced Warfare", SIGGRAPH 2014.
float ditherThreshold(vec2 pixel) {
  return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715))));
}
