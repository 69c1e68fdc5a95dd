// SPDX-License-Identifier: Apache-2.0
// What somebody must see: warnings of the run, and what is wrong with the page's own work.
import { element } from "../../data.js";

export class Notices {
  #shown = new Map(); // text -> element

  constructor(root) {
    this.root = root;
  }

  /** Shows the text until somebody closes it, and once only. */
  add(text) {
    if (this.#shown.has(text)) return;
    const close = element("button", { type: "button", textContent: "Close" });
    const notice = element(
      "div",
      { className: "notice" },
      element("p", { textContent: text }),
      close,
    );
    notice.setAttribute("role", "alert");
    close.addEventListener("click", () => notice.remove());
    this.#shown.set(text, notice);
    this.root.append(notice);
  }

  /** Those of another run are gone. */
  clear() {
    this.#shown.clear();
    this.root.replaceChildren();
  }
}

/** Tells screen readers of news, at most once a second, and only when the topic changes. */
export class Announcer {
  #topic = null;
  #text = "";
  #timer = null;

  constructor(root) {
    this.root = root;
  }

  say(topic, text) {
    if (topic === this.#topic) return;
    this.#topic = topic;
    this.#text = text;
    if (this.#timer === null) this.#tell();
  }

  #tell() {
    this.root.textContent = this.#text;
    this.#timer = setTimeout(() => {
      this.#timer = null;
      if (this.root.textContent !== this.#text) this.#tell();
    }, 1000);
  }
}
