// A dressed character, with React Three Fiber.
import { StrictMode, Suspense, useEffect, useMemo } from 'react';
import { createRoot } from 'react-dom/client';
import { Canvas, useFrame, useLoader } from '@react-three/fiber';
import { AnimationMixer, DoubleSide } from 'three';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { Cloth, useClothModel } from 'ctsn/react';

function Character({ scene, animations }) {
  const mixer = useMemo(() => new AnimationMixer(scene), [scene]);
  useEffect(() => {
    mixer.clipAction(animations[0]).play();
    return () => mixer.stopAllAction();
  }, [mixer, animations]);
  useFrame((_, seconds) => mixer.update(seconds));
  return <primitive object={scene} />;
}

function Dressed() {
  const { scene, animations } = useLoader(GLTFLoader, 'character.glb', (loader) => loader.setMeshoptDecoder(MeshoptDecoder));
  const model = useClothModel('model.safetensors');
  return (
    <>
      <Character scene={scene} animations={animations} />
      <Cloth model={model} character={scene}>
        <meshStandardMaterial color="steelblue" side={DoubleSide} />
      </Cloth>
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
