import { AnimationMixer, SkinnedMesh, type AnimationAction, type Group } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

/** Frames of a clip per second, wherever this page counts them. */
export const RATE = 30;

/** The skinned character of a glTF file and its motion. */
export class Character {
  readonly scene: Group;
  /** Names of its clips. */
  readonly clips: readonly string[];
  readonly #mixer: AnimationMixer;
  readonly #actions: ReadonlyMap<string, AnimationAction>;
  #action: AnimationAction | undefined;

  private constructor(scene: Group, mixer: AnimationMixer, actions: Map<string, AnimationAction>) {
    this.scene = scene;
    this.#mixer = mixer;
    this.#actions = actions;
    this.clips = [...actions.keys()];
  }

  /** Reads a GLB file [bytes]. */
  static async parse(bytes: ArrayBuffer): Promise<Character> {
    const { scene, animations } = await new GLTFLoader().parseAsync(bytes, '');
    const mixer = new AnimationMixer(scene);
    scene.traverse((object) => {
      if (!(object instanceof SkinnedMesh)) return;
      object.castShadow = object.receiveShadow = true;
      // Its bounds are those of the bind pose, and the character moves.
      object.frustumCulled = false;
    });
    if (animations.length === 0) throw new Error('the character has no motion');
    return new Character(scene, mixer, new Map(animations.map((clip) => [clip.name, mixer.clipAction(clip)])));
  }

  /** Name of the clip being shown. */
  get clip(): string {
    return this.#action?.getClip().name ?? '';
  }

  /** Seconds the clip lasts. */
  get duration(): number {
    return this.#action?.getClip().duration ?? 0;
  }

  /** Seconds since the clip's beginning. */
  get time(): number {
    return this.#action?.time ?? 0;
  }

  /** Seconds a clip lasts. */
  length(clip: string): number {
    return this.#named(clip).getClip().duration;
  }

  /** Poses the character: a clip, at a time in seconds. */
  show(clip: string, time: number): void {
    const action = this.#named(clip);
    if (action !== this.#action) {
      this.#action?.stop();
      this.#action = action.play();
    }
    action.time = Math.min(Math.max(time, 0), action.getClip().duration);
    this.#mixer.update(0);
  }

  /** Moves on by some seconds; clips repeat. */
  advance(seconds: number): void {
    this.#mixer.update(seconds);
  }

  #named(clip: string): AnimationAction {
    const action = this.#actions.get(clip);
    if (!action) throw new Error(`the character has no clip "${clip}"; it has ${this.clips.join(', ')}`);
    return action;
  }
}
