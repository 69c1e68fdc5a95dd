// SPDX-License-Identifier: Apache-2.0
// Work that may be done a limited number of times a second.

const kBurst = 30; // that are done at once after a rest

export class Pace {
  #per_s;
  #left = kBurst;
  #at_s = 0;
  #timer = null;
  #work = null;

  /** 0: without a limit. */
  constructor(per_s) {
    this.#per_s = per_s;
  }

  /** Does the work now or as soon as it is due; until then later work replaces it. */
  when_due(work) {
    if (this.#per_s === 0) return work();
    this.#work = work;
    if (this.#timer === null) this.#try();
  }

  #try() {
    this.#timer = null;
    const now_s = performance.now() / 1000;
    this.#left = Math.min(kBurst, this.#left + this.#per_s * (now_s - this.#at_s));
    this.#at_s = now_s;
    if (this.#left < 1) {
      this.#timer = setTimeout(() => this.#try(), (1000 * (1 - this.#left)) / this.#per_s + 1);
      return;
    }
    --this.#left;
    const work = this.#work;
    this.#work = null;
    work?.();
  }
}
