// SPDX-License-Identifier: Apache-2.0
import { kColours } from "../../selection.js";

const kRest = kColours - 1; // slot of all stages that have no colour of their own

/** A colour for each stage, which it keeps for as long as it has one. */
export class StageColours {
  #slots = new Map();

  update(samples) {
    const totals = new Map();
    for (const { stages } of samples) {
      for (const { stage, ms } of stages) totals.set(stage, (totals.get(stage) ?? 0) + ms);
    }
    const ranked = [...totals.keys()].sort((a, b) => totals.get(b) - totals.get(a));
    const room = ranked.length <= kColours ? kColours : kRest;
    const named = new Set(ranked.slice(0, room));
    for (const [stage, slot] of this.#slots) {
      if (!named.has(stage) || slot >= room) this.#slots.delete(stage);
    }
    for (const stage of totals.keys()) {
      if (named.has(stage) && !this.#slots.has(stage)) this.#slots.set(stage, this.#free());
    }
  }

  #free() {
    const taken = new Set(this.#slots.values());
    return Array.from({ length: kColours }, (_, slot) => slot).find((slot) => !taken.has(slot));
  }

  /** Its number; the page's style has its colour as --series-1 and so on. */
  slot(stage) {
    return this.#slots.get(stage) ?? kRest;
  }

  has(stage) {
    return this.#slots.has(stage);
  }
}
