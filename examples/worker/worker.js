// The worker: loads the model at the address that comes first, then answers each pose with the cloth.
import { loadModel } from 'ctsn';

const first = (event) => new Promise((resolve) => addEventListener(event, resolve, { once: true }));

async function serve() {
  const { data: address } = await first('message');
  const model = await loadModel(address);
  addEventListener('message', ({ data: pose }) => {
    const { positions, normals } = model.predictCloth(pose);
    // They are views into the module's memory: copies of them travel.
    const cloth = { positions: positions.slice(), normals: normals.slice() };
    postMessage(cloth, [cloth.positions.buffer, cloth.normals.buffer]);
  });
  postMessage({ joints: model.joints, vertexCount: model.vertexCount, triangles: model.triangles });
}

serve();
