// How pictures change from one to the next, for the pages of looks.mjs.

// The mean change over the pixels of the cloud, which are not the background's: those of the first pixel.
function changeOf(values, before) {
  let sum = 0, count = 0;
  for (let i = 0; i < values.length; i += 3) {
    const isCloud = [values, before].some(one => [0, 1, 2].some(c => Math.abs(one[i + c] - one[c]) > 2));
    if (!isCloud) continue;
    for (let c = 0; c < 3; ++c) sum += Math.abs(values[i + c] - before[i + c]);
    count += 3;
  }
  return count > 0 ? sum / count : 0;
}

export const changesOf = pictures => pictures.slice(1).map((values, i) => changeOf(values, pictures[i]));
