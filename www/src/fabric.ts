import { Color, DoubleSide, MeshPhysicalMaterial, Vector3, type BufferGeometry } from 'three';

const pattern = /* glsl */ `
  #ifdef USE_UV
    vec2 thread = vUv * fabricMetres;
    // Both patterns fade out where a pixel covers more than half a period, instead of flickering.
    vec2 size = fwidth(thread);
    float stripeFade = 1.0 - smoothstep(0.15, 0.5, size.x / stripeEvery);
    float across = abs(fract(thread.x / stripeEvery) - 0.5) * stripeEvery;
    float stripe = 1.0 - smoothstep(0.0025, 0.0025 + max(size.x, 0.0004), across);
    diffuseColor.rgb = mix(diffuseColor.rgb, stripeColour, 0.85 * stripe * stripeFade);
    vec2 weave = sin(thread * (6.28318 / 0.0032));
    float weaveFade = 1.0 - smoothstep(0.15, 0.5, max(size.x, size.y) / 0.0032);
    diffuseColor.rgb *= 1.0 + 0.13 * weave.x * weave.y * weaveFade;
  #endif
  if (!gl_FrontFacing) diffuseColor.rgb *= 0.62;
`;

/**
 * Woven cloth with thin stripes along the texture's v, darker inside. Weave and stripes are as wide as on real cloth.
 */
export function createFabric(geometry: BufferGeometry): MeshPhysicalMaterial {
  const material = new MeshPhysicalMaterial({
    color: '#3f6482',
    roughness: 0.86,
    sheen: 0.6,
    sheenRoughness: 0.5,
    sheenColor: new Color('#c4d3e0'),
    side: DoubleSide,
  });
  // three declares vUv only for a material that says it needs it.
  material.defines = { ...material.defines, USE_UV: '' };
  if (!geometry.hasAttribute('uv')) delete material.defines['USE_UV'];
  const uniforms = {
    fabricMetres: { value: metresPerUnit(geometry) },
    stripeEvery: { value: 0.045 },
    stripeColour: { value: new Color('#e9dfcc') },
  };
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    shader.fragmentShader = shader.fragmentShader
      .replace(
        '#include <common>',
        '#include <common>\nuniform float fabricMetres, stripeEvery;\nuniform vec3 stripeColour;',
      )
      .replace('#include <color_fragment>', `#include <color_fragment>\n${pattern}`);
  };
  return material;
}

/** Metres of cloth per unit of texture coordinate: the root of cloth area over texture area. */
function metresPerUnit(geometry: BufferGeometry): number {
  const { position, uv } = geometry.attributes;
  const index = geometry.index;
  if (!position || !uv || !index) return 1;
  let [cloth, texture] = [0, 0];
  for (let i = 0; i < index.count; i += 3) {
    const [a, b, c] = [index.getX(i), index.getX(i + 1), index.getX(i + 2)];
    const [corner, right, left] = [a, b, c].map((at) => new Vector3().fromBufferAttribute(position, at));
    cloth += right!.sub(corner!).cross(left!.sub(corner!)).length();
    const [u, v] = [(at: number) => uv.getX(at) - uv.getX(a), (at: number) => uv.getY(at) - uv.getY(a)];
    texture += Math.abs(u(b) * v(c) - u(c) * v(b));
  }
  return texture > 0 ? Math.sqrt(cloth / texture) : 1;
}
