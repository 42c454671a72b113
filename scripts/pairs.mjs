// The project's pairs of character and garment, FIGURE-KIND: what `npm run data` simulates and `npm run models` trains.
//   vertices   of the garment
//   mixed      poses of limbs mixed from others, where the pair's dataset is made at full size
//   minutes    of the training of its model, simulations and all, on two cores
//   steps      of the polish, where others than 16: as many as keep edges within 1.5 times the simulation's strain
//   shown      a clip that its model never learns from, whose simulation the page shows beside the prediction
export const PAIRS = {
  'andy-tshirt': { vertices: 3000, minutes: 60, mixed: 0, steps: 24, shown: 'throw' },
  'andy-dress': { vertices: 6000, minutes: 60, steps: 32, shown: 'throw' },
  'andy-trousers': { vertices: 2100, minutes: 60, steps: 24, shown: 'throw' },
  'anna-tshirt': { vertices: 2100, minutes: 60, shown: 'throw' },
  'anna-skirt': { vertices: 2100, minutes: 60, shown: 'throw' },
  'anna-dress': { vertices: 3000, minutes: 60, steps: 24, shown: 'throw' },
  'qman-robe': { vertices: 6020, minutes: 150, mixed: 2300, steps: 32, shown: 'throw' },
  'qman-tshirt': { vertices: 2100, minutes: 60, steps: 24, shown: 'throw' },
  'monster-robe': { vertices: 3000, minutes: 85, steps: 24, shown: 'throw' },
  'dolphin-vest': { vertices: 2500, minutes: 40, shown: 'curl' },
  'cat-coat': { vertices: 3000, minutes: 60, shown: 'swat' },
  'fox-cape': { vertices: 4010, minutes: 75, mixed: 1600, shown: 'swat' },
  'sphere-sheet': { vertices: 1200, minutes: 30, shown: 'swing' },
  'box-sheet': { vertices: 1200, minutes: 30, shown: 'swing' },
};
