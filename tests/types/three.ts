// The same with three.js.
import { DoubleSide, MeshStandardMaterial, type Object3D, type PerspectiveCamera } from 'three';
import { loadModel } from 'ctsn';
import { Cloth, ClothLoader, ClothScheduler, coveredSkin, Wardrobe } from 'ctsn/three';

export async function dress(character: Object3D): Promise<Cloth> {
  const material = new MeshStandardMaterial({ side: DoubleSide });
  const cloth = new Cloth(await loadModel('model.safetensors'), character, material);
  cloth.quality = 'auto';
  cloth.material.color.set('steelblue');
  cloth.update();
  return cloth;
}

export async function change(character: Object3D): Promise<readonly ('shirt' | 'dress')[]> {
  const materials = { shirt: new MeshStandardMaterial(), dress: new MeshStandardMaterial() };
  const garments = { shirt: 'shirt.safetensors', dress: new URL('https://example.org/dress.safetensors') };
  const wardrobe = new Wardrobe(character, garments, { material: (garment) => materials[garment], covered: coveredSkin });
  await wardrobe.wear('shirt');
  // @ts-expect-error: there is no such garment.
  await wardrobe.wear('shrit').catch(() => undefined);
  await wardrobe.stock('hat', 'hat.safetensors').wear(['shirt', 'hat']);
  return wardrobe.worn;
}

export async function share(cloths: Cloth[], camera: PerspectiveCamera): Promise<number> {
  const scheduler = new ClothScheduler({ budget: 8 });
  scheduler.add(...cloths);
  scheduler.update(camera);
  const model = await new ClothLoader().setPath('models/').loadAsync('model.safetensors');
  return model.vertexCount + scheduler.spent;
}
