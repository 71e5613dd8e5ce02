// From linear colours to the 8 bits of a screen. The same as toneMap and dithered (preview/mesh_clouds/render.h).

// The filmic curve of K. Narkowicz, then the sRGB transfer function.
float encodeTone(float value, float exposure) {
  float x = clamp(value * exposure, 0.0, 1e6);
  float film = min(1.0, x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14));
  if (film <= 0.0031308) {
    return 12.92 * film;
  }
  return 1.055 * pow(film, 1.0 / 2.4) - 0.055;
}

vec3 toneMap(vec3 color, float exposure) {
  return vec3(encodeTone(color.r, exposure), encodeTone(color.g, exposure), encodeTone(color.b, exposure));
}

// What is added to a pixel, counted from the picture's top left corner, before it is rounded to 8 bits: gradients show no bands.
float ditherOffset(ivec2 pixel) {
  int rank = 0;
  for (int bit = 0; bit < 3; bit++) {
    rank = (rank << 2) | ((((pixel.x ^ pixel.y) >> bit) & 1) << 1) | ((pixel.y >> bit) & 1);
  }
  return ((float(rank) + 0.5) / 64.0 - 0.5) / 255.0;
}
