// A dressed character, with React Three Fiber.
import { StrictMode, Suspense, useEffect, useMemo } from 'react';
import { createRoot } from 'react-dom/client';
import { Canvas, useFrame, useLoader } from '@react-three/fiber';
import { AnimationMixer, DoubleSide, MeshStandardMaterial } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { Cloth, ClothLoader } from 'ctsn/three';

function Dressed() {
  const { scene: character, animations } = useLoader(GLTFLoader, 'character.glb');
  const model = useLoader(ClothLoader, 'model.safetensors');
  const cloth = useMemo(() => {
    const material = new MeshStandardMaterial({ color: 'steelblue', side: DoubleSide });
    return new Cloth(model, character, material);
  }, [model, character]);
  const mixer = useMemo(() => new AnimationMixer(character), [character]);
  useEffect(() => {
    mixer.clipAction(animations[0]).play();
    return () => mixer.stopAllAction();
  }, [mixer, animations]);
  useEffect(() => () => cloth.dispose(), [cloth]);
  useFrame((_, seconds) => {
    mixer.update(seconds);
    cloth.update();
  });
  return (
    <>
      <primitive object={character} />
      <primitive object={cloth} />
    </>
  );
}

createRoot(document.getElementById('root')).render(
  <StrictMode>
    <Canvas camera={{ position: [0, 1, 4], fov: 35 }} onCreated={({ camera }) => camera.lookAt(0, 1, 0)}>
      <color attach="background" args={['white']} />
      <hemisphereLight args={['white', 'grey', 3]} />
      <Suspense>
        <Dressed />
      </Suspense>
    </Canvas>
  </StrictMode>,
);
