// SPDX-License-Identifier: Apache-2.0
// The figures of the page, each drawn where the program has left a place for it.
import { draw_by_frame, draw_distribution, draw_reliability } from "./curves.js";
import { draw_scores } from "./scores.js";
import { draw_sweep } from "./sweep.js";
import { draw_speed, draw_stage_times } from "./times.js";

function named(drawn) {
  return drawn.map(({ treatment, ...style }) => ({ name: treatment.name, ...style, treatment }));
}

/** Draws a figure, where the page has a place for it, now and whenever what it shows changes. */
async function keep_drawn(id, selection, draw_it) {
  const figure = document.getElementById(id);
  if (!figure) return;
  const again = () => draw_it(figure, named(selection.drawn()));
  selection.addEventListener("change", again);
  let width = window.innerWidth;
  window.addEventListener("resize", () => {
    if (window.innerWidth === width) return;
    width = window.innerWidth;
    again();
  });
  await again();
}

/** Draws every figure for which the page has a place. */
export async function draw_figures(data, selection) {
  await keep_drawn("figure-distribution", selection, (figure, series) =>
    draw_distribution(figure, data, series),
  );
  await keep_drawn("figure-by-frame", selection, (figure, series) =>
    draw_by_frame(figure, data, series),
  );
  await keep_drawn("figure-reliability", selection, (figure, series) =>
    draw_reliability(figure, data, series),
  );
  await keep_drawn("figure-speed", selection, (figure, series) =>
    draw_speed(figure, data, series),
  );
  await keep_drawn("figure-times", selection, draw_stage_times);
  for (const figure of document.querySelectorAll("figure.sweep")) {
    await draw_sweep(figure, data.sweeps[Number(figure.dataset.sweep)]);
  }
  for (const figure of document.querySelectorAll("figure.scores")) {
    await draw_scores(figure, data.scores[Number(figure.dataset.scores)]);
  }
}
