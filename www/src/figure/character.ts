import { AnimationMixer, Bone, Mesh, SkinnedMesh, Texture, type AnimationAction, type AnimationClip, type Group, type Object3D } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

/** Frames of a clip per second, wherever this page counts them. */
export const RATE = 30;

/** The skinned character of a glTF file and its motion. */
export class Character {
  readonly scene: Group;
  readonly meshes: readonly SkinnedMesh[];
  /** Triangles of its meshes, as their file has them: indices of vertices, three by three. */
  readonly triangles: ReadonlyMap<SkinnedMesh, ArrayLike<number>>;
  /** All bones, those above before those below. */
  readonly bones: readonly Object3D[];
  readonly motion: readonly AnimationClip[];
  /** Names of its clips. */
  readonly clips: readonly string[];
  readonly #mixer: AnimationMixer;
  readonly #actions: ReadonlyMap<string, AnimationAction>;
  #action: AnimationAction | undefined;

  private constructor(scene: Group, meshes: SkinnedMesh[], motion: AnimationClip[]) {
    this.scene = scene;
    this.meshes = meshes;
    const bones: Object3D[] = [];
    scene.traverse((object) => object instanceof Bone && bones.push(object));
    this.bones = bones;
    this.triangles = new Map(meshes.map((mesh) => [mesh, trianglesOf(mesh)]));
    this.motion = motion;
    this.clips = motion.map(({ name }) => name);
    this.#mixer = new AnimationMixer(scene);
    this.#actions = new Map(motion.map((clip) => [clip.name, this.#mixer.clipAction(clip)]));
  }

  /** Reads a GLB file [bytes], compressed by gzip or not; `name` is what messages call it. */
  static async parse(bytes: ArrayBuffer, name: string): Promise<Character> {
    const { scene, animations } = await read(bytes, name);
    const meshes: SkinnedMesh[] = [];
    scene.traverse((object) => {
      if (!(object instanceof SkinnedMesh)) return;
      object.castShadow = object.receiveShadow = true;
      // Its bounds are those of the bind pose, and the character moves.
      object.frustumCulled = false;
      meshes.push(object);
    });
    if (meshes.length === 0) throw new Error(`${name} has no skinned mesh: a character with a skeleton is wanted`);
    return new Character(scene, meshes, animations);
  }

  /** Name of the clip being shown; none where the pose is one's own. */
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

  /** Poses the character as at another time of its clip; its clock stays where it is. */
  glance(time: number): void {
    const action = this.#action;
    if (!action) return;
    const { time: now } = action;
    this.show(this.clip, time);
    action.time = now;
  }

  /** Moves on by some seconds; clips repeat. */
  advance(seconds: number): void {
    this.#mixer.update(seconds);
  }

  /** Frees what its file brought. */
  dispose(): void {
    this.#mixer.stopAllAction();
    for (const { skeleton } of this.meshes) skeleton.dispose();
    // Shoes and hair may hang from a bone, without weights.
    this.scene.traverse((object) => {
      if (!(object instanceof Mesh)) return;
      const { geometry, material } = object as Mesh;
      geometry.dispose();
      for (const one of [material].flat()) {
        for (const value of Object.values(one)) if (value instanceof Texture) value.dispose();
        one.dispose();
      }
    });
    this.scene.removeFromParent();
  }

  #named(clip: string): AnimationAction {
    const action = this.#actions.get(clip);
    if (!action) throw new Error(`the character has no clip "${clip}"; it has ${this.clips.join(', ')}`);
    return action;
  }
}

function trianglesOf({ geometry }: SkinnedMesh): ArrayLike<number> {
  const { count } = geometry.getAttribute('position');
  return geometry.index?.array ?? Uint32Array.from({ length: count }, (_, vertex) => vertex);
}

async function read(file: ArrayBuffer, name: string) {
  const refuse = (error: unknown): never => {
    throw new Error(`${name} is no glTF file that can be read: ${error instanceof Error ? error.message : String(error)}`);
  };
  const bytes = await unzip(file).catch(refuse);
  const loader = new GLTFLoader();
  // What is compressed so says it in the text at its beginning; what unpacks it is fetched for it alone.
  const beginning = new TextDecoder('latin1').decode(bytes.slice(0, 1 << 20));
  if (/(EXT|KHR)_meshopt_compression/.test(beginning)) {
    loader.setMeshoptDecoder((await import('three/addons/libs/meshopt_decoder.module.js')).MeshoptDecoder);
  }
  return loader.parseAsync(bytes, '').catch(refuse);
}

/** What gzip made the file of, by its first two bytes, or the file itself. */
async function unzip(file: ArrayBuffer): Promise<ArrayBuffer> {
  const [first, second] = new Uint8Array(file, 0, Math.min(2, file.byteLength));
  if (first !== 0x1f || second !== 0x8b) return file;
  return new Response(new Blob([file]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
}
