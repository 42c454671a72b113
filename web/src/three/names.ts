/** Prefixes that families of rigs put before the name of every joint. */
const prefix = /^(?:.*[:|]|mixamorig\d*|J_Bip|Bip\d+|DEF|b)(?=[\s_.:-]|[A-Z])/;

/** Other words for the same joint, by the family that has them. */
const synonyms: Readonly<Record<string, string>> = {
  pelvis: 'hips', // Unreal, 3ds Max
  hip: 'hips',
  chest: 'spine1', // VRM
  upperchest: 'spine2',
  clavicle: 'shoulder',
  collar: 'shoulder',
  arm: 'upperarm', // Mixamo, Ready Player Me
  lowerarm: 'forearm',
  upleg: 'thigh',
  upperleg: 'thigh',
  leg: 'calf',
  lowerleg: 'calf',
  shin: 'calf',
  toe: 'toes',
  toebase: 'toes',
  ball: 'toes',
};

/** Of fingers: VRM names their bones from the palm on, others number them. */
const segments = { proximal: 1, intermediate: 2, distal: 3 };

/**
 * What the name of a joint says, in whatever family of rigs it was given: `mixamorig:LeftUpLeg`, `J_Bip_L_UpperLeg`,
 * `thigh_l`, `Bip01 L Thigh` and `leftUpperLeg` all read `left thigh`.
 */
export function readName(name: string): string {
  const spaced = name.replace(prefix, '').replace(/([a-z])([A-Z\d])|(\d)([A-Za-z])/g, '$1$3 $2$4');
  const tokens = spaced.toLowerCase().split(/[^a-z\d]+/);
  let side = '';
  let word = '';
  let number = 0;
  for (const token of tokens) {
    if (/^(l|left|r|right)$/.test(token)) side = token.startsWith('l') ? 'left ' : 'right ';
    else if (/^\d+$/.test(token)) number = Number(token) - Number(/^(spine|neck)$/.test(word) && token.length > 1);
    else if (token in segments) number = segments[token as keyof typeof segments];
    else if (token !== 'c') word += token;
  }
  const finger = /^(?:hand)?(thumb|index|middle|ring|pinky|little)(?:finger)?$/.exec(word)?.[1];
  const joint = finger?.replace('little', 'pinky') ?? synonyms[word] ?? word;
  return `${side}${joint}${number || ''}`;
}
