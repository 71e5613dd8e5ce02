// What happens to the page from outside: its size and its screen, its address, its graphics card, files that are dropped, its server.

import { element, fail, setPageState, tell } from './dom.js';

/** A window may be moved to a screen of finer pixels. @param {Viewer} viewer */
function followPixels(viewer) {
  matchMedia(`(resolution: ${devicePixelRatio}dppx)`).addEventListener('change', () => {
    viewer.request();
    followPixels(viewer);
  }, { once: true });
}

/** New scenes of the server. @param {Viewer} viewer */
function followServer(viewer) {
  const events = new EventSource('events');
  events.addEventListener('scene', event => {
    tell('');
    viewer.setPage(JSON.parse(event.data)).catch(({ message }) => tell(`The new picture cannot be shown: ${message}`));
  });
  events.addEventListener('failure', event => tell(JSON.parse(event.data)));
  events.addEventListener('error', () => tell('The server does not answer; the picture is the last one.'));
  events.addEventListener('open', () => tell(''));
}

/** The graphics card forgets everything when it is lost. @param {Viewer} viewer */
function followGraphics(viewer) {
  viewer.canvas.addEventListener('webglcontextlost', event => {
    event.preventDefault();
    setPageState('drawing');
  });
  viewer.canvas.addEventListener('webglcontextrestored', () => {
    try {
      viewer.drawing.begin();
      viewer.useScene();
      viewer.request();
    } catch (error) {
      fail(error);
    }
  });
}

/** @param {Viewer} viewer */
export function listenToWindow(viewer) {
  const { canvas, drawing } = viewer;
  new ResizeObserver(() => {
    if (`${canvas.clientWidth} ${canvas.clientHeight}` !== drawing.place) viewer.request();
  }).observe(canvas);
  const panels = new ResizeObserver(() => {
    if (JSON.stringify(viewer.freeBox) !== drawing.freePlace) viewer.request();
  });
  for (const glass of document.querySelectorAll('.glass')) panels.observe(glass);
  followPixels(viewer);
  followGraphics(viewer);
  addEventListener('hashchange', () => viewer.readAddress());
  addEventListener('dragover', event => event.preventDefault());
  addEventListener('drop', event => {
    event.preventDefault();
    viewer.open(...event.dataTransfer.files);
  });
  if (location.protocol !== 'file:' && element('page').dataset.events) followServer(viewer);
}
