// Begins the page of `cloudbake view`.

import { listenToDock } from './dock.js';
import { element, fail } from './dom.js';
import { Viewer } from './viewer.js';

/** `window.viewer` is for the console and for tests. @param {Layering} [layering] */
export async function start(layering) {
  try {
    listenToDock();
    window.viewer = new Viewer(layering);
    await window.viewer.begin(JSON.parse(element('page').textContent));
  } catch (error) {
    fail(error);
  }
}
