// Lamps and lightning: lampsAt of preview/lamp.h.

/** The place and the brightness of lightning at a time. @param {Lamp} lamp @param {number} now */
function flashAt({ flashes, every, decay, dark }, now) {
  const stretch = every ? Math.floor(now / every) : 0, since = now - stretch * every;
  const { place, strokes } = flashes[stretch % flashes.length];
  const sum = strokes.reduce((all, [start, strength]) => all + (since >= start ? strength * Math.exp((start - since) / decay) : 0), 0);
  return { place, brightness: sum < dark ? 0 : sum };
}

/** The uniforms of lamps.glsl at a time. @param {Scene} scene */
export function lampsAt({ lamps = [] }, now) {
  const lit = lamps.map(lamp => ({ ...lamp, brightness: 1, ...(lamp.flashes && flashAt(lamp, now)) })).filter(one => one.brightness > 0);
  return {
    lamp_count: lit.length,
    lamps: lit.length ? lit.flatMap(({ place, range, color, strength, brightness, radius, axis, cone }) =>
      [...place, range, ...color.map(x => x * strength * brightness), radius, ...axis, ...cone, 0, 0, 0]) : [0, 0, 0, 0],
  };
}
