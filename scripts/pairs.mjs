// The project's pairs of character and garment, FIGURE-KIND: what `npm run data` simulates and `npm run models` trains.
//   vertices   of the garment
//   mixed      poses of limbs mixed from others, where the pair's dataset is made at full size
//   minutes    of the training of its model, simulations and all, on two cores
export const PAIRS = {
  'andy-tshirt': { vertices: 2100, minutes: 60, mixed: 0 },
  'andy-dress': { vertices: 3000, minutes: 60 },
  'anna-tshirt': { vertices: 2100, minutes: 60 },
  'anna-dress': { vertices: 3000, minutes: 60 },
  'qman-robe': { vertices: 3000, minutes: 60, mixed: 2300 },
  'qman-tshirt': { vertices: 2100, minutes: 60 },
  'monster-robe': { vertices: 3000, minutes: 60 },
  'dolphin-vest': { vertices: 2500, minutes: 40 },
  'cat-coat': { vertices: 3000, minutes: 60 },
  'fox-cape': { vertices: 3000, minutes: 60, mixed: 1600 },
  'sphere-sheet': { vertices: 1200, minutes: 30 },
  'box-sheet': { vertices: 1200, minutes: 30 },
};
