/** How a model was trained, as far as its file says. */
export interface Training {
  /** Name of the character's file. */
  readonly character?: string | undefined;
  /** Name of the garment's file. */
  readonly garment?: string | undefined;
  /** Name of the fabric that was simulated. */
  readonly fabric?: string | undefined;
  /** Names of the clips it was made of; with ten or more, the last tenth of them it has not seen. */
  readonly clips?: readonly string[] | undefined;
  /** Poses that were simulated. */
  readonly poses?: number | undefined;
  /** How many of them mixed limbs and trunks of others. */
  readonly mixed?: number | undefined;
  /** Poses beside them whose cloth was simulated coarsely, for the skeleton stream. */
  readonly coarse?: number | undefined;
  /** Mean distance of a vertex from the simulation in poses it was not trained on, metres. */
  readonly distance?: number | undefined;
  /** Mean angle of a normal there, degrees. */
  readonly angle?: number | undefined;
  /** Version of ctsn that trained it. */
  readonly version?: string | undefined;
}

/** What a model is made of, what it costs, and where it comes from. */
export interface ModelInfo {
  /** Cloth vertices that the network predicts, n. */
  readonly vertices: number;
  /** Vertices that are drawn, d: the cloth's, or those of a mesh that rides on it, split at seams. */
  readonly drawnVertices: number;
  /** Joints, J. */
  readonly joints: number;
  /** Basis matrices of the skeleton stream, m. */
  readonly skeletonMatrices: number;
  /** Basis matrices of the mesh stream, k; 0 where it adds nothing. */
  readonly meshMatrices: number;
  /** Graph layers of the mesh stream. */
  readonly layers: number;
  /** Features of a vertex in a layer, F. */
  readonly features: number;
  /** Attention heads, C. */
  readonly heads: number;
  /** Steps of the polish; 0 without one. */
  readonly polish: number;
  /** Vertices of the body that the cloth is kept out of; 0 without one. */
  readonly bodyVertices: number;
  /** Bytes that it takes in the module's memory. On a GPU it takes about as many again there. */
  readonly bytes: number;
  /** Whether the file says what poses were seen in training; without it `confidence` is always 1. */
  readonly knowsPoses: boolean;
  /** How it was trained, as far as the file says. */
  readonly training?: Training | undefined;
}
