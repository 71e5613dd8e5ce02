// The dock of panels: what it leaves free of the window, its line of help, and Escape.

import { element, tell } from './dom.js';

const openPanel = () => document.querySelector('#dock > [open]');
const helpOf = part => (part.closest('label')?.querySelector('[aria-description]') ?? part.closest('[aria-description]'))?.ariaDescription;

/** Whether the window has room for an open panel beside a cloud. */
export const hasRoom = () => innerWidth >= 900;

/**
 * The part of the window that no open panel covers, in pixels of the page: its size, and where its middle is from that of the window.
 * Null if it is all of it.
 */
export function freeBox() {
  const free = { left: 0, top: 0, right: innerWidth, bottom: innerHeight };
  for (const glass of document.querySelectorAll(openPanel() ? '.glass:not(#message)' : '#bake-empty')) {
    const { right, top, bottom, width } = glass.getBoundingClientRect();
    if (glass.id === 'controls' && width < innerWidth / 2) free.left = right;
    else if (top > innerHeight / 3) free.bottom = Math.min(free.bottom, top);
    else free.top = Math.max(free.top, bottom);
  }
  const width = free.right - free.left, height = Math.max(innerHeight / 4, free.bottom - free.top);
  if (width === innerWidth && height === innerHeight) return null;
  return { x: (free.left + free.right - innerWidth) / 2, y: (free.top + free.bottom - innerHeight) / 2, width, height };
}

/** The help of a control under pointer, finger or focus is shown in one line below all panels. */
export function listenToDock() {
  const controls = element('controls'), help = element('help');
  const general = matchMedia('(pointer: coarse)').matches ? help.dataset.touch : help.textContent;
  help.textContent = general;
  const show = part => { help.textContent = helpOf(part) ?? general; };
  for (const name of ['pointerover', 'pointerdown', 'focusin']) controls.addEventListener(name, event => show(event.target));
  for (const name of ['pointerleave', 'focusout']) controls.addEventListener(name, () => show(document.activeElement));
  addEventListener('keydown', ({ key }) => {
    if (key !== 'Escape') return;
    const panel = document.activeElement.closest('#dock > [open]');
    if (!element('message').hidden) tell('');
    else if (panel) {
      panel.removeAttribute('open');
      /** @type {HTMLElement} */ (panel.firstElementChild).focus();
    }
  });
}
