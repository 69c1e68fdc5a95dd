// SPDX-License-Identifier: Apache-2.0
// A colour for lines over a texture that is seen on nearly all of it.

const kSide = 24; // pixels of the texture that are compared, in each direction
const kWorst = 0.1; // share of them that may be nearer to the colour
// One for each corner of the colour space in which a texture may be alone.
const kCandidates = ["#f2f9ff", "#10151a", "#19e3ff", "#ff3df2", "#c6ff1a"];

const channels = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));

/** Distance of colours as the eye weighs them ("redmean", Riemersma), 0 to about 765. */
function distance([r1, g1, b1], [r2, g2, b2]) {
  const mean = (r1 + r2) / 2;
  const [r, g, b] = [r1 - r2, g1 - g2, b1 - b2];
  return Math.sqrt((2 + mean / 256) * r * r + 4 * g * g + (2 + (255 - mean) / 256) * b * b);
}

/** The candidate that is farthest from the pixels (RGBA, 0 to 255), but for the nearest ones. */
export function contrasting_colour(pixels) {
  const far_from = (candidate) => {
    const own = channels(candidate);
    const distances = [];
    for (let at = 0; at + 3 < pixels.length; at += 4) {
      distances.push(distance(own, pixels.subarray(at, at + 3)));
    }
    distances.sort((a, b) => a - b);
    return distances[Math.floor(kWorst * distances.length)] ?? 0;
  };
  return kCandidates.reduce((best, each) => (far_from(each) > far_from(best) ? each : best));
}

/** Of a loaded texture a few pixels, RGBA. */
export function pixels_of(texture) {
  const canvas = document.createElement("canvas");
  canvas.width = kSide;
  canvas.height = kSide;
  const pen = canvas.getContext("2d", { willReadFrequently: true });
  pen.drawImage(texture, 0, 0, kSide, kSide);
  return pen.getImageData(0, 0, kSide, kSide).data;
}
