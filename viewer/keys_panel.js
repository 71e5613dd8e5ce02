// The keys of a scene in the panel: sliders and fields by table, a search, and the lines of a scene file for what was set by hand.

import { element, make, onClick, onInput } from './dom.js';
import { keyTables, plainName, unitIn } from './keys.js';
import { clamp } from './vectors.js';

export class KeysPanel {
  /** @param {Viewer} viewer */
  constructor(viewer) {
    this.viewer = viewer;
    onInput('find-key', () => this.find());
    onClick('copy-keys', () => this.copy());
  }

  /** @param {Scene} scene */
  useScene(scene) {
    element('scene-keys').hidden = !scene.keys;
    element('keys').replaceChildren(...keyTables(scene, this.viewer.look).map(table => this.table(table)));
    this.find();
    this.showWritten();
  }

  // The lines of the keys that were set by hand, by table.
  showWritten() {
    const tables = new Map();
    for (const { id, title, name, value } of this.viewer.scene.written?.values() ?? []) {
      if (!tables.has(id)) tables.set(id, [`[${title}]`]);
      tables.get(id).push(`${name} = ${JSON.stringify(value).replaceAll(',', ', ')}`);
    }
    element('toml').value = [...tables.values()].map(lines => lines.join('\n')).join('\n\n');
  }

  table({ title, keys }) {
    const box = make('details', {});
    box.append(make('summary', { textContent: title }));
    for (const { limits: [low, high, step, help], ...key } of keys)
      [key.holder[key.at]].flat().forEach((value, index, all) => {
        const one = { ...key, index }, name = plainName(key.name) + (all.length > 1 ? ` ${'xyz'[index]}` : '');
        const unit = unitIn(help), text = unit ? `${name}, ${unit}` : name;
        const inputs = typeof value === 'boolean' ? this.switch(one, value) : this.numbers(one, text, value, { low, high, step });
        const label = make('label', {});
        for (const input of inputs) input.ariaDescription = `${help} (${key.name})`;
        label.dataset.key = `${key.title} ${key.name}`;
        label.append(`${text} `, ...inputs);
        box.append(label);
      });
    return box;
  }

  switch(key, checked) {
    const input = make('input', { type: 'checkbox', checked });
    input.addEventListener('input', () => this.set(key, input.checked));
    return [input];
  }

  // A slider about the value, as far as it may be moved either way without leaving the limits, and a field for every value within them.
  numbers(key, text, value, { low, high, step }) {
    const reach = Math.abs(value) || 1, range = { type: 'range', min: Math.max(low, value - reach), max: Math.min(high, value + reach) };
    const inputs = [range, { type: 'number', min: low, max: high }].map(kind => {
      const input = make('input', { ...kind, step: step || 'any', ariaLabel: `${key.title} ${text}` });
      input.value = value;  // after the limits, which would move it
      return input;
    });
    for (const input of inputs)
      input.addEventListener('input', () => {
        const number = clamp(input.valueAsNumber, low, high);
        for (const other of inputs) if (other !== input) other.value = String(number);
        this.set(key, number);
      });
    return inputs;
  }

  // Sets one number of a key, and writes its line. The scene knows what it was in its file.
  set({ title, id, name, path, holder, at, index }, value) {
    if (typeof value === 'number' && !Number.isFinite(value)) return;
    const { viewer, viewer: { scene } } = this, written = scene.written ??= new Map(), key = path.join('.');
    const was = written.get(key)?.was ?? JSON.stringify(holder[at]);
    if (Array.isArray(holder[at])) holder[at][index] = value;
    else holder[at] = value;
    written.set(key, { id, title, name, was, value: structuredClone(holder[at]) });
    viewer.renderer.forget();
    this.showWritten();
    viewer.change({});
  }

  find() {
    const wanted = element('find-key').value.toLowerCase();
    for (const box of element('keys').children) {
      let found = 0;
      for (const label of box.querySelectorAll('label')) {
        const fits = label.dataset.key.toLowerCase().includes(wanted);
        label.hidden = !fits;
        found += fits;
      }
      box.hidden = !found;
      box.open = wanted !== '' && found > 0;
    }
  }

  copy() {
    element('toml').select();
    navigator.clipboard?.writeText(element('toml').value);
  }
}
