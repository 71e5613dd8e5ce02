// The panel that grows a cloud from a preset: its sliders begin with what the recipe of the preset sets.
import { element, make, onClick } from '../../viewer/dom.js';
import { optionControl } from './option_control.js';

export class GrowPanel {
  /**
   * @param {() => Promise<{ presets: PresetInfo[], options: OptionInfo[] }>} read
   * @param {(grown: { preset: string, values: Record<string, string> }) => void} grow
   */
  constructor(read, grow) {
    /** @type {Record<string, string>} */
    this.values = {};
    /** @type {OptionInfo[]} */
    this.options = [];
    /** @type {PresetInfo[]} */
    this.presets = [];
    this.read = read;
    element('bake-grow').addEventListener('toggle', () => this.fill());
    element('grow-preset').addEventListener('change', () => this.choose(element('grow-preset').value));
    onClick('grow-start', () => grow({ preset: this.preset, values: { ...this.values } }));
    onClick('grow-defaults', () => this.choose(this.preset));
  }

  // When it is opened first.
  async fill() {
    if (this.presets.length) return;
    const { presets, options } = await this.read();
    this.presets = presets;
    this.options = options.filter(({ offered }) => offered);
    element('grow-preset').append(...presets.map(({ name }) => make('option', { value: name, textContent: name })));
    this.choose('hero');
  }

  /** @param {string} name */
  choose(name) {
    const { about, values } = this.presets.find(preset => preset.name === name);
    this.preset = name;
    this.values = {};
    element('grow-preset').value = name;
    element('grow-about').textContent = about;
    const initialOf = (/** @type {OptionInfo} */ option) => values[option.name] ?? values[option.name.replaceAll('-', '_')];
    const shown = this.options.filter(option => option.common || initialOf(option) !== undefined);
    element('grow-options').replaceChildren(...shown.flatMap((option, i) => [
      ...option.group !== shown[i - 1]?.group ? [make('h2', { textContent: option.group })] : [],
      optionControl(option, '', value => this.set(option.name, value),
        { prefix: 'grow', slides: true, initial: initialOf(option) ?? option.fallback }),
    ]));
  }

  /** @param {string} name @param {string} value */
  set(name, value) {
    if (value === '') delete this.values[name];
    else this.values[name] = value;
  }

  /** Those of the options of a bake that a grown cloud has, too. @param {Record<string, string>} values */
  only(values) {
    const names = new Set(this.options.map(({ name }) => name));
    return Object.fromEntries(Object.entries(values).filter(([name]) => names.has(name)));
  }
}
