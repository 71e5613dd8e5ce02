// The elements of page.html, and what all parts of the page do with them.

/** An element of page.html. Who asks for it knows its kind. @param {string} id @returns {any} */
export const element = id => document.getElementById(id);

/** @template {keyof HTMLElementTagNameMap} K @param {K} kind @returns {HTMLElementTagNameMap[K]} */
export const make = (kind, properties) => Object.assign(document.createElement(kind), properties);

export const onInput = (id, change) => element(id).addEventListener('input', event => change(event.target));
export const onClick = (id, act) => element(id).addEventListener('click', act);

// The choices of a <select>, by value.
export const setOptions = (id, names) =>
  element(id).replaceChildren(...Object.entries(names).map(([value, name]) => new Option(name, value)));

// What the page is doing, for its style and for who waits: drawing, ready, failed.
export const setPageState = state => { document.documentElement.dataset.state = state; };

// A button that plays or stops something.
export function showPlaying(id, is_on, what) {
  element(id).setAttribute('aria-pressed', is_on);
  element(id).textContent = `${is_on ? 'Stop' : 'Play'} ${what}`;
}

// A message over the picture, until the next one or until it is closed; none if there is no text.
export function tell(text) {
  element('message-text').textContent = text;
  element('message').hidden = !text;
}

// Nothing can be drawn: the page is a message.
export function fail({ message }) {
  for (const other of document.querySelectorAll('main > :not(h1, #message), #close-message')) other.toggleAttribute('hidden', true);
  tell(message);
  setPageState('failed');
}
