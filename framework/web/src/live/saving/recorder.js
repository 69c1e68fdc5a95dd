// SPDX-License-Identifier: Apache-2.0
// The button that records what this page is shown, and saves it as a file.
import { animation_of } from "../../animation.js";
import { save_file } from "../../files.js";
import { Recording } from "./recording.js";
import { StoredFile } from "./zip.js";
import { recorded_words, size_words } from "../words.js";

export class Recorder {
  #scene = null; // {camera, template, settings} of the run; null without one
  #recording = null;

  /** `root` holds the button, the count of a recording that goes on, and what became of one. */
  constructor(root) {
    this.button = root.querySelector("#record");
    this.count = root.querySelector("#recording-count");
    this.outcome = root.querySelector("#recorded");
    this.button.addEventListener("click", () => (this.#recording ? this.#end() : this.#begin()));
    addEventListener("beforeunload", (event) => {
      if (this.#recording) event.preventDefault();
    });
  }

  /** A run began. */
  begin_run(camera, template) {
    this.#scene = { camera, template, settings: null };
    this.button.disabled = false;
  }

  show_settings(settings) {
    if (this.#scene) this.#scene.settings = settings;
  }

  /** The run went away: what there is of it is saved. */
  leave_run() {
    if (this.#recording) this.#end("The run went away.");
    this.#scene = null;
    this.button.disabled = true;
  }

  /** A frame was shown. */
  take(frame) {
    if (!this.#recording) return;
    this.#recording.push(frame);
    const { frames, bytes } = this.#recording.summary;
    this.count.textContent = `${frames} ${frames === 1 ? "frame" : "frames"}, ${size_words(bytes)}`;
    if (this.#recording.is_full) this.#end("More would not fit.");
  }

  #begin() {
    // Settings that change later stand in the lines of the frames.
    this.#recording = new Recording({ ...this.#scene });
    this.#show("End recording", "0 frames", "Recording what this page shows");
  }

  async #end(why = "") {
    const recording = this.#recording;
    this.#recording = null;
    const { summary } = recording;
    this.#show("Record", "", summary.frames > 0 ? "Saving ..." : "");
    const files = [];
    const words = [recorded_words(summary), why];
    try {
      const { shapes, template } = recording.surface;
      const bytes = await animation_of(shapes, template);
      if (bytes) files.push(new StoredFile("animation.glb").add(bytes));
    } catch (error) {
      words.push(`It has no animation: ${error.message ?? "the texture cannot be read"}.`);
    }
    if (summary.frames > 0) save_file(recording.zip(files), recording.file_name);
    if (this.#recording === null) this.#show("Record", "", words.filter(Boolean).join(" "));
  }

  #show(label, count, outcome) {
    this.button.textContent = label;
    this.button.classList.toggle("recording", this.#recording !== null);
    this.count.textContent = count;
    this.outcome.value = outcome;
  }
}
