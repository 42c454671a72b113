import { Material, MeshBasicMaterial, Vector3, type BufferAttribute } from 'three';
import type { ClothModel, StreamChoice } from 'ctsn';
import { Cloth } from 'ctsn/three';
import { RATE, type Character } from './character.js';
import { createFabric } from './fabric.js';
import type { Capture } from './hook.js';
import { Meter } from './meter.js';
import type { Panel } from './panel.js';
import type { Stage } from './stage.js';

/** The running page: character, cloth, controls and stage, one frame after the other. */
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
  }

  /** Runs until the page closes. A page at rest draws nothing. */
  run(): void {
    let last: number | undefined;
    this.#stage.renderer.setAnimationLoop((now: number) => {
      // A page in the background gets no frames; the motion goes on where it stood.
      const seconds = Math.min((now - (last ?? now)) / 1000, 0.1);
      last = now;
      const { playing } = this.#panel.wishes;
      if (playing) this.#character.advance(seconds);
      if (this.#stage.look() || playing || this.#changed) this.draw();
    });
  }

  /** Predicts the cloth for the character as it stands, and draws both. */
  draw(): void {
    const { wishes } = this.#panel;
    this.#changed = false;
    this.meter.time(() => this.#cloth.update(wishes));
    this.predictions++;
    this.#cloth.material = wishes.wireframe ? this.#mesh : this.#fabric;
    this.#stage.follow(this.#cloth.bones[this.#cloth.model.rootIndex]!);
    this.#stage.render();
    const { time, duration } = this.#character;
    this.#panel.show({ milliseconds: this.meter.median, time, duration });
  }

  /** Freezes the page at a frame of a clip. */
  freeze(clip: string, frame: number, streams: StreamChoice): void {
    this.#panel.play(false);
    this.#panel.choose(streams);
    this.#character.show(clip, frame / RATE);
    this.#panel.select(clip);
    this.draw();
  }

  /** The frame that stands on the page. */
  capture(): Capture {
    const { bones, geometry, matrixWorld, model } = this.#cloth;
    const position = geometry.getAttribute('position') as BufferAttribute;
    const normal = geometry.getAttribute('normal') as BufferAttribute;
    return {
      clip: this.#character.clip,
      frame: this.#character.time * RATE,
      streams: this.#panel.wishes.streams,
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
  return Array.from({ length: attribute.count }, (_, i) => toWorld(at.fromBufferAttribute(attribute, i)).toArray()).flat();
}
