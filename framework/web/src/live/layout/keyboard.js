// SPDX-License-Identifier: Apache-2.0
// The keys of the whole page, and the dialog that lists them.
import { element } from "../../data.js";
import { recall, remember } from "./memory.js";

// Elements that use these keys themselves while they have the focus.
const kOwnKeys = [
  ["input:not([type=checkbox], [type=range]), select", /./],
  ["input[type=checkbox], button, summary", /^ $/],
  ["input[type=range], [role=separator]", /^(Arrow.*|Home|End|Page.*)$/],
  ["[role=application]", /^(Arrow.*|Home|End|Enter|\+|-)$/],
];
const kCharacter = /^[^ ?]$/; // may be switched off: speech input types them

const is_taken = (target, key) =>
  kOwnKeys.some(([selector, keys]) => target.matches?.(selector) && keys.test(key));

export class Keyboard {
  /** `keys` is a list of {key, words, act, name}: `key` as in KeyboardEvent, `name` as the dialog
      shows it, where that differs. */
  constructor(dialog, keys) {
    this.dialog = dialog;
    const by_key = new Map(keys.map((each) => [each.key, each]));
    const letters = dialog.querySelector("#letters");
    letters.checked = recall("letters", true);
    letters.addEventListener("change", () => remember("letters", letters.checked));
    dialog.querySelector("#keys").append(
      ...keys.flatMap(({ key, name = key, words }) => [
        element("dt", {}, element("kbd", { textContent: name })),
        element("dd", { textContent: words }),
      ]),
    );
    addEventListener("keydown", (event) => {
      if (document.querySelector("dialog[open]")) return; // even if nothing in it has the focus
      if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
      const found = by_key.get(event.key);
      if (!found || is_taken(event.target, event.key)) return;
      if (kCharacter.test(event.key) && !letters.checked) return;
      event.preventDefault();
      found.act();
    });
    document.getElementById("help").addEventListener("click", () => this.show());
  }

  show() {
    this.dialog.showModal();
  }
}
