// SPDX-License-Identifier: Apache-2.0
// Pause, step, resume and stop.
import { outcome_words } from "./words.js";

const kMostSteps = 3; // frames that somebody else may have stepped through

export class Commands {
  #paused = null; // {from: frame, frames: that came nevertheless}; null: not, as far as is known
  #lost = false; // the connection was, while the run was paused
  #stops = false; // the run has agreed to

  constructor(root, change_requests) {
    this.root = root;
    this.change_requests = change_requests;
    this.outcome = root.querySelector("#outcome");
    this.buttons = root.querySelectorAll("[data-command], #stop");
    this.connect(false);
    for (const button of root.querySelectorAll("[data-command]")) {
      button.addEventListener("click", () => this.#ask(button.dataset.command));
    }
    const dialog = document.getElementById("stopping");
    root.querySelector("#stop").addEventListener("click", () => {
      dialog.returnValue = "";
      dialog.showModal();
    });
    dialog.addEventListener("close", () => {
      if (dialog.returnValue === "stop") this.#ask("stop");
    });
  }

  get paused() {
    return this.#paused !== null;
  }

  /** Whether the run ends by a request of this page. */
  get stops() {
    return this.#stops;
  }

  /** Without a run there is nothing to press. */
  connect(there) {
    for (const button of this.buttons) button.disabled = !there;
    if (!there) document.getElementById("stopping").close();
  }

  #ask(command) {
    this.change_requests.now(command, (told) => {
      if (told.outcome === "granted") this.#granted(command, told.frame);
      else this.#say(`${command}: ${outcome_words(told)}`, told.outcome !== "sent");
    });
  }

  #granted(command, frame) {
    const pauses = command === "pause" || command === "step";
    this.#stops ||= command === "stop";
    this.#paused = pauses ? { from: frame, frames: 0 } : null;
    const words = {
      pause: `Paused before frame ${frame}`,
      step: "Paused after one frame",
      resume: `Running from frame ${frame} on`,
      stop: "The run stops.",
    };
    this.#say(words[command], false);
  }

  /** The run pauses or goes on, whichever client requested it. A pause ends with the browser that
      requested it, which may be this one before it came back. */
  pause_told({ paused, frame, left }) {
    const was_lost = this.#lost;
    this.#lost = false;
    if (left && was_lost) return this.#say("Going on: the connection was lost during a pause", false);
    if (paused === this.paused) return;
    this.#paused = paused ? { from: frame, frames: 0 } : null;
    const goes_on = left ? "Going on: the browser that paused it left" : "Going on, by another browser";
    this.#say(paused ? "Paused in another browser" : goes_on, false);
  }

  /** A frame came: where several do although the run pauses, somebody else has let it go on. */
  frame_came(frame) {
    if (!this.#paused || frame < this.#paused.from || ++this.#paused.frames < kMostSteps) return;
    this.#paused = null;
    this.#say("", false);
  }

  /** The run went away, or another one began. */
  forget() {
    this.#lost ||= this.paused;
    this.#stops = false;
    this.#paused = null;
    this.#say("", false);
  }

  #say(words, bad) {
    this.outcome.value = words;
    this.outcome.classList.toggle("bad", bad);
  }
}
