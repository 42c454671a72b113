import {
  Box3,
  NeutralToneMapping,
  PCFShadowMap,
  PerspectiveCamera,
  Scene,
  Vector2,
  Vector3,
  WebGLRenderer,
  type Object3D,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { Floor } from './floor.js';
import { wayOf } from './keys.js';
import { createStudio, createSun } from './light.js';
import { Sketch } from './sketch.js';

/** Pixels that controls cover at each side of the picture. */
export interface Margins {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

/**
 * A view: angles in degrees; distance, and how far above the figure's middle it looks, in heights of the figure.
 */
export interface View {
  around: number;
  up: number;
  far: number;
  lift: number;
}

const FIELD = 28;
/** Milliseconds that the first drawing with a program of a sketch may take. Software takes 200 to 400. */
const SLOW = 100;
/** As far above and below its middle as a figure is looked at, in its heights. */
const LIFT = 0.5;

const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));

/** Renderer, camera, light and floor of the page. */
export class Stage {
  readonly scene = new Scene();
  readonly renderer: WebGLRenderer;
  readonly camera = new PerspectiveCamera(FIELD, 1, 0.02, 60);
  readonly controls: OrbitControls;
  readonly floor = new Floor();
  /** Settles when what is drawn is a sketch no longer. */
  finished: Promise<void> = Promise.resolve();
  readonly #canvas: HTMLCanvasElement;
  readonly #sun = createSun();
  readonly #focus = new Vector3(0, 0.9, 0);
  /** Height of the figure, and of its middle above the floor, metres. */
  #height = 1.8;
  #middle = 0.9;
  #changed = true;
  #margins: Margins = { left: 0, right: 0, top: 0, bottom: 0 };
  readonly #sketch = new Sketch();
  #sketching = false;

  constructor(canvas: HTMLCanvasElement) {
    this.#canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.toneMapping = NeutralToneMapping;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.controls = new OrbitControls(this.camera, canvas);
    Object.assign(this.controls, { enableDamping: true, maxPolarAngle: 1.62, zoomSpeed: 0.7 });
    // The controls move the camera in their own event handlers too, not only in update().
    this.controls.addEventListener('change', () => (this.#changed = true));
    this.scene.environment = createStudio();
    this.scene.environmentIntensity = 0.85;
    this.scene.add(this.#sun, this.#sun.target, this.floor);
    this.#resize();
    new ResizeObserver(() => this.#resize()).observe(canvas);
    canvas.addEventListener('keydown', (event) => this.#press(event));
    this.look({ around: 14, up: 6, far: 2.5, lift: 0 });
  }

  /** Makes room for a figure: its size as it stands now, and the parts of it that touch the floor. */
  welcome(figure: Object3D, bones: readonly Object3D[]): void {
    const { view } = this;
    const box = new Box3().setFromObject(figure, true);
    const size = box.getSize(new Vector3());
    // What is longer or broader than it is high, an animal or a rail, is seen from as far as if it were as high.
    this.#height = Math.max(size.y, 0.7 * size.z, 0.9 * size.x, 0.3);
    this.#middle = 0.5 * (box.min.y + box.max.y);
    const reach = 0.95 * this.#height;
    Object.assign(this.#sun.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: 0.1, far: 9 });
    this.#sun.shadow.camera.updateProjectionMatrix();
    Object.assign(this.controls, { minDistance: Math.min(0.3, 0.4 * this.#height), maxDistance: 6 * this.#height });
    this.floor.watch(bones, this.#height);
    this.look(view);
  }

  /** Keeps camera and lamp between two bones, the figure's hip and its head, and at the height of the first. */
  follow(hip: Object3D, head: Object3D): void {
    const to = hip.getWorldPosition(new Vector3());
    const { x, z } = head.getWorldPosition(new Vector3()).lerp(to, 0.5);
    to.set(x, to.y, z);
    to.y = this.#middle + 0.4 * (to.y - this.#middle);
    for (const point of [this.camera.position, this.controls.target]) point.add(to).sub(this.#focus);
    this.#focus.copy(to);
    this.#sun.target.position.copy(to);
    this.#sun.position.set(to.x + 1.7, to.y + 3, to.z + 2.2);
    this.floor.update();
  }

  /** Of the figure, metres. */
  get height(): number {
    return this.#height;
  }

  /** Where the camera stands. */
  get view(): View {
    const way = this.camera.position.clone().sub(this.controls.target);
    const far = way.length();
    const degrees = 180 / Math.PI;
    return {
      around: Math.round(degrees * Math.atan2(way.x, way.z)),
      up: Math.round(degrees * Math.asin(way.y / far)),
      far: Number((far / this.#height).toFixed(2)),
      lift: Number(((this.controls.target.y - this.#focus.y) / this.#height).toFixed(2)),
    };
  }

  /** Moves the camera around the figure. */
  look({ around, up, far, lift }: View): void {
    const [a, b] = [(Math.PI / 180) * around, (Math.PI / 180) * up];
    const way = new Vector3(Math.sin(a) * Math.cos(b), Math.sin(b), Math.cos(a) * Math.cos(b));
    this.controls.target.copy(this.#focus);
    this.controls.target.y += lift * this.#height;
    this.camera.position.copy(this.controls.target).addScaledVector(way, far * this.#height);
    this.controls.update();
    this.#changed = true;
  }

  /** Where the figure's middle is in the picture, from its left as a share of its width. */
  get middle(): number {
    const { left, right } = this.#margins;
    return 0.5 + (left - right) / (2 * this.#canvas.clientWidth);
  }

  /** Moves the camera as the person at the controls wants; true if the view has changed since the last call. */
  turn(): boolean {
    this.controls.update();
    this.#hold();
    const changed = this.#changed;
    this.#changed = false;
    return changed;
  }

  /**
   * Compiles what these objects are drawn with, beside the page's own work. A first `render()` does it, too, and the
   * page stands still meanwhile.
   */
  async prepare(object: Object3D): Promise<void> {
    const { renderer, camera, scene } = this;
    // Without that extension nothing tells when a program is there: three would warn, and not wait.
    if (renderer.extensions.has('KHR_parallel_shader_compile')) await renderer.compileAsync(object, camera, scene);
    else renderer.compile(object, camera, scene);
  }

  /** Whether what is drawn is a sketch. */
  get isSketching(): boolean {
    return this.#sketching;
  }

  /** Whether this machine takes so long over a program that sketches should be drawn first: that of `piece` tells. */
  async isSlow(piece: Object3D): Promise<boolean> {
    const { renderer, camera, scene } = this;
    const start = performance.now();
    scene.add(piece);
    this.#sketch.of(scene, this.#sun, () => renderer.render(scene, camera));
    scene.remove(piece);
    await this.#passed();
    return performance.now() - start > SLOW;
  }

  /** Draws sketches until what is to draw is prepared, which begins when `seen` has settled and was drawn. */
  sketch(seen: Promise<unknown>, prepare: () => Promise<unknown>): void {
    this.#sketching = true;
    const mark = async (name: string) => {
      // A frame that is drawn wholly after this.
      await frame();
      await frame();
      await this.#passed();
      performance.mark(`ctsn ${name}`);
    };
    const end = () => {
      this.#sketching = false;
      this.#sketch.dispose();
      this.#changed = true;
    };
    const settled = () => Promise.allSettled([seen]);
    this.finished = mark('cloth').then(settled).then(() => mark('folds')).then(prepare).then(end, end);
  }

  /** Settles when the GPU has done all that it was told until now. */
  async #passed(): Promise<void> {
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    const sync = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    // A page that nobody looks at has no frames.
    const wait = () => new Promise((resolve) => setTimeout(resolve, 4));
    while (sync && !gl.isContextLost() && gl.getSyncParameter(sync, gl.SYNC_STATUS) !== gl.SIGNALED) await wait();
    gl.deleteSync(sync);
  }

  render(): void {
    const { renderer, scene, camera } = this;
    const draw = () => renderer.render(scene, camera);
    if (this.#sketching) this.#sketch.of(scene, this.#sun, draw);
    else draw();
  }

  /** Does something without controls, seen from elsewhere, and leaves all as it was. */
  aside<T>(view: View | undefined, work: () => T): T {
    const [position, target, margins] = [this.camera.position.clone(), this.controls.target.clone(), this.#margins];
    this.frame({ left: 0, right: 0, top: 0, bottom: 0 });
    if (view) this.look(view);
    try {
      return work();
    } finally {
      this.frame(margins);
      this.controls.target.copy(target);
      this.camera.position.copy(position);
      this.controls.update();
    }
  }

  /** Moves the figure into the middle of what no control covers, and as far away as it then must be. */
  frame(margins: Margins): void {
    this.#margins = margins;
    this.#resize();
  }

  /** Keeps what is looked at on the figure's axis, and on the figure. */
  #hold(): void {
    const { target } = this.controls;
    const most = LIFT * this.#height;
    const wanted = this.#focus.clone();
    wanted.y += Math.min(Math.max(target.y - wanted.y, -most), most);
    this.camera.position.add(wanted).sub(target);
    target.copy(wanted);
  }

  #press(event: KeyboardEvent): void {
    const way = wayOf(event);
    if (!way) return;
    event.preventDefault();
    const { around, up, far, lift } = this.view;
    this.look({ around: around + way[0], up: Math.min(Math.max(up + way[1], -2), 85), far: Math.min(Math.max(far * way[2], 0.25), 6), lift: lift + way[3] });
  }

  #resize(): void {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    const { left, right, top, bottom } = this.#margins;
    // The same size again would be a new canvas, for which the page waits until the GPU has done all before.
    const { x, y } = this.renderer.getSize(new Vector2());
    if (x !== width || y !== height) this.renderer.setSize(width, height, false);
    this.#changed = true;
    this.camera.aspect = width / height;
    const free = { width: Math.max(width - left - right, 160), height: Math.max(height - top - bottom, 160) };
    // A figure with its arms out is about as wide as high; it may reach under the controls.
    const least = Math.min(free.height, 1.3 * free.width) / height;
    this.camera.fov = (360 / Math.PI) * Math.atan(Math.tan((FIELD * Math.PI) / 360) / least);
    this.camera.setViewOffset(width, height, (right - left) / 2, (bottom - top) / 2, width, height);
  }
}
