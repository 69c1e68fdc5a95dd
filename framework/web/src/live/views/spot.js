// SPDX-License-Identifier: Apache-2.0
// A place on a canvas that follows the mouse, and the arrow keys while the canvas has the focus.

const kStep = 12; // px of the page for a key; with shift 1

export class Spot {
  #at = null;

  /** `told` has moved(); chosen(reach): a click, or Enter, which reaches everything; left(). */
  constructor(canvas, told) {
    this.canvas = canvas;
    this.told = told;
    canvas.addEventListener("pointermove", ({ offsetX, offsetY }) => this.#go([offsetX, offsetY]));
    canvas.addEventListener("pointerleave", () => this.#go(null));
    canvas.addEventListener("blur", () => this.#go(null));
    canvas.addEventListener("click", ({ offsetX, offsetY }) => {
      this.#go([offsetX, offsetY]);
      told.chosen();
    });
    canvas.addEventListener("keydown", (event) => this.#press(event));
  }

  /** [x, y] px of the page from the canvas's corner; null without a pointer on it. */
  get at() {
    return this.#at;
  }

  #go(at) {
    this.#at = at;
    this.told.moved();
  }

  #press(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "Escape") return this.told.left();
    const { clientWidth, clientHeight } = this.canvas;
    const [x, y] = this.#at ?? [clientWidth / 2, clientHeight / 2];
    const step = event.shiftKey ? 1 : kStep;
    const next = {
      ArrowLeft: [x - step, y],
      ArrowRight: [x + step, y],
      ArrowUp: [x, y - step],
      ArrowDown: [x, y + step],
      Enter: [x, y],
    }[event.key];
    if (!next) return;
    event.preventDefault();
    const inside = (value, end) => Math.min(end, Math.max(0, value));
    this.#go([inside(next[0], clientWidth), inside(next[1], clientHeight)]);
    if (event.key === "Enter") this.told.chosen(Infinity);
  }
}
