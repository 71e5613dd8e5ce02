// Which levels of detail of a cloud are drawn: the rule of `cloudbake preview` (preview/mesh_clouds/levels.h), with a band of sizes over
// which two levels share the pixels, so that pictures do not jump.

// The pixels that the longest side of a cloud would cover if all of it were where its box is nearest to the eye. `longest`: that side,
// times the largest stretch of an axis; `low` and `high`: corners of the box in the world; `tangent`: of half of the angle of view
// upwards; `height`: pixels of the picture.
export function pixelsAcross(longest, low, high, eye, tangent, height) {
  const away = Math.hypot(...eye.map((x, i) => x - Math.min(Math.max(x, low[i]), high[i])));
  return longest * height / (2 * away * tangent);
}

// For every level, first the full mesh, the thresholds from and to which its pixels are drawn; null: none. `switches`: the most pixels at
// which each level is drawn; the first one is not read. `band`: the share of them over which a level appears, 0: at once.
export function shownLevels(pixels, switches, band) {
  const shares = switches.map((most, i) => {
    if (i === 0) return 1;
    if (pixels > most) return 0;
    return band > 0 ? Math.min(1, (most - pixels) / (band * most)) : 1;
  });
  // A coarser level lies over the finer ones.
  const shown = shares.map(() => null);
  for (let i = shares.length - 1, begin = 0; i >= 0 && begin < 1; --i) {
    const end = begin + (1 - begin) * shares[i];
    if (end > begin) shown[i] = [begin, end];
    begin = end;
  }
  return shown;
}

// The largest stretch of a length along the axes of a matrix of 16 numbers by columns.
export const stretchedSides = (sides, m) => Math.max(...sides.map((side, i) => side * Math.hypot(m[4 * i], m[4 * i + 1], m[4 * i + 2])));
