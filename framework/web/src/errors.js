// SPDX-License-Identifier: Apache-2.0
// Errors on a mesh: what a vertex is off by, what colour that is, and a scale for both.
import { Color } from "three";

const kMmPerM = 1000;
const kNeighbours = 4;

// From blue over white-yellow to red, told apart without red and green (ColorBrewer's RdYlBu).
export const kStops = ["#2c7bb6", "#abd9e9", "#ffffbf", "#fdae61", "#d7191c"];
const kRamp = kStops.map((text) => new Color(text));
export const kRampStyle = `linear-gradient(90deg, ${kStops.join(", ")})`;

/** Distances, mm, of true points to their places on the estimate; NaN where they have none. */
export function point_errors({ truth, placed }) {
  return Array.from({ length: placed.length / 3 }, (_, i) =>
    kMmPerM *
    Math.hypot(
      placed[3 * i] - truth[3 * i],
      placed[3 * i + 1] - truth[3 * i + 1],
      placed[3 * i + 2] - truth[3 * i + 2],
    ),
  );
}

/** For each vertex the error, mm, of the true points nearest to it, the nearer the more; null
    without any. */
export function vertex_errors(frame) {
  const errors = point_errors(frame);
  const known = errors.flatMap((error, i) => (Number.isNaN(error) ? [] : [i]));
  if (known.length === 0 || frame.vertices.length === 0) return null;
  const { vertices, placed } = frame;
  return Float32Array.from({ length: vertices.length / 3 }, (_, v) => {
    const nearest = [];
    for (const i of known) {
      const distance =
        (placed[3 * i] - vertices[3 * v]) ** 2 +
        (placed[3 * i + 1] - vertices[3 * v + 1]) ** 2 +
        (placed[3 * i + 2] - vertices[3 * v + 2]) ** 2;
      if (nearest.length === kNeighbours && distance >= nearest.at(-1).distance) continue;
      nearest.push({ distance, error: errors[i] });
      nearest.sort((a, b) => a.distance - b.distance);
      nearest.length = Math.min(nearest.length, kNeighbours);
    }
    let sum = 0,
      weights = 0;
    for (const { distance, error } of nearest) {
      const weight = 1 / (distance + 1e-12);
      sum += weight * error;
      weights += weight;
    }
    return sum / weights;
  });
}

/** 1, 2 or 5 times a power of ten: the smallest that is no smaller, or with `below` the largest that
    is no larger. */
export function round_number(value, below = false) {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  const steps = [1, 2, 5, 10].map((step) => step * power);
  return below
    ? steps.filter((step) => step <= value * 1.0001).at(-1)
    : steps.find((step) => step >= value * 0.9999);
}

/** The error, mm, at the end of the scale of some frames: nearly all points are below. */
export function scale_of(frames) {
  const errors = frames.flatMap(point_errors).filter((error) => !Number.isNaN(error));
  if (errors.length === 0) return null;
  errors.sort((a, b) => a - b);
  return round_number(errors[Math.floor(0.98 * (errors.length - 1))]);
}

/** Colours [V,3] of errors, for a scale from 0 to `scale` mm. */
export function colours_of(errors, scale) {
  const colours = new Float32Array(3 * errors.length);
  const colour = new Color();
  errors.forEach((error, v) => {
    const place = Math.min(1, Math.max(0, error / scale)) * (kRamp.length - 1);
    const below = Math.min(kRamp.length - 2, Math.floor(place));
    colour.lerpColors(kRamp[below], kRamp[below + 1], place - below);
    colours.set([colour.r, colour.g, colour.b], 3 * v);
  });
  return colours;
}
