import { Plane, Raycaster, Vector2, Vector3, type Object3D } from 'three';
import { element } from '../dom.js';
import { isShortcut } from '../stage/keys.js';
import type { Stage } from '../stage/stage.js';
import { findHandles, type Handle } from './limbs.js';

/** Metres that an arrow key moves, in heights of the figure. */
const STEP = 0.015;
const arrows: Readonly<Record<string, readonly [number, number]>> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

/** Handles on the figure, buttons over the picture, that pose it by mouse, finger or keyboard. */
export class Poser {
  /** Called before the first move, and after each. */
  onStart: () => void = () => {};
  onMove: () => void = () => {};

  readonly #stage: Stage;
  readonly #layer = element('handles');
  readonly #ray = new Raycaster();
  readonly #plane = new Plane();
  readonly #at = new Vector3();
  #handles: readonly { handle: Handle; button: HTMLButtonElement }[] = [];

  constructor(stage: Stage) {
    this.#stage = stage;
    this.#layer.hidden = true;
  }

  get shown(): boolean {
    return !this.#layer.hidden;
  }

  set shown(shown: boolean) {
    this.#layer.hidden = !shown;
    // Nothing may be drawn for a while.
    this.update();
  }

  /** Makes handles for a figure. */
  hold(bones: readonly Object3D[], hip: Object3D): void {
    this.#handles = findHandles(bones, hip).map((handle) => ({ handle, button: this.#button(handle) }));
    this.#layer.replaceChildren(...this.#handles.map(({ button }) => button));
  }

  /** Moves the buttons to where their bones are seen. */
  update(): void {
    if (!this.shown) return;
    const { clientWidth, clientHeight } = this.#layer;
    for (const { handle, button } of this.#handles) {
      const { x, y, z } = handle.bone.getWorldPosition(this.#at).project(this.#stage.camera);
      button.hidden = z > 1;
      button.style.transform = `translate(${(0.5 + 0.5 * x) * clientWidth}px, ${(0.5 - 0.5 * y) * clientHeight}px)`;
    }
  }

  #button(handle: Handle): HTMLButtonElement {
    const button = document.createElement('button');
    button.type = 'button';
    button.title = handle.name;
    button.setAttribute('aria-label', `${handle.name}: drag, or use the arrow keys`);
    button.addEventListener('pointerdown', (event) => {
      button.setPointerCapture(event.pointerId);
      const at = handle.bone.getWorldPosition(new Vector3());
      this.#plane.setFromNormalAndCoplanarPoint(this.#stage.camera.getWorldDirection(new Vector3()), at);
      this.onStart();
    });
    button.addEventListener('pointermove', (event) => {
      if (!button.hasPointerCapture(event.pointerId)) return;
      const target = this.#under(event);
      if (target) this.#drag(handle, target);
    });
    button.addEventListener('keydown', (event) => {
      const arrow = arrows[event.key];
      if (!arrow || isShortcut(event)) return;
      event.preventDefault();
      this.onStart();
      const { camera, height } = this.#stage;
      const [right, up] = [new Vector3(), new Vector3()];
      camera.matrixWorld.extractBasis(right, up, new Vector3());
      const at = handle.bone.getWorldPosition(new Vector3());
      this.#drag(handle, at.addScaledVector(right, STEP * height * arrow[0]).addScaledVector(up, STEP * height * arrow[1]));
    });
    return button;
  }

  #drag(handle: Handle, target: Vector3): void {
    handle.drag(target);
    this.onMove();
  }

  /** Where the pointer is, in the plane that stands before the camera. */
  #under({ clientX, clientY }: PointerEvent): Vector3 | undefined {
    const { left, top, width, height } = this.#layer.getBoundingClientRect();
    const at = new Vector2((2 * (clientX - left)) / width - 1, 1 - (2 * (clientY - top)) / height);
    this.#ray.setFromCamera(at, this.#stage.camera);
    return this.#ray.ray.intersectPlane(this.#plane, new Vector3()) ?? undefined;
  }
}
