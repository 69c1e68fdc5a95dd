// SPDX-License-Identifier: Apache-2.0
// Strips over half a minute: times, delays, rate, matches, and confidence above the states. A click
// goes to its moment.
import { element } from "../../data.js";
import { round_number } from "../../errors.js";
import { kColours } from "../../selection.js";
import { kStates } from "../../states.js";
import { delay_words, percent } from "../words.js";
import { Plot, kSpan_s, time_at } from "./plot.js";
import { StageColours } from "./stage_colours.js";

const kStateHeight = 5;
const kDelays = [
  { name: "run_ms", title: "run", colour: "--series-1" },
  { name: "link_ms", title: "connection", colour: "--series-5" },
  { name: "browser_ms", title: "browser", colour: "--series-4" },
];

const most = (samples, value) =>
  samples.reduce((high, sample) => (value(sample) > high ? value(sample) : high), 0);
const digits = (value) => (value >= 99.5 ? value.toFixed(0) : value.toPrecision(2));
const milliseconds = (value) => (Number.isFinite(value) ? `${digits(value)} ms` : "–");
const sum_of = (samples, value) => samples.reduce((sum, sample) => sum + (value(sample) || 0), 0);

/** A list entry with a key in a colour of the page's style. */
function keyed(colour, words, value) {
  const sample = element("span", { className: "key" });
  sample.style.background = `var(${colour})`;
  const number = element("span", { className: "number", textContent: value });
  return element("li", {}, sample, `${words} `, number);
}

export class Strips {
  #colours = new StageColours();
  #strips = new Map();
  #end_s = 0; // of what is drawn
  #writes = []; // of the page, after all canvases are drawn: between them each costs a layout

  constructor(root, history, playback) {
    this.history = history;
    this.playback = playback;
    for (const figure of root.querySelectorAll("[data-strip]")) {
      const [canvas, value, list] = ["canvas", "output", "ul"].map((part) =>
        figure.querySelector(part),
      );
      this.#strips.set(figure.dataset.strip, { canvas, value, list });
      new ResizeObserver(() => this.draw()).observe(canvas);
      canvas.addEventListener("click", ({ offsetX }) => this.#go_to(offsetX / canvas.clientWidth));
    }
  }

  #go_to(share) {
    const sample = this.history.nearest(time_at(share, this.#end_s));
    if (sample) this.playback.go_to(sample.place);
  }

  draw() {
    const { history, playback } = this;
    const { sample } = playback;
    if (!sample) return;
    this.#move_window(sample);
    const samples = history.between(this.#end_s - kSpan_s, this.#end_s);
    this.#draw_stages(samples, sample);
    this.#draw_delays(samples, sample);
    this.#draw_rate(samples, sample);
    this.#draw_kept(samples, sample);
    this.#draw_confidence(samples, sample);
    for (const write of this.#writes.splice(0)) write();
  }

  /** It ends at the newest frame, or stays where it is until the moment leaves it. */
  #move_window(sample) {
    const { samples, latest } = this.history;
    if (this.playback.is_live) {
      this.#end_s = latest.at_s;
    } else if (sample.at_s > this.#end_s || sample.at_s < this.#end_s - kSpan_s) {
      const end_s = Math.max(samples[0].at_s + kSpan_s, sample.at_s + kSpan_s / 2);
      this.#end_s = Math.min(latest.at_s, end_s);
    }
  }

  /** `draw(plot)` draws between the scale and the marks. */
  #plot(name, samples, sample, { top, label, words }, draw) {
    const { canvas, value } = this.#strips.get(name);
    if (canvas.clientWidth === 0) return;
    this.#writes.push(() => {
      value.textContent = words;
      canvas.setAttribute("aria-label", `Over ${kSpan_s} seconds; now ${words}`);
    });
    const plot = new Plot(canvas, this.#end_s, top, label);
    draw(plot);
    for (const { at_s, mark } of samples) {
      if (mark) plot.upright(at_s, mark.kind === "loss" ? "--bad" : "--link");
    }
    if (!this.playback.is_live) plot.upright(sample.at_s, "--ink", 2);
  }

  #draw_stages(samples, sample) {
    const top = round_number(most(samples, ({ total_ms }) => total_ms));
    this.#colours.update(samples);
    const scale = { top, label: `${top} ms`, words: milliseconds(sample.total_ms) };
    this.#plot("stages", samples, sample, scale, (plot) => {
      const slots = Array.from({ length: kColours }, (_, slot) => slot);
      const colours = slots.map((slot) => plot.colour(`--series-${slot + 1}`));
      plot.stacks(samples, ({ stages }) =>
        stages.map(({ stage, ms }) => [ms, colours[this.#colours.slot(stage)]]),
      );
    });
    this.#write_stages(sample.stages);
  }

  #write_stages(stages) {
    const rows = stages.filter(({ stage }) => this.#colours.has(stage));
    const rest = stages.filter(({ stage }) => !this.#colours.has(stage));
    if (rest.length) rows.push({ stage: "the rest", ms: sum_of(rest, ({ ms }) => ms) });
    const items = rows.map(({ stage, ms }) =>
      keyed(`--series-${this.#colours.slot(stage) + 1}`, stage, milliseconds(ms)),
    );
    const { list } = this.#strips.get("stages");
    this.#writes.push(() => list.replaceChildren(...items));
  }

  #draw_delays(samples, sample) {
    const total = ({ delays }) => sum_of(kDelays, ({ name }) => delays[name]);
    const top = round_number(most(samples, total));
    const scale = { top, label: `${top} ms`, words: milliseconds(total(sample)) };
    this.#plot("delays", samples, sample, scale, (plot) => {
      const colours = kDelays.map(({ name, colour }) => [name, plot.colour(colour)]);
      plot.stacks(samples, ({ delays }) => colours.map(([name, colour]) => [delays[name], colour]));
    });
    const lost = (name) => sum_of(samples, ({ delays }) => delays[name]);
    const items = kDelays.map(({ name, title, colour }) =>
      keyed(colour, title, milliseconds(sample.delays[name])),
    );
    const words = delay_words(sample.delays, lost("lost_run"), lost("lost_link"));
    const { list } = this.#strips.get("delays");
    this.#writes.push(() => list.replaceChildren(...items, element("li", { textContent: words })));
  }

  #draw_rate(samples, sample) {
    const top = round_number(most(samples, ({ rate }) => rate));
    const words = Number.isFinite(sample.rate) ? digits(sample.rate) : "–";
    this.#plot("rate", samples, sample, { top, label: `${top} a second`, words }, (plot) =>
      plot.line(samples, ({ rate }) => rate, "--series-1"),
    );
  }

  #draw_kept(samples, sample) {
    const highest = ["kept", "matches"].map((name) => most(samples, (each) => each[name]));
    const top = round_number(Math.max(...highest));
    const words = Number.isFinite(sample.kept) ? `${sample.kept} of ${sample.matches}` : "–";
    this.#plot("kept", samples, sample, { top, label: String(top), words }, (plot) => {
      plot.line(samples, ({ matches }) => matches, "--rule-strong");
      plot.line(samples, ({ kept }) => kept, "--series-1");
    });
  }

  #draw_confidence(samples, sample) {
    const words = Number.isFinite(sample.confidence) ? percent(sample.confidence) : "–";
    const scale = { top: 1, label: "100\u00a0%", words };
    this.#plot("confidence", samples, sample, scale, (plot) => {
      plot.bars(samples, ({ state }, left, width) => {
        const { colour } = kStates.find(({ name }) => name === state) ?? kStates.at(-1);
        plot.pen.fillStyle = plot.colour(colour.slice("var(".length, -1));
        plot.pen.fillRect(left, plot.height - kStateHeight, width, kStateHeight);
      });
      plot.line(samples, ({ confidence }) => confidence, "--series-1");
    });
  }
}
