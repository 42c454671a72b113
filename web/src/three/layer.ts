import { Matrix4, Vector3, type Camera, type Object3D, type OrthographicCamera } from 'three';

const eye = new Vector3();
const way = new Vector3();
const move = new Matrix4();

/**
 * Has an object drawn as if it were so many metres nearer to the camera, at the same place in the picture: cloth over
 * other cloth, of which neither knows. Moved for the time of its drawing alone, since a depth offset of its material
 * would be that of all that have the material.
 */
export function drawNearer(object: Object3D, metres: () => number): void {
  const before = new Matrix4();
  object.onBeforeRender = function (this: Object3D, _renderer, _scene, camera: Camera) {
    before.copy(this.matrixWorld);
    eye.setFromMatrixPosition(camera.matrixWorld);
    way.setFromMatrixPosition(before).sub(eye);
    const far = way.length();
    if (far <= metres()) return;
    if ((camera as OrthographicCamera).isOrthographicCamera) {
      camera.getWorldDirection(way).multiplyScalar(-metres());
      move.makeTranslation(way);
    } else {
      // A smaller figure, nearer, is the same picture.
      const scale = 1 - metres() / far;
      move.makeScale(scale, scale, scale).setPosition(eye.multiplyScalar(1 - scale));
    }
    this.matrixWorld.premultiply(move);
  };
  object.onAfterRender = function (this: Object3D) {
    this.matrixWorld.copy(before);
  };
}
