// The state in the address of the page. Besides it, ui=0 hides all but the picture, size=WxH fixes its pixels, play=1 plays.

import { changesOf } from './state.js';

export const LARGEST_SIZE = 8192;  // of a picture, pixels
const ADDRESS_MILLISECONDS = 400;  // between two addresses: browsers refuse more than 100 in 30 seconds

/** The words of an address. @param {string} hash */
export function wordsOf(hash) {
  const words = new URLSearchParams(hash.slice(1));
  const size = words.get('size')?.match(/^([1-9]\d{0,3})x([1-9]\d{0,3})$/)?.slice(1).map(Number);
  return {
    words, asset: words.get('asset'), isBare: words.get('ui') === '0', plays: words.get('play') === '1',
    size: size?.every(pixels => pixels <= LARGEST_SIZE) ? size : null,
  };
}

// A state with what the words of an address say about it.
export function stateOfWords(words, home) {
  const state = { ...home };
  for (const [key, beginning] of Object.entries(home)) {
    const word = words.get(key), numbers = word?.split(',').map(text => text.trim() ? Number(text) : NaN) ?? [];
    if (typeof beginning === 'string') state[key] = word ?? beginning;
    else if (numbers.length === [beginning].flat().length && numbers.every(Number.isFinite))
      state[key] = Array.isArray(beginning) ? numbers : numbers[0];
  }
  return state;
}

/** @param {Viewer} viewer */
export function addressOf({ state, home, isBare, size, scene, clock }) {
  const text = value => typeof value === 'string' ? value : [value].flat().map(x => +x.toFixed(4)).join(',');
  const words = Object.entries({ ...(state.asset > 0 ? { asset: state.asset } : {}), ...changesOf(state, home) });
  const all = words.map(([key, value]) => `${key}=${text(value)}`);
  if (isBare) all.push('ui=0');
  if (size && String(size) !== String(scene.size)) all.push(`size=${size.join('x')}`);
  if (clock.plays) all.push('play=1');
  return `#${all.join('&')}`;
}

export class AddressBar {
  /** @param {Viewer} viewer */
  constructor(viewer) {
    this.viewer = viewer;
    this.shownAt = -Infinity;
  }

  show() {
    clearTimeout(this.timer);
    const wait = this.shownAt + ADDRESS_MILLISECONDS - performance.now();
    if (wait > 0) {
      this.timer = setTimeout(() => this.show(), wait);
      return;
    }
    this.shownAt = performance.now();
    try {
      history.replaceState(null, '', addressOf(this.viewer));
    } catch {
      // Frames without an address of their own, such as those of `srcdoc`, keep the one that they have.
    }
  }
}
