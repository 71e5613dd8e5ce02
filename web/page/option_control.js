// The control of an option: a box for a flag, a list for choices, a slider or a field for a number, a field for text.
import { make } from '../../viewer/dom.js';

const MOST_STEPS = 200;  // of a slider for whole numbers; a longer range is typed

const wordsOf = (/** @type {string} */ name) => name[0].toUpperCase() + name.slice(1).replaceAll('-', ' ');

/**
 * Calls `choose` with the text of each new value; an empty one is the default.
 * @param {OptionInfo} option @param {string} value @param {(value: string) => void} choose
 * @param {{ prefix: string, slides?: boolean, initial?: string }} more `initial`: what it is if it is not given
 */
export function optionControl({ name, label: text, unit, fallback, help, choices, kind, low, high, words, percent, shape }, value, choose,
  { prefix, slides = false, initial = fallback }) {
  const label = make('label', {});
  const is_number = ['whole', 'number'].includes(kind) && !words.length && !percent && !shape;
  // A slider goes as far as the option, or to three times what it begins with.
  const begins = Number(initial), is_whole = kind === 'whole', least = Number.isFinite(low) ? low : Math.min(0, 3 * begins);
  const most = Number.isFinite(high) && (is_whole || high <= 10 * Math.max(1, begins)) ? high : begins > 0 ? 3 * begins : 1;
  const is_slider = slides && ['whole', 'number'].includes(kind) && !percent && !shape && initial !== '' && Number.isFinite(begins)
    && (!is_whole || most - least <= MOST_STEPS);
  /** @type {any} */
  let input;
  if (!unit) {
    input = make('input', { type: 'checkbox', checked: (value || initial) === 'true' });
  } else if (choices.length) {
    input = make('select', {});
    input.append(...['', ...choices].map(choice => new Option(choice || `${initial || 'none'} (default)`, choice)));
    input.value = value;
  } else if (is_slider) {
    input = make('input', { type: 'range', min: least, max: most, step: is_whole ? 1 : 'any', value: value || initial });
  } else {
    const range = is_number ? { type: 'number', min: low ?? '', max: high ?? '', step: is_whole ? 1 : 'any' } : { type: 'text' };
    input = make('input', { ...range, placeholder: initial || 'none', value, spellcheck: false });
  }
  input.id = `${prefix}-${name}`;
  input.ariaDescription = `${help} (--${name})`;
  const shown = is_slider ? make('output', { textContent: value || initial }) : null;
  label.classList.toggle('set', value !== '');
  input.addEventListener('input', () => {
    // What is no number has no value in the browser: the bake refuses this text, where an empty one would be the default.
    let chosen = input.type === 'checkbox' ? String(input.checked || '') : input.validity.badInput ? 'no number' : input.value.trim();
    if (is_slider && !is_whole) chosen = String(Number(Number(chosen).toPrecision(3)));
    if (is_slider && Number(chosen) === Number(initial)) chosen = '';
    if (shown) shown.textContent = chosen || initial;
    label.classList.toggle('set', chosen !== '');
    choose(chosen);
  });
  label.append(text || wordsOf(name), ...shown ? [shown] : [], input);
  return label;
}
