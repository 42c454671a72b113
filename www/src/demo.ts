import type { BackendChoice, Progress, Quality } from 'ctsn';
import type { Figure, GarmentEntry } from './cast/catalogue.js';
import { combine } from './cast/catalogue.js';
import { isOwn } from './cast/own.js';
import { Rail } from './cast/rail.js';
import { Rivals } from './compare/rivals.js';
import { Simulated } from './compare/simulated.js';
import { Cost } from './cost.js';
import { element } from './dom.js';
import { tell } from './failure.js';
import { FabricPanel } from './fabric/panel.js';
import { Samples } from './fabric/samples.js';
import { Character, RATE } from './figure/character.js';
import { Dressed } from './figure/dressed.js';
import { fetchBytes, fetchModels } from './figure/fetch.js';
import { Maps } from './maps/maps.js';
import { Transport } from './motion/transport.js';
import { Poser } from './pose/poser.js';
import { readPose, writePose } from './pose/record.js';
import { readView, type Scene } from './share/address.js';
import type { Stage } from './stage/stage.js';

/** Predictions over which a change of quality is spread. */
const BLEND = 12;
/** Bones that may touch the floor. */
const LOW = /foot|toe|paw|hand/i;

/** The running page: moves the figure, predicts what it wears and draws both, once per animation frame. */
export class TryOn {
  readonly stage: Stage;
  readonly cost = new Cost();
  readonly transport = new Transport();
  /** Called when what an address would keep has changed. */
  onScene: () => void = () => {};
  quality: Quality = 'full';
  /** Predictions since the page was opened. */
  predictions = 0;
  dressed!: Dressed;
  /** Whether the figure is in a pose of one's own. */
  isPosed = false;
  readonly figures: Figure[];
  readonly #rail = new Rail();
  readonly #fabric = new FabricPanel();
  readonly #samples: Samples;
  readonly #poser: Poser;
  readonly #maps = new Maps();
  readonly #rivals: Rivals;
  readonly #simulated = new Simulated();
  #changed = true;
  /** Whether cloth has come from the GPU since it was last drawn. */
  #arrived = false;
  #turn = 0;

  constructor(stage: Stage, cast: Figure[]) {
    this.stage = stage;
    this.figures = cast;
    this.#samples = new Samples((object) => stage.prepare(object));
    this.#poser = new Poser(stage);
    this.#rivals = new Rivals(stage);
    stage.scene.add(this.#rivals);
    this.#listen();
  }

  /** Shows a figure in these garments; what was shown stays until it is there. Overtaken calls end unseen. */
  async choose(entry: Figure, wear = entry.garments.slice(0, 1), onProgress?: (file: string, progress: Progress) => void): Promise<Dressed> {
    const turn = ++this.#turn;
    // What draws it all is compiled while the files come; behind them, where that takes long and nothing is seen.
    const [first] = wear;
    const isSlow = first && this.predictions === 0 ? this.stage.isSlow(this.#samples.piece(first)) : Promise.resolve(false);
    const prepare = () => Promise.all(wear.map((look) => this.#samples.prepare(look, false)));
    void isSlow.then((slow) => void (slow || prepare()));
    fetchModels(wear);
    const bytes = await fetchBytes(entry, (progress) => onProgress?.('figure', progress));
    const character = await Character.parse(bytes, entry.name);
    const isShown = () => this.dressed === dressed;
    const dressed = new Dressed(entry, character, async (look) => isShown() || !(await isSlow) ? this.#samples.prepare(look, isShown()) : undefined);
    dressed.backend = this.cost.backend;
    if (character.clips[0]) character.show(character.clips[0], 0);
    const worn = dressed.wear(wear, (progress) => onProgress?.('model', progress));
    const slow = await isSlow;
    const [came] = await Promise.allSettled([worn, slow || this.stage.prepare(character.scene)]);
    if (came.status === 'rejected' || turn !== this.#turn) {
      dressed.dispose();
      if (came.status === 'rejected') throw came.reason;
      return this.dressed;
    }
    // It may have been chosen anew while the figure came.
    if (dressed.backend !== this.cost.backend) void dressed.compute(this.cost.backend).catch(tell);
    this.#replace(dressed);
    if (slow) this.stage.sketch(dressed.complete, () => Promise.all([prepare(), this.stage.prepare(character.scene)]));
    return dressed;
  }

  /** Puts these garments on. */
  async wear(entries: readonly GarmentEntry[]): Promise<void> {
    if (!(await this.dressed.wear(entries))) return;
    this.tell();
  }

  /** Runs until the page closes. While nothing moves, nothing is drawn. */
  run(): void {
    let last: number | undefined;
    this.stage.renderer.setAnimationLoop((now: number) => {
      // A page in the background gets no animation frames; when it is back, the motion goes on where it stood.
      const seconds = Math.min((now - (last ?? now)) / 1000, 0.1);
      last = now;
      const playing = this.transport.playing && !this.isPosed;
      if (playing) this.dressed.character.advance(seconds * this.transport.speed);
      const moved = this.stage.turn();
      if (moved) this.onScene();
      if (moved || playing || this.#changed || this.dressed.wardrobe.changing) this.draw();
      else if (this.#arrived) this.#render();
    });
  }

  /** Predicts the cloth for the pose of the figure, and draws both. */
  draw(): void {
    const { dressed } = this;
    const { clip, time, duration } = dressed.character;
    this.#changed = false;
    const moment = this.#simulated.wanted && !this.isPosed ? this.#simulated.hold(dressed) : undefined;
    this.predict();
    this.#rivals.update(dressed, moment);
    this.#maps.update(dressed, this.transport.playing && !this.isPosed, moment);
    this.stage.follow(dressed.hip, dressed.head);
    this.#render();
    this.transport.show(this.isPosed ? '' : clip, time, duration);
    this.cost.show(dressed);
  }

  /** Predicts the cloth for the pose of the figure. */
  predict(): void {
    const { dressed } = this;
    const start = performance.now();
    // At rest the next picture is the last for a while: it shows what was chosen.
    dressed.update(this.quality, this.transport.playing ? BLEND : 0);
    this.predictions++;
    const end = () => this.cost.add(performance.now() - start);
    const late = dressed.models.some(({ backend }) => backend === 'webgpu');
    if (!late) return end();
    void dressed.wardrobe.settled().then(() => {
      end();
      this.#arrived = true;
    });
  }

  /** Stops the page at a frame of a clip. */
  stop(clip: string, frame: number, quality: Quality = this.quality): void {
    this.transport.play(false);
    this.quality = quality;
    this.#show(clip, frame / RATE);
  }

  /** Shows what an address says, as far as it does. */
  apply({ pose, view }: Scene): void {
    if (view) this.stage.look(view);
    if (!pose) return;
    if (!('own' in pose)) return this.stop(pose.clip, pose.frame);
    this.transport.play(false);
    readPose(pose.own, this.dressed.character.bones, this.dressed.hip);
    this.#pose();
  }

  /** What an address keeps of the page: nothing of what was dropped on it. */
  get scene(): Scene {
    const { entry, worn, looks, character, hip } = this.dressed;
    const { view } = this.stage;
    if (isOwn(entry.file)) return { view };
    const wear = worn.flatMap(({ entry }) => (isOwn(entry.file) ? [] : { garment: entry.id, look: looks.get(entry)! }));
    const scene: Scene = { figure: entry.id, view, ...(wear.length > 0 || worn.length === 0 ? { wear } : {}) };
    if (this.isPosed) scene.pose = { own: writePose(character.bones, hip) };
    else if (!this.transport.playing && character.clip) scene.pose = { clip: character.clip, frame: RATE * character.time };
    return scene;
  }

  /** Takes another fabric for a garment. */
  look(garment: GarmentEntry, look: Parameters<Dressed['dress']>[1]): void {
    this.dressed.dress(garment, look);
    this.tell();
  }

  #render(): void {
    this.#arrived = false;
    this.#rivals.render(this.stage, this.dressed);
    this.#poser.update();
  }

  #show(clip: string, seconds: number): void {
    this.isPosed = false;
    this.dressed.character.show(clip, seconds);
    this.#changed = true;
    this.onScene();
  }

  /** The figure is in a pose of one's own from now on. */
  #pose(): void {
    this.isPosed = this.#changed = true;
    this.onScene();
  }

  #replace(dressed: Dressed): void {
    const before = this.dressed as Dressed | undefined;
    this.stage.scene.add(dressed.character.scene, dressed.wardrobe);
    this.dressed = dressed;
    this.isPosed = false;
    before?.dispose();
    const { bones, clips } = dressed.character;
    dressed.character.scene.updateMatrixWorld(true);
    this.stage.welcome(dressed.character.scene, [dressed.hip, ...bones.filter(({ name }) => LOW.test(name))]);
    if (dressed.entry.view) this.stage.look(readView(dressed.entry.view));
    this.#poser.hold(bones, dressed.hip);
    this.transport.offer(clips);
    dressed.onModel = () => this.tell();
    dressed.onFailure = tell;
    this.tell();
  }

  /** Has the controls show what is there and worn. */
  tell(): void {
    const { entry, worn, looks } = this.dressed;
    this.#changed = true;
    this.#rail.show(this.figures, entry, worn.map(({ entry }) => entry));
    this.#fabric.show(worn.map(({ entry }) => ({ entry, look: looks.get(entry)! })));
    this.cost.tell(this.dressed);
    this.#simulated.offer(this.dressed);
    const names = worn.map(({ entry }) => entry.name.toLowerCase()).join(' and ') || 'nothing of ours';
    element('stage').setAttribute('aria-label', `${entry.name}, wearing ${names}. Drag or press arrow keys to turn; scroll, plus or minus to come closer.`);
    this.onScene();
  }

  #listen(): void {
    const attempt = (work: Promise<unknown>) => void work.catch(tell);
    this.#rail.onFigure = (figure) => {
      const chosen = this.choose(figure);
      const turn = this.#turn;
      // Nobody waits any more for one that was overtaken.
      chosen.catch((error: unknown) => turn === this.#turn && tell(error));
    };
    this.#rail.onGarment = (garment) => attempt(this.wear(combine(garment, this.dressed.wanted)));
    // Whether it comes is told when it is worn.
    this.#rail.onNear = ({ id }) => void this.dressed.wardrobe.prefetch(id).catch(() => undefined);
    this.#fabric.onLook = (garment, look) => this.look(garment, look);
    this.#fabric.onPicture = (file) => attempt(this.#print(file));
    this.transport.onScrub = (seconds) => this.#show(this.dressed.character.clip, seconds);
    this.transport.onClip = (clip) => this.#show(clip, 0);
    this.transport.onPlay = () => {
      if (this.transport.playing && this.isPosed) this.#show(this.dressed.character.clip, this.dressed.character.time);
      this.onScene();
    };
    this.#poser.onStart = () => this.transport.play(false);
    this.#poser.onMove = () => this.#pose();
    element<HTMLInputElement>('posing').addEventListener('change', ({ target }) => {
      this.#poser.shown = (target as HTMLInputElement).checked;
      this.#changed = true;
    });
    this.#simulated.onSeek = ({ clip, seconds }) => this.#show(clip, seconds);
    this.#maps.onChange = this.#rivals.onChange = this.#simulated.onChange = () => (this.#changed = true);
    this.#simulated.onWanted = () => attempt(this.#simulated.seek(this.dressed));
    this.cost.onBackend = (choice: BackendChoice) => attempt(this.dressed.compute(choice).then(() => this.tell()));
  }

  async #print(file: File): Promise<void> {
    const garment = this.#fabric.garment;
    const { dressed } = this;
    if (!garment) return;
    const picture = await createImageBitmap(file).catch(() => {
      throw new Error(`${file.name} is no picture that this browser can read`);
    });
    // The figure may have given way to another meanwhile.
    if (dressed !== this.dressed) return;
    dressed.pictures.set(garment, picture);
    this.look(garment, { ...dressed.looks.get(garment)!, print: 'picture' });
  }
}
