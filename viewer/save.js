// Saves the picture as PNG.

import { element, make, tell } from './dom.js';

// Why a picture of this size is not what was drawn; empty if it is.
function troubleOf(gl, width, height) {
  const error = gl.getError(), is_sized = gl.drawingBufferWidth === width && gl.drawingBufferHeight === height;
  if (gl.isContextLost()) return 'the graphics card is not available now';
  if (!is_sized || error === gl.OUT_OF_MEMORY) return 'it is too large for this graphics card';
  return error === gl.NO_ERROR ? '' : `WebGL reports the error ${error}`;
}

/** The whole picture at another size, then the page's own again. @param {Viewer} viewer */
export function savePicture(viewer) {
  const fields = ['save-width', 'save-height'].map(element), own = viewer.size, { drawing, scene: { name } } = viewer;
  if (!fields.every(field => field.reportValidity())) return;
  const [width, height] = viewer.size = fields.map(field => field.valueAsNumber);
  const canvas = drawing.drawWhole(), trouble = troubleOf(drawing.renderer.gpu.gl, width, height);
  canvas.toBlob(blob => {
    if (trouble || !blob) {
      tell(`A picture of ${width} x ${height} pixels cannot be saved: ${trouble || 'the browser cannot encode it'}.`);
      return;
    }
    const link = make('a', { href: URL.createObjectURL(blob), download: `${name}.png` });
    link.click();
    URL.revokeObjectURL(link.href);
  });
  viewer.size = own;  // toBlob() has copied the picture
  viewer.request();
}
