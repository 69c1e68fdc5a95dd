// SPDX-License-Identifier: Apache-2.0
import { page_data } from "./data.js";
import { mark_contents } from "./contents.js";
import { pgf_of } from "./pgf.js";
import { sort_tables, filter_tables, copy_commands } from "./tables.js";
import { Selection } from "./selection.js";
import { draw_figures } from "./figures.js";
import { draw_run } from "./run.js";
import { start_viewer } from "./viewer.js";
import { draw_worst } from "./worst.js";

/** Light or dark as the system has it, until the reader chooses. */
function offer_theme() {
  const root = document.documentElement;
  const button = document.getElementById("theme");
  const dark_system = matchMedia("(prefers-color-scheme: dark)");
  button.hidden = false;
  button.addEventListener("click", () => {
    const dark = root.dataset.theme ? root.dataset.theme === "dark" : dark_system.matches;
    root.dataset.theme = dark ? "light" : "dark";
    root.dispatchEvent(new Event("themechange"));
  });
  dark_system.addEventListener("change", () => root.dispatchEvent(new Event("themechange")));
}

async function start() {
  document.documentElement.classList.add("scripted");
  const data = page_data();
  offer_theme();
  mark_contents();
  sort_tables();
  filter_tables();
  copy_commands();
  const selection = new Selection(data.treatments);
  const viewer = start_viewer(data);
  await draw_figures(data, selection);
  await draw_run(data, viewer);
  draw_worst(data);
  // For tests and for curious readers: `weft_report.viewer.positions()` is what the view draws.
  window.weft_report = { viewer, selection, pgf_of };
  document.documentElement.dataset.ready = "true";
}

start();
