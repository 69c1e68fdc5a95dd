// SPDX-License-Identifier: Apache-2.0
// The choices beside the views, which the browser keeps.
import { recall, remember } from "../layout/memory.js";
import { other_shape_words } from "../words.js";
import { kColourings } from "./colouring.js";
import { kMatchModes } from "./matches.js";

export const kBeside = [
  { name: "none", title: "mesh alone" },
  { name: "before", title: "with frame before" },
  { name: "other", title: `with ${other_shape_words(null)}` },
  { name: "truth", title: "with ground truth" },
];

const by_id = (id) => document.getElementById(id);

function fill(select, choices) {
  for (const { name, title } of choices) select.append(new Option(title, name));
}

export class ViewOptions {
  /** `changed.image()` and `changed.mesh()` are called when there is something to draw anew. */
  constructor(changed) {
    fill(by_id("colouring"), kColourings);
    fill(by_id("matches"), kMatchModes);
    fill(by_id("beside"), kBeside);
    this.#keep("opacity", "value", 90, changed.image);
    this.#keep("matches", "value", "none", changed.image);
    this.#keep("loupe", "checked", false, changed.image);
    this.#keep("colouring", "value", "std", changed.mesh);
    this.#keep("beside", "value", "none", changed.mesh);
    this.#keep("surroundings", "checked", true, changed.mesh);
  }

  #keep(id, property, otherwise, changed) {
    const input = by_id(id);
    input[property] = recall(`view.${id}`, otherwise);
    if (input.value === "") input[property] = otherwise; // a choice that no longer exists
    input.addEventListener("input", () => {
      remember(`view.${id}`, input[property]);
      changed();
    });
  }

  /** Of the image, as ImageView.set() takes them. */
  get image() {
    return {
      opacity: by_id("opacity").value / 100,
      matches: by_id("matches").value,
      loupe: by_id("loupe").checked,
    };
  }

  /** Of the mesh: {colouring, beside, surroundings}. */
  get mesh() {
    return {
      colouring: by_id("colouring").value,
      beside: by_id("beside").value,
      surroundings: by_id("surroundings").checked,
    };
  }

  /** The stage of the other shape, or null. */
  name_other(stage) {
    by_id("beside").querySelector("[value=other]").textContent = `with ${other_shape_words(stage)}`;
  }

  /** Offers only what a frame has. */
  offer({ match_px, truth_m, other_m }) {
    by_id("matches").disabled = !match_px;
    by_id("beside").querySelector("[value=truth]").disabled = !truth_m;
    by_id("beside").querySelector("[value=other]").disabled = !other_m;
  }
}
