import { Material, MeshBasicMaterial, Vector3, type BufferAttribute } from 'three';
import type { BackendChoice, ClothModel, Quality } from 'ctsn';
import { Cloth } from 'ctsn/three';
import { RATE, type Character } from './character.js';
import { createFabric } from './fabric.js';
import type { Capture } from './hook.js';
import { Meter } from './meter.js';
import type { Panel } from './panel.js';
import type { Stage } from './stage.js';

/** Predictions over which a change of quality is spread. */
const BLEND = 12;

/** The running page: moves the character, predicts the cloth and draws both, once per animation frame. */
export class RunningDemo {
  readonly meter = new Meter();
  /** Predictions since the page was opened. */
  predictions = 0;
  readonly #stage: Stage;
  readonly #character: Character;
  readonly #panel: Panel;
  readonly #cloth: Cloth;
  readonly #fabric: Material;
  #changed = true;
  /** Whether a prediction came back from the GPU that is not drawn yet. */
  #arrived = false;
  readonly #mesh = new MeshBasicMaterial({ wireframe: true, color: '#2d4f6b' });

  constructor(stage: Stage, character: Character, model: ClothModel, panel: Panel) {
    this.#stage = stage;
    this.#character = character;
    this.#panel = panel;
    character.show(panel.wishes.clip, 0);
    this.#cloth = new Cloth(model, character.scene, this.#mesh);
    this.#fabric = createFabric(this.#cloth.geometry);
    this.#cloth.castShadow = this.#cloth.receiveShadow = true;
    stage.scene.add(character.scene, this.#cloth);
    panel.onScrub = (seconds) => {
      character.show(panel.wishes.clip, seconds);
      this.#changed = true;
    };
    panel.onChange = () => {
      this.#changed = true;
      this.meter.reset();
      if (panel.wishes.clip !== character.clip) character.show(panel.wishes.clip, 0);
    };
    panel.onBackend = (choice) => void this.compute(choice);
    model.addEventListener('backend', () => this.#tell());
    this.#tell();
  }

  /** Runs until the page closes. While nothing moves, nothing is drawn. */
  run(): void {
    let last: number | undefined;
    this.#stage.renderer.setAnimationLoop((now: number) => {
      // A page in the background gets no animation frames; when it is back, the motion goes on where it stood.
      const seconds = Math.min((now - (last ?? now)) / 1000, 0.1);
      last = now;
      const { playing } = this.#panel.wishes;
      if (playing) this.#character.advance(seconds);
      if (this.#stage.look() || playing || this.#changed) this.draw();
      else if (this.#arrived) this.#render();
    });
  }

  /** Predicts the cloth for the pose of the character, and draws both. */
  draw(): void {
    const { wishes } = this.#panel;
    this.#changed = false;
    this.#predict();
    this.predictions++;
    this.#cloth.material = wishes.wireframe ? this.#mesh : this.#fabric;
    this.#stage.follow(this.#cloth.bones[this.#cloth.model.rootIndex]!);
    this.#render();
    const { time, duration } = this.#character;
    this.#panel.show({ milliseconds: this.meter.median, time, duration });
  }

  /** Computes the cloth elsewhere from now on. */
  async compute(choice: BackendChoice): Promise<void> {
    this.#panel.showBackend('trying…', '');
    await this.#cloth.model.setBackend(choice);
    this.#tell();
  }

  /** Settles when the prediction asked for last is drawn. */
  async settled(): Promise<void> {
    await this.#cloth.settled();
    this.#render();
  }

  #render(): void {
    this.#arrived = false;
    this.#stage.render();
  }

  /** Times the prediction: on the GPU until it is back. */
  #predict(): void {
    const start = performance.now();
    // At rest the next picture is the last for a while: it shows what was chosen.
    this.#cloth.blend = this.#panel.wishes.playing ? BLEND : 0;
    this.#cloth.quality = this.#panel.wishes.quality;
    const late = this.#cloth.update().backend === 'webgpu';
    const end = () => this.meter.add(performance.now() - start);
    if (!late) return end();
    void this.#cloth.settled().then(() => {
      end();
      this.#arrived = true;
    });
  }

  #tell(): void {
    const { backend, adapter, fallback, measured } = this.#cloth.model;
    this.meter.reset();
    this.#changed = true;
    const figures = measured
      ? ` Measured: ${measured.webgpu.toFixed(1)} ms, the processor ${measured.cpu.toFixed(1)} ms.`
      : '';
    if (backend === 'cpu') this.#panel.showBackend('Processor', fallback ? `Not WebGPU: ${fallback}.` : '');
    else this.#panel.showBackend(`WebGPU, ${adapter}`, `Read back for WebGL: the cloth shows a frame late.${figures}`);
  }

  /** Stops the page at a frame of a clip. */
  stop(clip: string, frame: number, quality: Quality): void {
    this.#panel.play(false);
    this.#panel.choose(quality);
    this.#character.show(clip, frame / RATE);
    this.#panel.select(clip);
    this.draw();
  }

  /** What the page shows now. */
  capture(): Capture {
    const { bones, geometry, matrixWorld, model } = this.#cloth;
    const position = geometry.getAttribute('position') as BufferAttribute;
    const normal = geometry.getAttribute('normal') as BufferAttribute;
    return {
      clip: this.#character.clip,
      frame: this.#character.time * RATE,
      quality: this.#panel.wishes.quality,
      joints: [...model.joints],
      pose: bones.flatMap((bone) => bone.matrixWorld.elements),
      positions: collect(position, (at) => at.applyMatrix4(matrixWorld)),
      normals: collect(normal, (at) => at.transformDirection(matrixWorld)),
      vertex: model.surface ? [...model.surface.vertex] : Array.from({ length: model.vertexCount }, (_, i) => i),
    };
  }
}

function collect(attribute: BufferAttribute, toWorld: (at: Vector3) => Vector3): number[] {
  const at = new Vector3();
  const one = (i: number) => toWorld(at.fromBufferAttribute(attribute, i));
  return Array.from({ length: attribute.count }, (_, i) => one(i).toArray()).flat();
}
