// How long it takes to blend two keys of a sequence of 3,000 vertices, as CloudSequence does it for each frame: the median of 40 times.
//   node tests/bench/sequence_update.mjs
import { emptyKey, writeKeyAt } from '../../engines/npm/sequence.js';

const VERTICES = 3000, BLENDS = 20;

function someKey(shift) {
  const key = emptyKey(VERTICES);
  for (const numbers of Object.values(key)) numbers.forEach((_, i) => { numbers[i] = 1 + Math.sin(i + shift); });
  return key;
}

const segment = { frames: [0, 1], keys: [someKey(0), someKey(1)] }, out = emptyKey(VERTICES);
const took = Array.from({ length: 40 }, () => {
  const begin = performance.now();
  for (let i = 1; i <= BLENDS; ++i) writeKeyAt(segment, i / (BLENDS + 1), out);
  return (performance.now() - begin) / BLENDS;
}).sort((a, b) => a - b);
console.log(`${VERTICES} vertices: ${took[took.length >> 1].toFixed(3)} ms, the median of ${took.length} times; ` +
  `${took[0].toFixed(3)} to ${took.at(-1).toFixed(3)} ms`);
