// SPDX-License-Identifier: Apache-2.0
// Which parts of the page are shown: drawers, one view alone, tabs on a narrow screen, the theme.
import { recall, remember } from "./memory.js";
import { Split } from "./split.js";

const kDrawers = ["settings", "strips"];
const kThemes = ["auto", "light", "dark"];
const kNarrow = matchMedia("(max-width: 46rem)");

const by_id = (id) => document.getElementById(id);

export class Layout {
  #theme = recall("theme", "auto");
  #alone = null; // "image" or "mesh": the view that fills the window

  /** `recoloured()` is called when the theme changes. */
  constructor(recoloured) {
    this.recoloured = recoloured;
    new Split(by_id("views"), by_id("split"));
    for (const name of kDrawers) {
      const wide = recall(`drawer.${name}`, true);
      this.#show_drawer(name, wide);
      by_id(`toggle-${name}`).addEventListener("click", () => this.toggle_drawer(name));
    }
    for (const button of document.querySelectorAll("[data-alone]")) {
      button.addEventListener("click", () => this.toggle_alone(button.dataset.alone));
    }
    for (const button of document.querySelectorAll("[data-tab-of]")) {
      button.addEventListener("click", () => this.#show_tab(button.dataset.tabOf));
    }
    document.addEventListener("fullscreenchange", () => {
      if (!document.fullscreenElement && this.#alone) this.#set_alone(null);
    });
    by_id("theme").addEventListener("click", () => this.#next_theme());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.recoloured());
    this.#show_tab(recall("tab", "image"));
    this.#set_theme(this.#theme);
  }

  toggle_drawer(name) {
    if (kNarrow.matches) return this.#show_tab(name);
    const shown = document.body.dataset[name] !== "open";
    this.#show_drawer(name, shown);
    remember(`drawer.${name}`, shown);
  }

  #show_drawer(name, shown) {
    document.body.dataset[name] = shown ? "open" : "closed";
    by_id(`toggle-${name}`).setAttribute("aria-expanded", shown);
  }

  /** Fills the screen with a view, or ends that. */
  toggle_alone(view) {
    const leaves = this.#alone === view;
    this.#set_alone(leaves ? null : view);
    if (leaves) {
      if (document.fullscreenElement) document.exitFullscreen();
    } else if (!document.fullscreenElement) {
      // A browser that refuses shows the view alone in its window.
      document.documentElement.requestFullscreen?.().catch(() => {});
    }
  }

  leave_alone() {
    if (this.#alone) this.toggle_alone(this.#alone);
  }

  #set_alone(view) {
    this.#alone = view;
    if (view) document.body.dataset.onlyView = view;
    else delete document.body.dataset.onlyView;
    for (const button of document.querySelectorAll("[data-alone]")) {
      button.setAttribute("aria-pressed", button.dataset.alone === view);
    }
  }

  #show_tab(name) {
    document.body.dataset.tab = name;
    if (name === "image" || name === "mesh") document.body.dataset.view = name;
    document.body.dataset.view ??= "image";
    for (const button of document.querySelectorAll("[data-tab-of]")) {
      button.setAttribute("aria-pressed", button.dataset.tabOf === name);
    }
    remember("tab", name);
  }

  #next_theme() {
    const next = kThemes[(kThemes.indexOf(this.#theme) + 1) % kThemes.length];
    remember("theme", next);
    this.#set_theme(next);
    this.recoloured();
  }

  #set_theme(theme) {
    this.#theme = theme;
    if (theme === "auto") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = theme;
    by_id("theme").textContent = `Theme: ${theme}`;
  }
}
