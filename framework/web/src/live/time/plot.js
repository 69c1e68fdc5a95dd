// SPDX-License-Identifier: Apache-2.0
// A canvas over time with its scale from 0 to `top`, and where values are on it.
import { palette, pen_of } from "../views/canvas.js";

export const kSpan_s = 30; // from its left to its right end
const kTop = 15; // px above the plot, for its scale
const kGap_s = 2; // between frames, from which a line breaks
const kPoint = 2; // radius of a sample on its own
const kLeastBar = 3; // of a sample on its own

/** The samples with a value as lines [[at_s, value], ...], which break at gaps. */
export function runs_of(samples, value) {
  const runs = [];
  let before_s = NaN; // of the sample before, where it has a value
  for (const sample of samples) {
    const at = value(sample);
    if (Number.isFinite(at)) {
      const follows = sample.at_s - before_s <= kGap_s;
      if (!follows) runs.push([]);
      runs.at(-1).push([sample.at_s, at]);
    }
    before_s = Number.isFinite(at) ? sample.at_s : NaN;
  }
  return runs;
}

export class Plot {
  constructor(canvas, end_s, top, label) {
    this.colour = palette();
    this.pen = pen_of(canvas);
    this.width = canvas.clientWidth;
    this.height = canvas.clientHeight;
    this.end_s = end_s;
    this.top = top;
    this.pen.strokeStyle = this.colour("--rule");
    this.pen.lineWidth = 1;
    for (const y of [kTop + 0.5, this.height - 0.5]) {
      this.pen.beginPath();
      this.pen.moveTo(0, y);
      this.pen.lineTo(this.width, y);
      this.pen.stroke();
    }
    this.pen.fillStyle = this.colour("--muted");
    this.pen.font = "11px system-ui, DejaVu Sans, sans-serif";
    this.pen.textAlign = "left";
    this.pen.fillText(label, 0, kTop - 4);
    this.pen.textAlign = "right";
    this.pen.fillText(`${kSpan_s} s`, this.width, kTop - 4);
  }

  x(at_s) {
    return this.width * (1 - (this.end_s - at_s) / kSpan_s);
  }

  y(value) {
    return this.height - 1 - (Math.min(value, this.top) / this.top) * (this.height - 1 - kTop);
  }

  line(samples, value, name) {
    this.pen.strokeStyle = this.colour(name);
    this.pen.lineWidth = 1.6;
    this.pen.lineJoin = "round";
    this.pen.fillStyle = this.colour(name);
    for (const run of runs_of(samples, value)) {
      this.pen.beginPath();
      for (const [at_s, at] of run) this.pen.lineTo(this.x(at_s), this.y(at));
      this.pen.stroke();
      if (run.length > 1) continue;
      const [at_s, at] = run[0];
      this.pen.beginPath();
      // The newest one is at the edge, and is drawn whole.
      this.pen.arc(Math.min(this.x(at_s), this.width - kPoint), this.y(at), kPoint, 0, 2 * Math.PI);
      this.pen.fill();
    }
  }

  /** For each sample a bar of the time since the one before, or a narrow one behind a gap;
      `draw(sample, left, width)`. */
  bars(samples, draw) {
    let before_s = null;
    for (const sample of samples) {
      const follows = before_s !== null && sample.at_s - before_s <= kGap_s;
      const right = Math.round(this.x(sample.at_s));
      const left = follows ? Math.round(this.x(before_s)) : right - kLeastBar;
      before_s = sample.at_s;
      draw(sample, left, Math.max(1, right - left));
    }
  }

  /** Bars of several parts, one above the other: `parts(sample)` are [[value, colour], ...]. Of the
      samples in one column of pixels the first is drawn. */
  stacks(samples, parts) {
    let drawn = NaN;
    this.bars(samples, (sample, left, width) => {
      if (left === drawn) return;
      drawn = left;
      let below = 0;
      for (const [value, colour] of parts(sample)) {
        if (!(value > 0)) continue;
        const foot = this.y(below);
        below += value;
        this.pen.fillStyle = colour;
        this.pen.fillRect(left, this.y(below), width, foot - this.y(below));
      }
    });
  }

  /** A line from top to bottom at a time. */
  upright(at_s, name, width = 1) {
    this.pen.fillStyle = this.colour(name);
    const x = Math.min(this.width - width, Math.max(0, this.x(at_s)));
    this.pen.fillRect(Math.round(x), kTop, width, this.height - kTop);
  }
}

/** The time of a plot that ends at `end_s` at a share of its width. */
export const time_at = (share, end_s) => end_s - (1 - share) * kSpan_s;
