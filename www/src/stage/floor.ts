import {
  CanvasTexture,
  CircleGeometry,
  Group,
  Mesh,
  MeshBasicMaterial,
  PlaneGeometry,
  ShadowMaterial,
  Vector3,
  type Object3D,
} from 'three';

/** How high above the floor a part still darkens it, in heights of the figure. */
const FADE = 0.14;

/** A floor that shows the lamp's shadow, and a soft dark spot under whatever comes near it. */
export class Floor extends Group {
  readonly #geometry = new PlaneGeometry(1, 1).rotateX(-Math.PI / 2);
  readonly #texture = createSpot();
  readonly #at = new Vector3();
  #parts: readonly { bone: Object3D; spot: Mesh; size: number; reach: number }[] = [];

  constructor() {
    super();
    const ground = new Mesh(new CircleGeometry(14, 64), new ShadowMaterial({ opacity: 0.2, color: '#2b241c' }));
    ground.rotation.x = -Math.PI / 2;
    ground.receiveShadow = true;
    this.add(ground);
  }

  /** The parts of a figure so many metres high that may touch the floor; the first of them is its middle. */
  watch(bones: readonly Object3D[], height: number): void {
    for (const { spot } of this.#parts) {
      spot.removeFromParent();
      (spot.material as MeshBasicMaterial).dispose();
    }
    this.#parts = bones.map((bone, i) => {
      const look = { map: this.#texture, color: '#000', transparent: true, depthWrite: false, opacity: 0 };
      const spot = new Mesh(this.#geometry, new MeshBasicMaterial({ ...look, toneMapped: false }));
      // Above one another, so that none flickers.
      spot.position.y = 0.001 + 0.0004 * i;
      spot.renderOrder = -1;
      this.add(spot);
      return i === 0 ? { bone, spot, size: 0.75 * height, reach: 0.9 * height } : { bone, spot, size: 0.24 * height, reach: FADE * height };
    });
  }

  /** Moves the spots to where the parts are now. */
  update(): void {
    for (const { bone, spot, size, reach } of this.#parts) {
      const { x, y, z } = bone.getWorldPosition(this.#at);
      const near = Math.max(1 - Math.max(y, 0) / reach, 0);
      spot.visible = near > 0;
      spot.position.set(x, spot.position.y, z);
      spot.scale.setScalar(size * (1.5 - 0.5 * near));
      (spot.material as MeshBasicMaterial).opacity = 0.55 * near;
    }
  }
}

function createSpot(): CanvasTexture {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 128;
  const context = canvas.getContext('2d')!;
  const gradient = context.createRadialGradient(64, 64, 0, 64, 64, 64);
  for (let i = 0; i <= 8; i++) gradient.addColorStop(i / 8, `rgb(0 0 0 / ${Math.cos((Math.PI / 16) * i) ** 3})`);
  context.fillStyle = gradient;
  context.fillRect(0, 0, 128, 128);
  return new CanvasTexture(canvas);
}
