import type { Object3D } from 'three';

/** A turn in steps of a 32,767th; a place of the hip in steps of a tenth of a millimetre. */
const TURN = 32767;
const PLACE = 1e4;

/** A pose as text for an address: the turn of every bone, and the place of the hip. */
export function writePose(bones: readonly Object3D[], hip: Object3D): string {
  const turns = bones.flatMap(({ quaternion }) => quaternion.toArray().map((value) => Math.round(TURN * value)));
  const place = hip.position.toArray().map((value) => Math.round(PLACE * value));
  // Places in 32 bits: a character may be modelled in centimetres.
  const bytes = new Uint8Array([...new Uint8Array(Int32Array.from(place).buffer), ...new Uint8Array(Int16Array.from(turns).buffer)]);
  return btoa(String.fromCharCode(...bytes)).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
}

/** Poses the bones as such a text says. */
export function readPose(text: string, bones: readonly Object3D[], hip: Object3D): void {
  const refuse = () => new Error(`the pose of this address is not one of a figure with ${bones.length} bones`);
  let decoded: string;
  try {
    decoded = atob(text.replaceAll('-', '+').replaceAll('_', '/'));
  } catch {
    throw refuse();
  }
  const bytes = Uint8Array.from(decoded, (letter) => letter.charCodeAt(0));
  if (bytes.length !== 12 + 8 * bones.length) throw refuse();
  const place = new Int32Array(bytes.buffer.slice(0, 12));
  const turns = new Int16Array(bytes.buffer.slice(12));
  bones.forEach((bone, i) => {
    bone.quaternion.fromArray([...turns.subarray(4 * i, 4 * i + 4)]).normalize();
    if (bone.quaternion.lengthSq() === 0) throw refuse();
  });
  hip.position.fromArray([...place].map((value) => value / PLACE));
}
