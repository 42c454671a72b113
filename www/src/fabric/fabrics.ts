/** How a kind of cloth looks. */
export interface Fabric {
  name: string;
  /** Metres that a tile of its weave covers. */
  tile: number;
  /** How much the weave bends the light. */
  relief: number;
  roughness: number;
  /** How strongly its surface mirrors, and the share of the cloth's own colour in that: threads shine, films glare. */
  gloss: number;
  glossTint: number;
  /** How much longer a highlight is across the threads than along them, 0 to 1. */
  grain: number;
  /** Light that fibres throw back at grazing angles, and how soft it is. */
  sheen: number;
  sheenRoughness: number;
  /** Share of the cloth's own colour in the sheen; the rest is white. */
  sheenTint: number;
  /** How much colour varies from place to place. */
  mottle: number;
  /** How thick a hem is, metres. */
  thick: number;
}

export type FabricName = 'jersey' | 'denim' | 'silk' | 'felt' | 'wool';

export const fabrics: Readonly<Record<FabricName, Fabric>> = {
  jersey: { name: 'Jersey', tile: 0.018, relief: 0.55, roughness: 0.88, gloss: 0.7, glossTint: 0.2, grain: 0, sheen: 0.55, sheenRoughness: 0.5, sheenTint: 0.55, mottle: 0.05, thick: 0.0026 },
  denim: { name: 'Denim', tile: 0.02, relief: 0.75, roughness: 0.82, gloss: 0.7, glossTint: 0.2, grain: 0, sheen: 0.25, sheenRoughness: 0.6, sheenTint: 0.4, mottle: 0.12, thick: 0.0036 },
  silk: { name: 'Silk', tile: 0.012, relief: 0.08, roughness: 0.52, gloss: 0.75, glossTint: 0.7, grain: 0.6, sheen: 0.9, sheenRoughness: 0.24, sheenTint: 0.75, mottle: 0.015, thick: 0.0014 },
  felt: { name: 'Felt', tile: 0.13, relief: 0.5, roughness: 1, gloss: 0.5, glossTint: 0.2, grain: 0, sheen: 0.85, sheenRoughness: 0.8, sheenTint: 0.6, mottle: 0.1, thick: 0.005 },
  wool: { name: 'Wool', tile: 0.045, relief: 1.1, roughness: 0.95, gloss: 0.6, glossTint: 0.2, grain: 0, sheen: 0.75, sheenRoughness: 0.65, sheenTint: 0.6, mottle: 0.08, thick: 0.0055 },
};

/** What one garment is made of. */
export interface Look {
  fabric: FabricName;
  /** As `#rrggbb`. */
  colour: string;
  print: import('./print.js').PrintName;
}
