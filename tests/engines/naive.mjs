// A composite that takes the mean of the depths of four texels, to see that a test finds what it does wrong.
export function naiveOf(composite) {
  const wanted = 'visibleChannels(at, distanceBehind(at))';
  if (!composite.includes(wanted)) throw new Error(`the composite has no ${wanted}`);
  return composite.replace(wanted, 'distanceOf(channelsAt(channels, at), at) < distanceBehind(at) ? channelsAt(channels, at) : vec4(0.0)');
}
