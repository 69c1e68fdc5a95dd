// SPDX-License-Identifier: Apache-2.0
// Play, pause and steps, and the slider over the frames that this page has kept.
import { palette, pen_of } from "../views/canvas.js";
import { moment_words, kept_words } from "../words.js";

const kMarkWidth = 2; // px

export class Transport {
  constructor(root, { history, playback, commands }) {
    this.root = root;
    this.history = history;
    this.playback = playback;
    this.commands = commands;
    const part = (name) => root.querySelector(name);
    this.play = part("#play");
    this.slider = part("#moment");
    this.marks = part("#marks");
    this.words = part("#moment-words");
    this.kept = part("#kept");
    this.play.addEventListener("click", () => this.toggle());
    part("#back").addEventListener("click", () => this.step(-1));
    part("#forward").addEventListener("click", () => this.step(1));
    part("#mark-before").addEventListener("click", () => playback.go_to_mark(-1));
    part("#mark-after").addEventListener("click", () => playback.go_to_mark(1));
    part("#newest").addEventListener("click", () => playback.go_live());
    this.slider.addEventListener("input", () => playback.go_to(Number(this.slider.value)));
    new ResizeObserver(() => this.draw()).observe(this.marks);
  }

  /** Pauses the run; or plays on from its newest frame, whatever moment is shown. */
  toggle() {
    const { playback, commands } = this;
    if (playback.is_live && !commands.paused) return commands.ask("pause");
    playback.go_live();
    if (commands.paused) commands.ask("resume");
  }

  /** Moves through the frames that were kept; at the newest one the run makes a step. */
  step(frames) {
    if (this.playback.step(frames) || frames < 0 || !this.commands.connected) return;
    this.playback.go_live();
    this.commands.ask("step");
  }

  draw() {
    const { history, playback, commands } = this;
    const { samples, latest } = history;
    if (latest) this.#draw_marks(samples, latest); // before what costs a layout is written
    const plays = playback.is_live && !commands.paused;
    this.play.dataset.plays = plays;
    this.play.querySelector(".words").textContent = plays ? "Pause" : "Play";
    this.play.disabled = playback.is_live && !commands.connected;
    this.root.querySelector("#newest").disabled = playback.is_live;
    this.root.classList.toggle("looks-back", !playback.is_live);
    const { sample } = playback;
    for (const name of ["#back", "#mark-before", "#mark-after", "#moment"]) {
      this.root.querySelector(name).disabled = !sample;
    }
    this.root.querySelector("#forward").disabled = playback.is_live && !commands.connected;
    if (!sample) return;
    this.slider.min = samples[0].place;
    this.slider.max = latest.place;
    this.slider.value = sample.place;
    const words = moment_words(sample, latest, playback.is_live);
    this.slider.setAttribute("aria-valuetext", words);
    this.words.textContent = words;
    this.kept.textContent = kept_words(latest.at_s - samples[0].at_s, history.bytes);
  }

  #draw_marks(samples, latest) {
    const colour = palette();
    const pen = pen_of(this.marks);
    const { clientWidth: width, clientHeight: height } = this.marks;
    const places = Math.max(1, latest.place - samples[0].place);
    for (const { place, mark } of samples) {
      if (!mark) continue;
      pen.fillStyle = colour(mark.kind === "loss" ? "--bad" : "--link");
      const x = ((place - samples[0].place) / places) * (width - kMarkWidth);
      pen.fillRect(x, 0, kMarkWidth, height);
    }
  }
}
