import type { Quality } from 'ctsn';
import { Cloth } from 'ctsn/three';
import { Group, type Material } from 'three';
import { Choice, element } from '../dom.js';
import type { Dressed } from '../figure/dressed.js';
import { Hem } from '../fabric/hem.js';
import type { Stage } from '../stage/stage.js';
import { SimulatedCloth, type Moment } from './simulated.js';

/** What the cloth is compared with; `none` is no comparison. */
export type Rival = 'none' | 'truth' | Exclude<Quality, 'full'>;

const titles: Readonly<Record<Rival, string>> = {
  none: '',
  truth: 'Simulation',
  coarse: 'Skeleton stream',
  skinned: 'Plain skinning',
};

/** The same garments by other means, seen on the right of a line that can be moved. */
export class Rivals extends Group {
  onChange: () => void = () => {};
  readonly #choice = new Choice<Rival>('rival');
  readonly #line = element<HTMLInputElement>('split');
  readonly #label = element('split-right');
  #cloths: readonly { cloth: Cloth<Material>; of: Cloth<Material>; hem: Hem }[] = [];
  #simulated: { cloth: SimulatedCloth; hem: Hem } | undefined;

  constructor(stage: Stage) {
    super();
    this.#choice.onChange = () => {
      // The line begins in the middle of the figure.
      if (element('compare-line').hidden) this.#line.value = stage.middle.toFixed(2);
      this.#tell();
    };
    this.#line.addEventListener('input', () => this.#tell());
    this.#tell();
  }

  get rival(): Rival {
    return this.#choice.value;
  }

  set rival(rival: Rival) {
    this.#choice.value = rival;
    this.#tell();
  }

  /** Moves the rivals of what is worn to where the bones are; `moment`: what was simulated of it. */
  update({ worn, character }: Dressed, moment: Moment | undefined): void {
    const { rival } = this;
    const wanted = rival === 'none' ? [] : worn;
    if (wanted.length !== this.#cloths.length || wanted.some(({ cloth }, i) => this.#cloths[i]!.of !== cloth)) {
      this.#clear();
      this.#cloths = wanted.map(({ cloth: of, material }) => {
        const cloth = new Cloth<Material>(of.model, character.scene, material);
        cloth.castShadow = cloth.receiveShadow = true;
        cloth.onBeforeRender = of.onBeforeRender;
        cloth.onAfterRender = of.onAfterRender;
        const uv1 = of.geometry.getAttribute('uv1');
        if (uv1) cloth.geometry.setAttribute('uv1', uv1);
        this.add(cloth);
        return { cloth, of, hem: new Hem(cloth) };
      });
    }
    this.#cloths.forEach(({ cloth, of, hem }, i) => {
      // What nobody simulated is as the network has it.
      cloth.quality = rival === 'truth' ? 'full' : (rival as Quality);
      cloth.blend = 0;
      hem.thick = worn[i]!.hem.thick;
      cloth.update();
      hem.update();
      cloth.visible = rival !== 'truth' || moment?.worn.cloth !== of;
    });
    this.#simulate(rival === 'truth' ? moment : undefined);
    this.#label.textContent = rival === 'truth' && !moment ? 'No simulation of this motion' : titles[rival];
  }

  /** Shows what was simulated, if anything was. */
  #simulate(moment: Moment | undefined): void {
    if (this.#simulated && !(moment && this.#simulated.cloth.isOf(moment))) {
      this.#simulated.hem.free();
      this.#simulated.cloth.dispose();
      this.#simulated = undefined;
    }
    if (!moment) return;
    const cloth = this.#simulated?.cloth ?? new SimulatedCloth(moment);
    cloth.material = moment.worn.material;
    cloth.show(moment);
    this.#simulated ??= { cloth, hem: new Hem(cloth) };
    const { hem } = this.#simulated;
    hem.thick = moment.worn.hem.thick;
    hem.update();
    this.add(cloth);
  }

  /** Draws the network's cloth on the left of the line, the rival's on the right. */
  render(stage: Stage, { wardrobe }: Dressed): void {
    const { renderer } = stage;
    if (this.#cloths.length === 0) return stage.render();
    const { clientWidth: width, clientHeight: height } = renderer.domElement;
    const line = Math.round(Number(this.#line.value) * width);
    renderer.setScissorTest(true);
    for (const [mine, left, wide] of [[true, 0, line], [false, line, width - line]] as const) {
      wardrobe.visible = mine;
      this.visible = !mine;
      renderer.setScissor(left, 0, wide, height);
      if (wide > 0) stage.render();
    }
    renderer.setScissorTest(false);
    wardrobe.visible = true;
  }

  #tell(): void {
    const { rival } = this;
    element('compare-line').hidden = rival === 'none';
    element('compare-line').style.setProperty('--split', String(100 * Number(this.#line.value)));
    this.onChange();
  }

  #clear(): void {
    for (const { cloth, hem } of this.#cloths) {
      hem.free();
      cloth.removeFromParent();
      cloth.dispose();
    }
    this.#cloths = [];
  }
}
