// SPDX-License-Identifier: Apache-2.0
// Strips over the last half minute: times, rate, matches, and confidence above the states.
import { element } from "../data.js";
import { round_number } from "../errors.js";
import { kColours } from "../selection.js";
import { kStates } from "../states.js";
import { palette, pen_of } from "./canvas.js";
import { kSpan_s } from "./history.js";
import { percent } from "./words.js";

const kTop = 15; // px above the plot, for its scale
const kGap_s = 2; // between frames, from which a line breaks
const kStateHeight = 5;
const kPoint = 2; // radius of a sample on its own
const kLeastBar = 3; // of a sample on its own
const kRest = kColours - 1; // slot of all stages that have no colour of their own

/** A colour for each stage, which it keeps for as long as it has one. */
class StageColours {
  #slots = new Map();

  update(samples) {
    const totals = new Map();
    for (const { stages } of samples) {
      for (const { stage, ms } of stages) totals.set(stage, (totals.get(stage) ?? 0) + ms);
    }
    const ranked = [...totals.keys()].sort((a, b) => totals.get(b) - totals.get(a));
    const room = ranked.length <= kColours ? kColours : kRest;
    const named = new Set(ranked.slice(0, room));
    for (const [stage, slot] of this.#slots) {
      if (!named.has(stage) || slot >= room) this.#slots.delete(stage);
    }
    for (const stage of totals.keys()) {
      if (named.has(stage) && !this.#slots.has(stage)) this.#slots.set(stage, this.#free());
    }
  }

  #free() {
    const taken = new Set(this.#slots.values());
    return Array.from({ length: kColours }, (_, slot) => slot).find((slot) => !taken.has(slot));
  }

  slot(stage) {
    return this.#slots.get(stage) ?? kRest;
  }

  has(stage) {
    return this.#slots.has(stage);
  }
}

const most = (samples, value) =>
  samples.reduce((high, sample) => (value(sample) > high ? value(sample) : high), 0);
const digits = (value) => (value >= 99.5 ? value.toFixed(0) : value.toPrecision(2));

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

/** A canvas with its scale from 0 to `top`, and where values lie on it. */
class Plot {
  constructor(canvas, newest_s, top, label) {
    this.colour = palette();
    this.pen = pen_of(canvas);
    this.width = canvas.clientWidth;
    this.height = canvas.clientHeight;
    this.newest_s = newest_s;
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
    this.pen.fillText(label, 0, kTop - 4);
  }

  x(at_s) {
    return this.width * (1 - (this.newest_s - at_s) / kSpan_s);
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
      // The newest one stands at the edge, and is to be seen whole.
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
}

export class Strips {
  #colours = new StageColours();
  #strips = new Map();

  constructor(root, history) {
    this.history = history;
    for (const figure of root.querySelectorAll("[data-strip]")) {
      const [canvas, value, stages] = ["canvas", "output", ".stages"].map((part) =>
        figure.querySelector(part),
      );
      this.#strips.set(figure.dataset.strip, { canvas, value, stages });
      new ResizeObserver(() => this.draw()).observe(canvas);
    }
  }

  draw() {
    const { samples, latest } = this.history;
    if (!latest) return;
    this.#draw_stages(samples, latest);
    this.#draw_rate(samples, latest);
    this.#draw_kept(samples, latest);
    this.#draw_confidence(samples, latest);
  }

  #plot(name, latest, top, label, words) {
    const { canvas, value } = this.#strips.get(name);
    value.textContent = words;
    canvas.setAttribute("aria-label", `Over the last ${kSpan_s} seconds; now ${words}`);
    return new Plot(canvas, latest.at_s, top, label);
  }

  #draw_stages(samples, latest) {
    const top = round_number(most(samples, ({ total_ms }) => total_ms));
    const words = Number.isFinite(latest.total_ms) ? `${digits(latest.total_ms)} ms` : "–";
    const plot = this.#plot("stages", latest, top, `${top} ms`, words);
    this.#colours.update(samples);
    const slots = Array.from({ length: kColours }, (_, slot) => slot);
    const colours = slots.map((slot) => plot.colour(`--series-${slot + 1}`));
    plot.bars(samples, ({ stages }, left, width) => {
      let below_ms = 0;
      for (const { stage, ms } of stages) {
        const foot = plot.y(below_ms);
        below_ms += ms;
        plot.pen.fillStyle = colours[this.#colours.slot(stage)];
        plot.pen.fillRect(left, plot.y(below_ms), width, foot - plot.y(below_ms));
      }
    });
    this.#write_stages(latest.stages);
  }

  #write_stages(stages) {
    const rows = stages.filter(({ stage }) => this.#colours.has(stage));
    const rest = stages.filter(({ stage }) => !this.#colours.has(stage));
    if (rest.length) {
      rows.push({ stage: "the rest", ms: rest.reduce((sum, { ms }) => sum + ms, 0) });
    }
    const items = rows.map(({ stage, ms }) => {
      const sample = element("span", { className: "key" });
      sample.style.background = `var(--series-${this.#colours.slot(stage) + 1})`;
      const time = element("span", { className: "number", textContent: `${digits(ms)} ms` });
      return element("li", {}, sample, `${stage} `, time);
    });
    this.#strips.get("stages").stages.replaceChildren(...items);
  }

  #draw_rate(samples, latest) {
    const top = round_number(most(samples, ({ rate }) => rate));
    const words = Number.isFinite(latest.rate) ? digits(latest.rate) : "–";
    this.#plot("rate", latest, top, `${top} a second`, words).line(
      samples,
      ({ rate }) => rate,
      "--series-1",
    );
  }

  #draw_kept(samples, latest) {
    const top = round_number(
      Math.max(...["kept", "matches"].map((name) => most(samples, (sample) => sample[name]))),
    );
    const words = Number.isFinite(latest.kept) ? `${latest.kept} of ${latest.matches}` : "–";
    const plot = this.#plot("kept", latest, top, String(top), words);
    plot.line(samples, ({ matches }) => matches, "--rule-strong");
    plot.line(samples, ({ kept }) => kept, "--series-1");
  }

  #draw_confidence(samples, latest) {
    const words = Number.isFinite(latest.confidence) ? percent(latest.confidence) : "–";
    const plot = this.#plot("confidence", latest, 1, "100\u00a0%", words);
    plot.bars(samples, ({ state }, left, width) => {
      const { colour } = kStates.find(({ name }) => name === state) ?? kStates.at(-1);
      plot.pen.fillStyle = plot.colour(colour.slice("var(".length, -1));
      plot.pen.fillRect(left, plot.height - kStateHeight, width, kStateHeight);
    });
    plot.line(samples, ({ confidence }) => confidence, "--series-1");
  }
}
