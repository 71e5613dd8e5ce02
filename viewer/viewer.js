// What the page shows: its scenes, the state that was chosen, and the parts that follow it.

import { AddressBar, stateOfWords, wordsOf } from './address.js';
import { Clock, SunClock } from './clock.js';
import { listenToControls, showChoices, showNumbers, showState } from './controls.js';
import { freeBox, hasRoom } from './dock.js';
import { element, tell } from './dom.js';
import { Drawing } from './drawing.js';
import { ExactLight } from './exact_light.js';
import { sceneOfGlb } from './glb.js';
import { hourText } from './hours.js';
import { keepKeys, ownLooks } from './keys.js';
import { KeysPanel } from './keys_panel.js';
import { Overlays } from './overlays.js';
import { unpackMesh } from './packed_mesh.js';
import { listenToKeys, listenToPointers } from './pointers.js';
import { assetNumber, changesOf, homeOf, lookOf, validState } from './state.js';
import { add, directionFromAngles } from './vectors.js';
import { Volume } from './volume.js';
import { listenToWindow } from './window.js';

// What stays when another asset is chosen.
const KEPT = ['sun', 'exposure', 'look', 'light', 'against', 'split', 'show'];

export class Viewer {
  /** `layering`: what draws scenes with layers, in pages that have some (layers/page.js). @param {Layering} [layering] */
  constructor(layering) {
    this.layering = layering;
    this.canvas = element('picture');
    this.pointers = new Map();  // that are down
    this.dropped = [];  // scenes of GLBs that were dropped on the page
    this.drawing = new Drawing(this);
    this.light = new ExactLight(this);
    this.volume = new Volume(this);
    this.clock = new Clock(this);
    this.sun = new SunClock(this);
    this.addressBar = new AddressBar(this);
    this.overlays = new Overlays(this);
    this.keys = new KeysPanel(this);
  }

  /** @param {Page} page */
  async begin(page) {
    await this.setPage(page);
    this.readAddress();
    element('panel').open = hasRoom() && !this.drawing.sheet;  // a small page is left to the picture, and so are tiles
    for (const listen of [listenToControls, listenToPointers, listenToKeys, listenToWindow]) listen(this);
  }

  get renderer() { return this.drawing.renderer; }
  get scene() { return this.page.scenes[this.state.asset]; }
  get look() { return lookOf(this.page, this.scene, this.state.look); }

  // --- Scenes ---

  /** Shows another page's scenes; camera, sun, everything that was chosen and what was dropped stays. @param {Page} page */
  async setPage(page) {
    this.newest = page;
    const meshes = page.scenes.flatMap(scene => scene.scattered ? [scene, scene.scattered] : [scene]);
    await Promise.all(meshes.map(async one => { one.arrays ??= await unpackMesh(one); }));
    if (page !== this.newest) return;  // another one came meanwhile
    for (const scene of page.scenes) if (scene.keys) ownLooks(scene, page.looks, page.looks);
    for (const scene of this.dropped) ownLooks(scene, this.page.looks, page.looks);
    for (const [i, scene] of page.scenes.entries()) keepKeys(this.page?.scenes[i], scene, page.looks);
    this.page = { ...page, scenes: [...page.scenes, ...this.dropped] };
    if (this.state) this.setState({ ...changesOf(this.state, this.home), asset: this.state.asset });
  }

  // Adds dropped GLBs to the assets and shows the last one. Those that cannot be read are named.
  async open(...files) {
    const refusals = [];
    for (const file of files) {
      try {
        const scene = await sceneOfGlb(await file.arrayBuffer(), file.name.replace(/\.glb$/i, ''), this.scene,
          text => refusals.push(`${file.name}: ${text}`));
        if (scene.keys) ownLooks(scene, this.page.looks, this.page.looks);
        this.dropped.push(scene);
        this.showScene(this.page.scenes.push(scene) - 1, scene);
      } catch (error) {
        refusals.push(`${file.name}: ${error.message}`);
      }
    }
    if (files.length) tell(refusals.join('\n'));
  }

  // Shows a scene in place of the one that the page has there.
  showScene(asset, scene) {
    this.page.scenes[asset] = scene;
    this.drawnScene = null;
    this.choose(asset);
  }

  // Takes one of several scenes out of the page, which goes on showing the scene that it shows, or another one.
  removeScene(asset) {
    const { scene, page: { scenes } } = this;
    scenes.splice(asset, 1);
    this.drawnScene = null;
    this.choose(scenes.indexOf(scene));
  }

  // Another asset in the same light, look and comparison.
  choose(asset) {
    const changes = Object.entries(changesOf(this.state, this.home)).filter(([key]) => KEPT.includes(key));
    this.setState({ ...this.homeOf(this.page.scenes[asset]), ...Object.fromEntries(changes) });
  }

  /** @param {Scene} scene */
  homeOf(scene) { return homeOf(this.page, scene); }

  // --- The state ---

  // Takes a state with all words and numbers that make sense.
  setState(wanted) {
    this.state = validState(this.page, wanted);
    this.home = this.homeOf(this.scene);
    if (this.scene !== this.drawnScene) this.useScene();
    this.request();
  }

  change(changes) { this.setState({ ...this.state, ...changes }); }
  // The divider is at first in the middle of what the panels leave free.
  compareWith(against) {
    const { split } = this.state, middle = 0.5 + (this.freeBox?.x ?? 0) / innerWidth;
    this.change({ against, split: split === this.home.split ? middle : split });
  }

  reset() { this.setState({ ...this.home }); }

  turn(x, y) { this.change({ azimuth: this.state.azimuth + x, elevation: this.state.elevation + y }); }
  moveSun(x, y) { this.change({ sun: [this.state.sun[0] + x, this.state.sun[1] + y] }); }
  zoom(factor) { this.change({ zoom: this.state.zoom * factor }); }

  // Hands a scene to all parts, also one whose arrays have changed.
  useScene() {
    const { scene } = this;
    this.drawnScene = scene;
    for (const part of [this.drawing, this.clock, this.sun, this.keys]) part.useScene(scene);
    this.light.forget();
    this.volume.forget();
    showChoices(this);
  }

  // Playing at first is left out where the system asks for less motion.
  readAddress() {
    const { words, asset, isBare, size, plays } = wordsOf(location.hash), scene = this.page.scenes[assetNumber(this.page, asset)];
    this.isBare = isBare;
    this.size = size ?? scene.size ?? null;
    element('controls').hidden = isBare;
    this.setState(stateOfWords(words, this.homeOf(scene)));
    this.clock.play(plays && !matchMedia('(prefers-reduced-motion: reduce)').matches);
  }

  // A camera on a path is only turned.
  cameraAt(time) {
    const { scene: { layers }, state, home } = this, turned = [state.azimuth - home.azimuth, home.elevation - state.elevation];
    return layers?.camera_path ? this.layering.cameraOnPath(time, layers.terrain, turned) : this.camera();
  }

  // An asset is drawn in the middle of what the panels leave free. Scenes have a composition of their own.
  get freeBox() { return this.size || this.isBare || this.scene.keys ? null : freeBox(); }

  camera() {
    const { scene: { camera }, state, canvas } = this, [width, height] = this.size ?? [canvas.clientWidth, canvas.clientHeight];
    const free = this.freeBox ?? { x: 0, y: 0, width, height }, { azimuth, elevation } = state;
    const aspect = this.size || this.scene.keys ? camera.aspect : Math.min(1, camera.aspect);  // a cloud fits into a square
    const distance = camera.distance * Math.max(height / free.height, aspect * height / free.width) / state.zoom;
    const per_pixel = 2 * Math.tan(camera.fov * Math.PI / 360) / height * distance;
    const middle = add(add(camera.at, state.shift), directionFromAngles(azimuth + 90, 0), -free.x * per_pixel);
    const at = add(middle, directionFromAngles(azimuth, elevation + 90), free.y * per_pixel);
    return { at, from: add(at, directionFromAngles(state.azimuth, state.elevation), distance), fov: camera.fov, distance };
  }

  // --- Frames ---

  request() { this.drawing.request(); }

  get moves() { return this.clock.plays || this.sun.plays; }

  // What plays goes on by so many seconds.
  move(seconds) { for (const one of [this.clock, this.sun]) if (one.plays) one.move(seconds); }

  // After each step of a picture. The panel and the address follow once it is final, or while something plays.
  showStep(is_final) {
    this.overlays.show();
    showNumbers(this);
    if (is_final || (this.moves && this.state !== this.shownState && !this.pointers.size)) this.showState();
  }

  showState() {
    this.shownState = this.state;
    this.addressBar.show();
    showState(this);
    document.title = `${this.scene.name}, ${hourText(this.sun.hour)}`;
  }
}
