// SPDX-License-Identifier: Apache-2.0
// Commands to the run: pause, step, resume and stop.
import { outcome_words } from "../words.js";

const kMostSteps = 3; // frames that another client may have stepped through

export class Commands {
  #paused = null; // {from: frame, frames: that came nevertheless}; null: not, as far as is known
  #connected = false;
  #lost = false; // the connection was, while the run was paused
  #stops = false; // the run has agreed to
  #changed;

  /** `outcome` shows what became of a command; `changed()` is called when the run pauses or goes on,
      comes or leaves. */
  constructor(outcome, change_requests, changed) {
    this.outcome = outcome;
    this.change_requests = change_requests;
    this.#changed = changed;
    const dialog = document.getElementById("stopping");
    document.getElementById("stop").addEventListener("click", () => {
      dialog.returnValue = "";
      dialog.showModal();
    });
    dialog.addEventListener("close", () => {
      if (dialog.returnValue !== "stop") return;
      dialog.returnValue = ""; // an earlier closing may be reported only now
      this.ask("stop");
    });
    this.connect(false);
  }

  get paused() {
    return this.#paused !== null;
  }

  get connected() {
    return this.#connected;
  }

  /** Whether the run ends by a request of this page. */
  get stops() {
    return this.#stops;
  }

  connect(there) {
    this.#connected = there;
    document.getElementById("stop").disabled = !there;
    if (!there) document.getElementById("stopping").close();
    this.#changed();
  }

  /** Sends "pause", "step", "resume" or "stop". */
  ask(command) {
    this.change_requests.now(command, (told) => {
      if (told.outcome === "granted") this.#granted(command, told.frame);
      else this.#say(`${command}: ${outcome_words(told)}`, told.outcome !== "sent");
    });
  }

  #granted(command, frame) {
    const pauses = command === "pause" || command === "step";
    this.#stops ||= command === "stop";
    const words = {
      pause: `Paused before frame ${frame}`,
      step: "Paused after one frame",
      resume: `Running from frame ${frame} on`,
      stop: "The run stops.",
    };
    this.#set(pauses ? frame : null, words[command]);
  }

  /** The run pauses or goes on, whichever client requested it. A pause ends with the browser that
      requested it, which may be this one before it came back. */
  pause_told({ paused, frame, left }) {
    const was_lost = this.#lost;
    this.#lost = false;
    if (left && was_lost) {
      return this.#set(null, "Going on: the connection was lost during a pause");
    }
    if (paused === this.paused) return;
    const goes_on = left ? "Going on: the browser that paused it left" : "Going on, by another browser";
    this.#set(paused ? frame : null, paused ? "Paused in another browser" : goes_on);
  }

  /** A frame came: where several do although the run pauses, another client has resumed it. */
  frame_came(frame) {
    if (!this.#paused || frame < this.#paused.from || ++this.#paused.frames < kMostSteps) return;
    this.#set(null, "");
  }

  /** The run went away, or another one began. */
  forget() {
    this.#lost ||= this.paused;
    this.#stops = false;
    this.#set(null, "");
  }

  /** Paused from a frame on, or not (null). */
  #set(from, words) {
    this.#paused = from === null ? null : { from, frames: 0 };
    this.#say(words, false);
    this.#changed();
  }

  #say(words, bad) {
    this.outcome.value = words;
    this.outcome.classList.toggle("bad", bad);
  }
}
