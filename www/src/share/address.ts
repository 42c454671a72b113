import { fabrics, type FabricName, type Look } from '../fabric/fabrics.js';
import type { PrintName } from '../fabric/print.js';
import type { View } from '../stage/stage.js';

/** What an address keeps of the page. Whatever it does not say is as the page begins. */
export interface Scene {
  figure?: string;
  /** Garments that are worn, and what they are made of. */
  wear?: readonly { garment: string; look?: Look }[];
  /** A frame of a clip, 30 a second, or a pose of one's own as text. */
  pose?: { clip: string; frame: number } | { own: string };
  view?: View;
}

const prints: readonly PrintName[] = ['none', 'stripes', 'checks', 'dots', 'picture'];

/** What an address asks the page to show. */
export function readAddress({ searchParams }: URL): Scene {
  const scene: Scene = {};
  const [figure, wear, pose, view] = ['figure', 'wear', 'pose', 'view'].map((name) => searchParams.get(name));
  if (figure) scene.figure = figure;
  if (wear !== null && wear !== undefined) scene.wear = wear.split(',').filter(Boolean).map(readGarment);
  if (pose) scene.pose = readPlace(pose);
  if (view) scene.view = readView(view);
  return scene;
}

/** A view from its text, AROUND,UP,FAR and maybe LIFT. */
export function readView(text: string): View {
  const [around, up, far, lift = 0] = text.split(',').map(Number);
  if (![around, up, far, lift].every(Number.isFinite)) throw new Error(`?view=${text}: AROUND,UP,FAR wanted, for example ?view=30,5,2.5`);
  return { around: around!, up: up!, far: far!, lift };
}

/** The query of an address that shows the same. */
export function writeAddress({ figure, wear, pose, view }: Scene): string {
  const query = new URLSearchParams();
  if (figure) query.set('figure', figure);
  if (wear) query.set('wear', wear.map(({ garment, look }) => (look ? [garment, look.fabric, look.colour.slice(1), look.print].join('.') : garment)).join(','));
  if (pose) query.set('pose', 'own' in pose ? `~${pose.own}` : `${pose.clip}:${Math.round(pose.frame)}`);
  if (view) query.set('view', [view.around, view.up, view.far, ...(view.lift === 0 ? [] : [view.lift])].join(','));
  return query.toString().replaceAll('%2C', ',').replaceAll('%3A', ':').replaceAll('%7E', '~');
}

function readGarment(text: string): { garment: string; look?: Look } {
  const [garment, fabric, colour, print] = text.split('.');
  if (fabric === undefined) return { garment: garment! };
  if (Object.hasOwn(fabrics, fabric) && /^[\da-f]{6}$/i.test(colour ?? '') && prints.includes(print as PrintName)) {
    return { garment: garment!, look: { fabric: fabric as FabricName, colour: `#${colour}`, print: print as PrintName } };
  }
  throw new Error(`?wear=${text}: GARMENT.FABRIC.COLOUR.PRINT wanted, for example ?wear=tshirt.denim.33415c.dots`);
}

function readPlace(pose: string): NonNullable<Scene['pose']> {
  if (pose.startsWith('~')) return { own: pose.slice(1) };
  const colon = pose.lastIndexOf(':');
  const frame = Number(pose.slice(colon + 1));
  if (colon > 0 && Number.isFinite(frame)) return { clip: pose.slice(0, colon), frame };
  throw new Error(`?pose=${pose}: CLIP:FRAME wanted, for example ?pose=walk:12`);
}
