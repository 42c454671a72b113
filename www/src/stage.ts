import {
  CircleGeometry,
  DirectionalLight,
  HemisphereLight,
  Mesh,
  NeutralToneMapping,
  PCFShadowMap,
  PerspectiveCamera,
  Scene,
  ShadowMaterial,
  Vector3,
  WebGLRenderer,
  type Object3D,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

/** Renderer, camera, light and ground of the page. */
export class Stage {
  readonly scene = new Scene();
  readonly renderer: WebGLRenderer;
  readonly camera = new PerspectiveCamera(30, 1, 0.1, 60);
  readonly controls: OrbitControls;
  readonly #sun = createSun();
  readonly #focus = new Vector3(0, 0.95, 0);
  #changed = true;

  constructor(canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.toneMapping = NeutralToneMapping;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.camera.position.set(1.1, 1.35, 4.6);
    this.controls = new OrbitControls(this.camera, canvas);
    Object.assign(this.controls, {
      enableDamping: true,
      enablePan: false,
      minDistance: 1.2,
      maxDistance: 9,
      maxPolarAngle: 1.65,
    });
    // The controls move the camera in their own event handlers too, not only in update().
    this.controls.addEventListener('change', () => (this.#changed = true));
    this.scene.add(
      new HemisphereLight('#fdfaf4', '#8d8478', 1.5),
      this.#sun,
      this.#sun.target,
      createFill(),
      createGround(),
    );
    new ResizeObserver(() => this.#resize(canvas)).observe(canvas);
    this.#resize(canvas);
  }

  /** Keeps the camera and the shadow on `object`, at the height of the hip. */
  follow(object: Object3D): void {
    const to = object.getWorldPosition(new Vector3());
    to.y = 0.5 * to.y + 0.45;
    this.camera.position.add(to).sub(this.#focus);
    this.#focus.copy(to);
    this.controls.target.copy(to);
    this.#sun.target.position.set(to.x, 0.9, to.z);
    this.#sun.position.set(to.x + 1.6, 4.2, to.z + 2.4);
  }

  /** Moves the camera as the person at the controls wants; true if the view has changed since the last call. */
  look(): boolean {
    this.controls.update();
    const changed = this.#changed;
    this.#changed = false;
    return changed;
  }

  /** Draws the scene. */
  render(): void {
    this.renderer.render(this.scene, this.camera);
  }

  #resize(canvas: HTMLCanvasElement): void {
    const { clientWidth: width, clientHeight: height } = canvas;
    this.renderer.setSize(width, height, false);
    this.#changed = true;
    this.camera.aspect = width / height;
    // The panel covers the right of a wide page and the bottom of a narrow one: the character moves out of its way.
    const wide = width > 760;
    this.camera.fov = wide ? 30 : 52;
    this.camera.setViewOffset(width, height, wide ? 0.06 * width : 0, wide ? 0 : 0.2 * height, width, height);
  }
}

function createSun(): DirectionalLight {
  const sun = new DirectionalLight('#fff3e2', 2.6);
  sun.castShadow = true;
  sun.shadow.mapSize.set(1024, 1024);
  sun.shadow.radius = 6;
  sun.shadow.normalBias = 0.015;
  Object.assign(sun.shadow.camera, { left: -1.6, right: 1.6, top: 1.6, bottom: -1.6, near: 1, far: 9 });
  return sun;
}

function createFill(): DirectionalLight {
  const fill = new DirectionalLight('#c9dcf2', 0.9);
  fill.position.set(-3, 2, -2.5);
  return fill;
}

function createGround(): Mesh {
  const ground = new Mesh(new CircleGeometry(12, 64), new ShadowMaterial({ opacity: 0.28, color: '#3b3227' }));
  ground.rotation.x = -Math.PI / 2;
  ground.receiveShadow = true;
  return ground;
}
