// SPDX-License-Identifier: Apache-2.0
// Calibration from the page: the run searches its frames for a printed board; here one sees what it
// found, and where views are missing.
import { save_file } from "../../files.js";
import { outcome_words } from "../words.js";
import { calibrated_settings, calibration_words, raw_settings } from "./source.js";

const kCells = 6; // along each side of the image
const kCorner = 3; // px of the screen, radius

export class Calibration {
  #state = null; // as the run reports it
  #before = null; // the source before the run gave images of the sensor
  #begins = false; // once the run has started again

  /** `run` has source(), ask(text, told), and restart(settings, told). */
  constructor(root, run) {
    this.root = root;
    this.run = run;
    const part = (name) => root.querySelector(name);
    this.canvas = part("canvas");
    this.words = part("output");
    this.squares = part("[name=squares]");
    this.pattern = part("[name=pattern]");
    this.lens = part("[name=lens]");
    this.buttons = Object.fromEntries(
      ["begin", "end", "stop", "use", "save"].map((name) => [name, part(`[data-does=${name}]`)]),
    );
    for (const [name, button] of Object.entries(this.buttons)) {
      button.addEventListener("click", () => this.#act(name));
    }
    this.#write();
  }

  get is_collecting() {
    return this.#state?.state === "collecting";
  }

  #act(name) {
    const told = (answer) => this.#told(answer);
    switch (name) {
      case "begin":
        return this.#begin();
      case "end":
        return this.run.ask(`calibrate end ${this.lens.value}`, told);
      case "stop":
        return this.run.ask("calibrate stop", told);
      case "use":
        return this.run.restart(calibrated_settings(this.#state.path, this.#before), told);
      default:
        return save_file(new Blob([this.#state.camera_file]), "camera.yaml");
    }
  }

  #begin() {
    const source = this.run.source();
    const raw = raw_settings(source);
    if (!raw) return this.#ask_to_begin();
    this.#before = source;
    this.#begins = true;
    this.words.value = "The run starts again with the images of the sensor.";
    this.run.restart(raw, (answer) => {
      this.#begins &&= answer.outcome === "sent" || answer.outcome === "granted";
      this.#told(answer);
    });
  }

  #ask_to_begin() {
    const board = { squares: this.squares.value, pattern: this.pattern.value };
    this.run.ask(`calibrate begin ${JSON.stringify(board)}`, (answer) => this.#told(answer));
  }

  #told(answer) {
    if (["refused", "unsent"].includes(answer.outcome)) this.words.value = outcome_words(answer);
  }

  /** Another run, or this one after a break. */
  begin_run() {
    this.#state = null;
    this.#write();
  }

  /** The source of the run is known now. */
  source_told() {
    if (!this.#begins || raw_settings(this.run.source())) return;
    this.#begins = false;
    this.#ask_to_begin();
  }

  /** The run reports the state. */
  told(state) {
    this.#state = state;
    this.#write();
  }

  stop() {
    this.#begins = false;
    if (this.is_collecting) this.run.ask("calibrate stop", () => {});
  }

  #write() {
    const { begin, end, stop, use, save } = this.buttons;
    const state = this.#state?.state ?? "off";
    const goes_on = state === "collecting" || state === "solving";
    begin.hidden = goes_on;
    end.hidden = stop.hidden = !goes_on;
    end.disabled = state !== "collecting" || this.#state.views === 0;
    use.hidden = !this.#state?.path;
    save.hidden = !this.#state?.camera_file;
    this.canvas.hidden = !goes_on;
    this.root.parentElement.classList.toggle("calibrates", goes_on);
    if (state !== "off" || !this.#begins) this.words.value = calibration_words(this.#state);
  }

  /** Draws a frame {picture} with what was found; sizes are those of the camera {width_px}. */
  draw({ picture }, camera) {
    if (!this.is_collecting || !picture) return;
    const { canvas } = this;
    const { width, height } = picture;
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const pen = canvas.getContext("2d");
    pen.drawImage(picture, 0, 0);
    this.#draw_cells(pen, width, height);
    const scale = width / (camera?.width_px ?? width);
    const places = this.#state.corners_px ?? [];
    const shown = width / Math.max(1, canvas.clientWidth);
    pen.fillStyle = "#40de61";
    pen.strokeStyle = "#000";
    pen.lineWidth = shown;
    for (let i = 0; i < places.length; i += 2) {
      pen.beginPath();
      const [x, y] = [scale * (places[i] + 0.5), scale * (places[i + 1] + 0.5)];
      pen.arc(x, y, kCorner * shown, 0, 2 * Math.PI);
      pen.fill();
      pen.stroke();
    }
  }

  /** Parts of the image without a corner stay dark. */
  #draw_cells(pen, width, height) {
    pen.fillStyle = "rgb(0 0 0 / 45%)";
    this.#state.cells.forEach((count, cell) => {
      if (count > 0) return;
      const [column, row] = [cell % kCells, Math.floor(cell / kCells)];
      pen.fillRect((column * width) / kCells, (row * height) / kCells, width / kCells, height / kCells);
    });
  }
}
