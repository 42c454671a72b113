// A dressed character, with Next. React's StrictMode mounts a page twice, so what is begun is ended by a signal.
'use client';

import { useEffect, useRef } from 'react';
import {
  AnimationMixer,
  Color,
  DoubleSide,
  HemisphereLight,
  MeshStandardMaterial,
  PerspectiveCamera,
  Scene,
  WebGLRenderer,
} from 'three';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { loadModel } from 'ctsn';
import { Cloth } from 'ctsn/three';

export default function Page() {
  const container = useRef(null);
  useEffect(() => {
    const end = new AbortController();
    show(container.current, end.signal).catch(console.error);
    return () => end.abort();
  }, []);
  return <main ref={container} />;
}

async function show(container, end) {
  const [{ scene: character, animations }, model] = await Promise.all([
    new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).loadAsync('character.glb'),
    loadModel('model.safetensors'),
  ]);
  if (end.aborted) return model.dispose();
  const renderer = new WebGLRenderer({ antialias: true });
  renderer.setSize(innerWidth, innerHeight);
  container.append(renderer.domElement);

  const scene = new Scene();
  scene.background = new Color('white');
  const camera = new PerspectiveCamera(35, innerWidth / innerHeight, 0.1, 20);
  camera.position.set(0, 1, 4);
  const cloth = new Cloth(model, character, new MeshStandardMaterial({ color: 'steelblue', side: DoubleSide }));
  scene.add(new HemisphereLight('white', 'grey', 3), character, cloth);

  const mixer = new AnimationMixer(character);
  mixer.clipAction(animations[0]).play();
  renderer.setAnimationLoop((milliseconds) => {
    mixer.setTime(milliseconds / 1000);
    cloth.update();
    renderer.render(scene, camera);
  });
  end.addEventListener('abort', () => {
    renderer.dispose();
    renderer.domElement.remove();
    cloth.dispose();
    model.dispose();
  });
}
