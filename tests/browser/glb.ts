/** A picture of one pixel. */
const PIXEL =
  'data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNkYPhfDwAChwGA60e6kgAAAABJRU5ErkJggg==';

interface Gltf {
  images?: object[];
  textures?: object[];
  materials: object[];
  meshes: { primitives: { attributes: Record<string, number>; indices: number; material?: number }[] }[];
  nodes: object[];
  scenes: { nodes: number[] }[];
}

/** A character's GLB file with a second figure in it: that of its first mesh, without a skeleton and with a texture. */
export function adorn(glb: Buffer): Buffer {
  const end = 20 + glb.readUInt32LE(12);
  const gltf = JSON.parse(glb.toString('utf8', 20, end)) as Gltf;
  const { attributes, indices } = gltf.meshes[0]!.primitives[0]!;
  Object.assign(gltf, { images: [{ uri: PIXEL }], textures: [{ source: 0 }] });
  const material = gltf.materials.push({ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }) - 1;
  const rigid = Object.fromEntries(['POSITION', 'NORMAL'].map((name) => [name, attributes[name]!]));
  const mesh = gltf.meshes.push({ primitives: [{ attributes: rigid, indices, material }] }) - 1;
  gltf.scenes[0]!.nodes.push(gltf.nodes.push({ mesh }) - 1);
  const text = Buffer.from(JSON.stringify(gltf));
  const json = Buffer.alloc(4 * Math.ceil(text.length / 4), ' ');
  text.copy(json);
  const file = Buffer.concat([glb.subarray(0, 20), json, glb.subarray(end)]);
  file.writeUInt32LE(file.length, 8);
  file.writeUInt32LE(json.length, 12);
  return file;
}
