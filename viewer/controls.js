// The controls of the panel: each sets a part of the state, and shows it.

import { element, make, onClick, onInput, setOptions, tell } from './dom.js';
import { hourText } from './hours.js';
import { vertexText } from './picking.js';
import { savePicture } from './save.js';
import { lightRefusal, lightsOf, looksOf, shownBy } from './state.js';
import { firstPart } from './vertices.js';

const LOOKS = { painted: 'Painted', published: 'Chain as published', plain: 'Plain: the lobe formula',
  surface: 'First surface' };
// Those whose values are those of the state.
const SLIDERS = ['k', 'b', 'exposure', 'softness', 'swirl', 'erosion', 'fog', 'shine'];
const CHOSEN = ['look', 'show', 'light'];

/** @param {Viewer} viewer */
export function listenToControls(viewer) {
  for (const slider of document.querySelectorAll('#panel > details > label > [type=range]'))
    slider.after(make('output', { ariaHidden: 'true' }));
  onInput('sun-azimuth', ({ valueAsNumber }) => viewer.change({ sun: [valueAsNumber, viewer.state.sun[1]] }));
  onInput('sun-elevation', ({ valueAsNumber }) => viewer.change({ sun: [viewer.state.sun[0], valueAsNumber] }));
  onInput('density', ({ valueAsNumber }) => viewer.change({ density: 2 ** valueAsNumber }));
  onInput('time', ({ valueAsNumber }) => {
    viewer.clock.move(valueAsNumber - viewer.clock.time);
    viewer.request();
  });
  onInput('hour', ({ valueAsNumber }) => viewer.sun.setHour(valueAsNumber));
  onInput('divider', ({ valueAsNumber }) => viewer.change({ split: valueAsNumber }));
  for (const id of ['rate', 'vertex', ...SLIDERS]) onInput(id, ({ valueAsNumber }) => viewer.change({ [id]: valueAsNumber }));
  for (const id of CHOSEN) onInput(id, ({ value }) => viewer.change({ [id]: value }));
  onInput('against', ({ value }) => viewer.compareWith(value));
  onInput('asset', ({ value }) => viewer.choose(+value));
  onClick('reset', () => viewer.reset());
  onClick('play', () => viewer.clock.play(!viewer.clock.plays));
  onClick('play-frames', () => viewer.clock.play(!viewer.clock.plays));
  onInput('frame', ({ valueAsNumber }) => viewer.clock.show(valueAsNumber));
  onClick('play-sun', () => viewer.sun.play(!viewer.sun.plays));
  onClick('save', () => savePicture(viewer));
  onClick('close-message', () => tell(''));
}

/** What a scene offers. @param {Viewer} viewer */
export function showChoices({ page, scene, home }) {
  const reach = scene.camera.distance / 50;
  Object.assign(element('b'), { min: home.b - reach, max: home.b + reach });
  element('vertex').max = scene.arrays.positions.length / 3 - 1;
  element('asset').parentElement.hidden = page.scenes.length < 2;
  setOptions('asset', Object.fromEntries(page.scenes.map(({ name }, i) => [i, name])));
  setOptions('look', Object.fromEntries(looksOf(scene).map(name => [name, LOOKS[name]])));
  setOptions('light', lightsOf(scene));
  setOptions('against', { none: 'Nothing', ...lightsOf(scene) });
}

/** The state. @param {Viewer} viewer */
export function showState(viewer) {
  const { state, scene, clock, drawing: { fullSize } } = viewer;
  element('sun-azimuth').value = state.sun[0];
  element('sun-elevation').value = state.sun[1];
  element('hour').value = viewer.sun.hour;
  element('density').value = Math.log2(state.density);
  Object.assign(element('time'), { max: Math.max(120, scene.layers?.day?.seconds ?? 0), value: clock.time });
  setOptions('show', shownBy(state.look));
  for (const id of ['rate', ...SLIDERS, 'asset', 'against', ...CHOSEN]) element(id).value = state[id];
  for (const option of [...element('light').options, ...element('against').options]) {
    option.title = lightRefusal(scene, state.look, option.value);
    option.disabled = !!option.title;
  }
  element('show').disabled = element('chain').hidden = viewer.look.kind === 'plain';
  element('softness').disabled = element('erosion').disabled = state.look !== 'painted';
  element('vertex').value = state.vertex < 0 ? '' : state.vertex;
  const figures = element('vertex-figures');
  const text = state.vertex < 0 ? 'Click the cloud to choose a vertex.' : vertexText(viewer, state.vertex);
  if (figures.textContent !== text) {
    figures.textContent = text;  // what is new is read out
    if (state.vertex >= 0) figures.parentElement.open = true;
  }
  element('save-width').defaultValue = fullSize.width;  // what is shown until another size is typed
  element('save-height').defaultValue = fullSize.height;
}

/** The numbers beside the sliders. Screen readers have those of the sliders themselves. @param {Viewer} viewer */
export function showNumbers({ state, scene, clock, sun }) {
  clock.showFrame();
  const [azimuth, elevation] = state.sun;
  const texts = {
    'sun-azimuth': `${azimuth.toFixed(0)}°`, 'sun-elevation': `${elevation.toFixed(0)}°`, hour: hourText(sun.hour),
    density: `${(firstPart(scene).extinction * state.density).toPrecision(3)} /unit`, time: `${clock.time.toFixed(1)} s`,
    rate: `${state.rate.toFixed(0)} /s`, ...Object.fromEntries(SLIDERS.map(id => [id, `× ${state[id].toFixed(2)}`])),
    k: state.k.toFixed(2), b: `${state.b.toFixed(2)} units`,
  };
  for (const [id, text] of Object.entries(texts)) element(id).ariaValueText = element(id).nextElementSibling.textContent = text;
}
