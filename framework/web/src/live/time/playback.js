// SPDX-License-Identifier: Apache-2.0
// The moment that the page shows: the newest frame, or an earlier one of the history.

export class Playback {
  #history;
  #place = null; // of the moment; null: the newest frame, whichever that is
  #moved;

  /** `moved()` is called whenever another moment is to be shown. */
  constructor(history, moved) {
    this.#history = history;
    this.#moved = moved;
  }

  get is_live() {
    return this.#place === null;
  }

  /** The sample of the moment; undefined before the first frame. */
  get sample() {
    const { latest } = this.#history;
    return this.is_live || !latest ? latest : this.#history.at(this.#place);
  }

  go_to(place) {
    if (!this.#history.latest) return;
    this.#place = this.#history.at(place).place;
    this.#moved();
  }

  go_live() {
    if (this.is_live) return;
    this.#place = null;
    this.#moved();
  }

  /** Moves by frames. False at the newest one, if there is none to go to. */
  step(frames) {
    const { sample } = this;
    if (!sample) return false;
    const place = this.#history.at(sample.place + frames).place;
    if (place === sample.place) return false;
    this.go_to(place);
    return true;
  }

  /** Goes to the next mark before (-1) or after (1) the moment, if there is one. */
  go_to_mark(direction) {
    const here = this.sample?.place;
    const marked = this.#history.samples.filter(({ mark }) => mark);
    const found =
      direction < 0
        ? marked.findLast(({ place }) => place < here)
        : marked.find(({ place }) => place > here);
    if (found) this.go_to(found.place);
  }

  /** The frame before the last change of a parameter up to the moment; without one, the moment
      itself. */
  place_to_compare() {
    const { sample } = this;
    if (!sample) return null;
    const changed = this.#history.samples.findLast(
      ({ place, mark }) => place <= sample.place && mark?.kind === "change",
    );
    return this.#history.at((changed?.place ?? sample.place + 1) - 1).place;
  }
}
