// Cameras of Babylon.js.
import { Vector3 } from '@babylonjs/core/Maths/math.vector.js';

// The unit vector along which a camera looks, in the world.
export function forwardOf(camera) {
  const { m } = camera.getViewMatrix();
  return new Vector3(m[2], m[6], m[10]).scale(camera.getScene().useRightHandedSystem ? -1 : 1);
}
