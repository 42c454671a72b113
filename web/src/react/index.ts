/** Cloth for React Three Fiber. */
import { useFrame, useThree, type ThreeElements } from '@react-three/fiber';
import { createElement, use, useLayoutEffect, useState, type ReactElement, type ReactNode, type Ref } from 'react';
import { DoubleSide, MeshStandardMaterial, type Material } from 'three';
import { loadModel, type LoadOptions } from '../load.js';
import type { CpuClothModel } from '../model.js';
import type { AnyCloth, AnyClothModel, Character, ClothOptions } from '../three/index.js';
import { Cloth as ThreeCloth } from '../three/cloth.js';

const models = new Map<string, Promise<CpuClothModel>>();

function begin(url: string, options?: LoadOptions): Promise<CpuClothModel> {
  let model = models.get(url);
  if (!model) models.set(url, (model = loadModel(url, options)));
  return model;
}

/**
 * The model of an address, which suspends the component until it is there. It is loaded once for a page, with the
 * options of the first call, and kept until `useClothModel.clear(url)`. A failure goes to the error boundary, and is
 * kept as well.
 */
export function useClothModel(url: string, options?: LoadOptions): CpuClothModel {
  return use(begin(url, options));
}

/** Begins to load a model that will be wanted. */
useClothModel.preload = (url: string, options?: LoadOptions): void => {
  // Who uses it is told of a failure.
  begin(url, options).catch(() => undefined);
};

/** Forgets a model and frees it, after the last component that shows it. */
useClothModel.clear = (url: string): void => {
  models.get(url)?.then((model) => model.dispose()).catch(() => undefined);
  models.delete(url);
};

/**
 * A cloth on a character, brought up to date in every frame; nothing in the first render. It has a plain material until
 * it is given another. What goes wrong, then or later, goes to the error boundary.
 */
export function useCloth(
  model: AnyClothModel,
  character: Character,
  { bones, fit }: Pick<ClothOptions, 'bones' | 'fit'> = {},
): AnyCloth | undefined {
  const renderer = useThree((state) => state.gl);
  const [cloth, setCloth] = useState<AnyCloth>();
  const [, fail] = useState();
  // Made and freed by one effect: StrictMode runs it twice, and a render that is thrown away leaves nothing behind.
  useLayoutEffect(() => {
    const material = new MeshStandardMaterial({ side: DoubleSide });
    const made: AnyCloth = new ThreeCloth<Material | Material[], AnyClothModel>(model, character, material, { renderer, bones, fit });
    setCloth(made);
    return () => {
      made.dispose();
      material.dispose();
    };
    // A map is read once: one written in the component is another in every render.
  }, [model, character, renderer, fit]);
  useFrame(() => {
    try {
      cloth?.update();
    } catch (error) {
      fail(() => {
        throw error;
      });
    }
  });
  return cloth;
}

/** A cloth's own properties, and those of any mesh: `castShadow`, `visible`, `onClick`, … */
export interface ClothProps
  extends Omit<ThreeElements['mesh'], 'ref' | 'args' | 'geometry' | 'children'>,
    Pick<ClothOptions, 'bones' | 'fit'> {
  /** What `useClothModel` gave, or `loadModel`. */
  model: AnyClothModel;
  /** What `useGLTF` or `useLoader` gave as `scene`. */
  character: Character;
  /** How much of the network it takes. */
  quality?: AnyCloth['quality'];
  /** Frames over which a change of `quality` is spread. */
  blend?: number;
  /** Takes the cloth, an object of three.js. */
  ref?: Ref<AnyCloth>;
  /** A material, in place of the plain one. */
  children?: ReactNode;
}

/**
 * `<Cloth model={model} character={scene}><meshStandardMaterial side={DoubleSide} /></Cloth>`. Components that animate
 * the character stand before it, so that it shows their frame.
 */
export function Cloth({ model, character, bones, fit, children, ...props }: ClothProps): ReactElement | null {
  const cloth = useCloth(model, character, { bones, fit });
  // What the effect made, the effect frees.
  return cloth ? createElement('primitive', { ...props, object: cloth, dispose: null }, children) : null;
}
