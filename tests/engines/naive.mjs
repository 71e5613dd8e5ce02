// A composite that looks where a cloud is hidden only once for four pixels, to see that a test finds what it does wrong.
export function naiveOf(composite) {
  const wanted = 'distanceBehind(at))';
  if (!composite.includes(wanted)) throw new Error(`the composite has no ${wanted}`);
  return composite.replace(wanted, 'distanceBehind(2 * (at / 2)))');
}
