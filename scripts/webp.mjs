// Stills of webp in the container of RFC 9649: without a colour profile, and many as a moving picture.

/** Number as so many bytes, least first. */
const bytes = (number, count) => Buffer.from(Array.from({ length: count }, (_, i) => Math.floor(number / 256 ** i) % 256));
/** A chunk of a RIFF file; those of odd length are padded. */
const chunk = (name, ...parts) => {
  const data = Buffer.concat(parts);
  return Buffer.concat([Buffer.from(name), bytes(data.length, 4), data, Buffer.alloc(data.length % 2)]);
};

/** The image data of a still webp: its chunks without those of its container. */
function imageOf(still) {
  const found = [];
  for (let at = 12; at < still.length; ) {
    const end = at + 8 + still.readUInt32LE(at + 4);
    if (['VP8 ', 'VP8L', 'ALPH'].includes(still.toString('latin1', at, at + 4))) found.push(still.subarray(at, end + (end % 2)));
    at = end + (end % 2);
  }
  return Buffer.concat(found);
}

/** A still with transparency, without its colour profile: without one sRGB is meant, which it is. */
export function plain(still, [width, height]) {
  const header = chunk('VP8X', bytes(0x10, 4), bytes(width - 1, 3), bytes(height - 1, 3));
  return chunk('RIFF', Buffer.from('WEBP'), header, imageOf(still));
}

/** One moving webp of stills of one size, shown for so many milliseconds each, again and again. */
export function moving(stills, [width, height], milliseconds) {
  const size = [bytes(width - 1, 3), bytes(height - 1, 3)];
  const frames = stills.map((still) => chunk('ANMF', bytes(0, 6), ...size, bytes(milliseconds, 3), bytes(2, 1), imageOf(still)));
  const header = [chunk('VP8X', bytes(2, 4), ...size), chunk('ANIM', bytes(0xffffffff, 4), bytes(0, 2))];
  return chunk('RIFF', Buffer.from('WEBP'), ...header, ...frames);
}
