// SPDX-License-Identifier: Apache-2.0
// The bar between two views, moved by mouse, finger or arrow keys.
import { recall, remember } from "./memory.js";

const kLeast = 15; // % of the room for the first view
const kMost = 85;
const kHalf = 50;
const kStep = 2;
const kTallest = 0.9; // of width to height, below which one view is above the other

export class Split {
  #share;

  /** `room` contains the first view, the bar, and the second view. */
  constructor(room, bar) {
    this.room = room;
    this.bar = bar;
    this.#set(recall("split", kHalf));
    bar.setAttribute("aria-valuemin", kLeast);
    bar.setAttribute("aria-valuemax", kMost);
    bar.addEventListener("pointerdown", (event) => this.#grab(event));
    bar.addEventListener("keydown", (event) => this.#press(event));
    bar.addEventListener("dblclick", () => this.#choose(kHalf));
    new ResizeObserver(() => this.#turn()).observe(room);
  }

  get #is_stacked() {
    return this.room.classList.contains("stacked");
  }

  #turn() {
    const { clientWidth, clientHeight } = this.room;
    this.room.classList.toggle("stacked", clientWidth < kTallest * clientHeight);
    this.bar.setAttribute("aria-orientation", this.#is_stacked ? "horizontal" : "vertical");
  }

  #set(share) {
    this.#share = Math.min(kMost, Math.max(kLeast, share));
    this.room.style.setProperty("--first", `${this.#share}fr`);
    this.room.style.setProperty("--second", `${100 - this.#share}fr`);
    this.bar.setAttribute("aria-valuenow", Math.round(this.#share));
  }

  #choose(share) {
    this.#set(share);
    remember("split", this.#share);
  }

  #grab(event) {
    this.bar.setPointerCapture(event.pointerId);
    const move = ({ clientX, clientY }) => {
      const { left, top, width, height } = this.room.getBoundingClientRect();
      const share = this.#is_stacked ? (clientY - top) / height : (clientX - left) / width;
      this.#choose(100 * share);
    };
    this.bar.addEventListener("pointermove", move);
    const release = () => this.bar.removeEventListener("pointermove", move);
    this.bar.addEventListener("lostpointercapture", release, { once: true });
  }

  #press(event) {
    const share = {
      ArrowLeft: this.#share - kStep,
      ArrowUp: this.#share - kStep,
      ArrowRight: this.#share + kStep,
      ArrowDown: this.#share + kStep,
      Home: kLeast,
      End: kMost,
      Enter: kHalf,
    }[event.key];
    if (share === undefined) return;
    event.preventDefault();
    this.#choose(share);
  }
}
