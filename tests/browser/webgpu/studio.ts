// Pictures for webgpu.test.ts: a renderer of three's with its scene, and how much two pictures differ.
import * as THREE from 'three/webgpu';
import { deviceOf, type Cloth } from 'ctsn/three';

const [width, height] = [320, 240];

/** A renderer with its scene, and pictures of it. */
export class Studio {
  readonly scene = new THREE.Scene();
  readonly camera = new THREE.PerspectiveCamera(40, width / height, 0.05, 50);
  readonly target = new THREE.RenderTarget(width, height);
  readonly errors: string[] = [];

  readonly #sun = new THREE.DirectionalLight(0xffffff, 3);
  readonly #floor = new THREE.Mesh(
    new THREE.PlaneGeometry(8, 8).rotateX(-Math.PI / 2),
    new THREE.MeshStandardNodeMaterial({ color: 0xbbbbbb }),
  );

  private constructor(readonly renderer: THREE.WebGPURenderer) {
    renderer.shadowMap.enabled = true;
    this.#sun.castShadow = true;
    Object.assign(this.#sun.shadow.camera, { left: -2, right: 2, top: 2, bottom: -2, far: 20 });
    this.#sun.shadow.normalBias = 0.03;
    this.#floor.receiveShadow = true;
    this.scene.background = new THREE.Color(0x203040);
    this.scene.add(this.#sun, this.#sun.target, new THREE.AmbientLight(0xffffff, 0.4), this.#floor);
  }

  static async open(): Promise<Studio> {
    const canvas = Object.assign(document.createElement('canvas'), { width, height });
    document.body.append(canvas);
    const renderer = new THREE.WebGPURenderer({ canvas });
    await renderer.init();
    renderer.setSize(width, height);
    const studio = new Studio(renderer);
    const device = deviceOf(renderer);
    if (!device) throw new Error('three.js found no WebGPU adapter');
    device.addEventListener('uncapturederror', ({ error }) => studio.errors.push(error.message));
    // r170 draws no shadows the first time.
    await studio.picture();
    return studio;
  }

  /** Looks from the front and above at a cloth that is drawn from arrays. Its shadow falls to the right. */
  lookAt(cloth: Cloth): void {
    const { center, radius } = cloth.geometry.boundingSphere!.clone().applyMatrix4(cloth.matrixWorld);
    this.camera.position.set(center.x + 0.5 * radius, center.y + radius, center.z + 2.5 * radius);
    this.camera.lookAt(center);
    this.#floor.position.copy(center).setY(center.y - radius);
    this.#sun.position.copy(center).add(new THREE.Vector3(-2, 3, 0.5));
    this.#sun.target.position.copy(center);
  }

  /** The pixels of the scene, and the scene on the page. */
  async picture(): Promise<Uint8Array> {
    // three draws shadows once per animation frame of the page.
    await new Promise(requestAnimationFrame);
    this.renderer.setRenderTarget(this.target);
    this.renderer.render(this.scene, this.camera);
    const pixels = await this.renderer.readRenderTargetPixelsAsync(this.target, 0, 0, width, height);
    this.renderer.setRenderTarget(null);
    this.renderer.render(this.scene, this.camera);
    return new Uint8Array(pixels.buffer);
  }

  close(): void {
    this.renderer.domElement.remove();
    this.renderer.dispose();
  }
}

/** Share of the pixels that clearly differ. */
export function differing(a: Uint8Array, b: Uint8Array): number {
  if (a.length !== b.length || a.length < 4 * width * height) return 1;
  let count = 0;
  const differs = (at: number) => Math.abs(a[at]! - b[at]!) > 8;
  for (let at = 0; at < a.length; at += 4) if (differs(at) || differs(at + 1) || differs(at + 2)) count++;
  return (4 * count) / a.length;
}

/** Puts pictures side by side on the page, for people. */
export function show(...pictures: Uint8Array[]): void {
  for (const pixels of pictures) {
    const canvas = Object.assign(document.createElement('canvas'), { width, height });
    const image = new ImageData(Uint8ClampedArray.from(pixels), width, height);
    canvas.getContext('2d')!.putImageData(image, 0, 0);
    document.body.append(canvas);
  }
}
