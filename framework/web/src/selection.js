// SPDX-License-Identifier: Apache-2.0
// Which combinations the figures draw, chosen in the main table, which thereby is their legend.

export const kColours = 8;
const kMost = 16; // panels of a figure: from the ninth on the colours begin anew

/** The colour of a slot; the page's style defines it for light, dark and print. */
export function style_of(slot) {
  return { colour: `var(--series-${(slot % kColours) + 1})` };
}

export class Selection extends EventTarget {
  #treatments; // by their ids
  #slots = Array(kMost).fill(null); // index of a treatment, or null
  #buttons = new Map();

  constructor(treatments) {
    super();
    this.#treatments = new Map(treatments.map((each) => [each.id, each]));
    for (const button of document.querySelectorAll("button.swatch")) {
      const treatment = Number(button.dataset.treatment);
      this.#buttons.set(treatment, button);
      button.addEventListener("click", () => this.toggle(treatment));
    }
    const drawn = treatments.filter(({ drawn }) => drawn).slice(0, kMost);
    drawn.forEach(({ id }, slot) => {
      this.#slots[slot] = id;
    });
    this.#show();
  }

  /** The treatments drawn, each with its colour. */
  drawn() {
    return this.#slots.flatMap((id, slot) =>
      id === null ? [] : [{ treatment: this.#treatments.get(id), ...style_of(slot) }],
    );
  }

  toggle(id) {
    const slot = this.#slots.indexOf(id);
    const free = this.#slots.indexOf(null);
    if (slot >= 0) this.#slots[slot] = null;
    else if (free >= 0) this.#slots[free] = id;
    else return; // every panel is in use: the button says so
    this.#show();
    this.dispatchEvent(new Event("change"));
  }

  #show() {
    const full = !this.#slots.includes(null);
    for (const [id, button] of this.#buttons) {
      const slot = this.#slots.indexOf(id);
      button.setAttribute("aria-pressed", slot >= 0);
      button.style.setProperty("--colour", slot >= 0 ? style_of(slot).colour : "transparent");
      button.classList.toggle("dashed", slot >= kColours);
      button.title =
        slot >= 0
          ? "Drawn in the figures; click to leave it out"
          : full
            ? `The figures draw ${kMost} at most; leave one out first`
            : "Click to draw it in the figures";
    }
  }
}
