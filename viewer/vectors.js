// Vectors of three numbers.

export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const add = (a, b, factor = 1) => a.map((x, i) => x + factor * b[i]);
export const normalize = a => a.map(x => x / Math.hypot(...a));
export const clamp = (x, low, high) => Math.min(high, Math.max(low, x));

// Azimuth from +Z towards +X and elevation, in degrees.
export function directionFromAngles(azimuth, elevation) {
  const a = azimuth * Math.PI / 180, e = elevation * Math.PI / 180;
  return [Math.cos(e) * Math.sin(a), Math.sin(e), Math.cos(e) * Math.cos(a)];
}
