// The control of an option: a box for a flag, a list for choices, a slider or a field for a number, a field for text.
import { make } from '../../viewer/dom.js';

const MOST_STEPS = 200;  // of a slider for whole numbers; a longer range is typed

const wordsOf = (/** @type {string} */ name) => name[0].toUpperCase() + name.slice(1).replaceAll('-', ' ');

/**
 * The ends of a slider, or nothing if this option cannot have one. It goes as far as the option, or to three times what it begins with.
 * @param {OptionInfo} option @param {string} initial
 */
function sliderEnds({ kind, low, high, percent, shape }, initial) {
  const begins = Number(initial), is_whole = kind === 'whole';
  if (!['whole', 'number'].includes(kind) || percent || shape || initial === '' || !Number.isFinite(begins)) return null;
  const least = Math.abs(low) < 1e6 ? low : Math.min(0, 3 * begins), beyond = begins > 0 ? 3 * begins : 1;
  const most = Number.isFinite(high) && (is_whole || high <= 10 * Math.max(1, begins)) ? high : beyond;
  return !is_whole || most - least <= MOST_STEPS ? { min: least, max: most } : null;
}

/** @param {OptionInfo} option @param {string} value @param {string} initial @returns {any} */
function fieldOf({ kind, low, high, words, percent, shape }, value, initial) {
  const is_number = ['whole', 'number'].includes(kind) && !words.length && !percent && !shape;
  const range = is_number ? { type: 'number', min: low ?? '', max: high ?? '', step: kind === 'whole' ? 1 : 'any' } : { type: 'text' };
  return make('input', { ...range, placeholder: initial || 'none', value, spellcheck: false });
}

/** @param {string[]} choices @param {string} value @param {string} initial @returns {any} */
function listOf(choices, value, initial) {
  const list = make('select', {});
  list.append(...['', ...choices].map(choice =>
    make('option', { value: choice, textContent: choice || `${initial || 'none'} (default)` })));
  list.value = value;
  return list;
}

/** @param {OptionInfo} option @param {string} value @param {string} initial @param {object} ends @returns {any} */
function inputOf(option, value, initial, ends) {
  if (!option.unit) return make('input', { type: 'checkbox', checked: (value || initial) === 'true' });
  if (option.choices.length) return listOf(option.choices, value, initial);
  if (!ends) return fieldOf(option, value, initial);
  return make('input', { type: 'range', ...ends, step: option.kind === 'whole' ? 1 : 'any', value: value || initial });
}

/** What was chosen in a control; empty is the default. @param {any} input @param {OptionInfo} option @param {string} initial */
function chosenIn(input, { kind }, initial) {
  if (input.type === 'checkbox') return String(input.checked || '');
  if (input.type === 'range') {
    const number = kind === 'whole' ? Number(input.value) : Number(Number(input.value).toPrecision(3));
    return number === Number(initial) ? '' : String(number);
  }
  // What is no number has no value in the browser: the bake refuses this text, where an empty one would be the default.
  return input.validity.badInput ? 'no number' : input.value.trim();
}

/**
 * Calls `choose` with the text of each new value; an empty one is the default.
 * @param {OptionInfo} option @param {string} value @param {(value: string) => void} choose
 * @param {{ prefix: string, slides?: boolean, initial?: string }} more `initial`: what it is if it is not given
 */
export function optionControl(option, value, choose, { prefix, slides = false, initial = option.fallback }) {
  const { name, label: text, help } = option, label = make('label', {}), ends = slides ? sliderEnds(option, initial) : null;
  const input = inputOf(option, value, initial, ends);
  input.id = `${prefix}-${name}`;
  input.ariaDescription = `${help} (--${name})`;
  const shown = ends ? make('output', { textContent: value || initial }) : null;
  label.classList.toggle('set', value !== '');
  input.addEventListener('input', () => {
    const chosen = chosenIn(input, option, initial);
    if (shown) shown.textContent = chosen || initial;
    label.classList.toggle('set', chosen !== '');
    choose(chosen);
  });
  label.append(text || wordsOf(name));
  if (shown) label.append(shown);
  label.append(input);
  return label;
}
