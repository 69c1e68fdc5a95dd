// SPDX-License-Identifier: Apache-2.0
// The figures of a single run: what each frame came to, and how long its stages took.
import { floats } from "./data.js";
import { colours_of, draw, width_of, write_legend } from "./chart.js";
import { kColours } from "./selection.js";
import { kStates } from "./states.js";

const kHeight = 280;

/** One row a frame; a frame without a figure lies at the foot. */
function rows_of(run, has_error) {
  const figures = floats(has_error ? run.errors_mm : run.confidences);
  return Array.from(floats(run.frames), (frame, i) => ({
    frame,
    figure: Number.isNaN(figures[i]) ? null : figures[i],
    foot: Number.isNaN(figures[i]) ? 0 : figures[i],
    series: run.states[i],
  }));
}

async function draw_frames(figure, data, choose) {
  const has_error = floats(data.run.errors_mm).some((value) => !Number.isNaN(value));
  const values = rows_of(data.run, has_error);
  const there = kStates.filter(({ name }) => values.some(({ series }) => series === name));
  write_legend(figure, there);
  const x = {
    field: "frame",
    type: "quantitative",
    title: "Frame",
    axis: { tickMinStep: 1 },
    scale: { nice: false },
  };
  const title = has_error ? `${data.measure.name}, ${data.measure.unit}` : "Confidence";
  await draw(figure, {
    width: width_of(figure),
    height: kHeight,
    data: { values },
    layer: [
      {
        mark: {
          type: "line",
          strokeWidth: 1,
          color: "var(--rule-strong)",
          invalid: "break-paths-show-path-domains",
        },
        encoding: { x, y: { field: "figure", type: "quantitative", title, scale: { zero: true } } },
      },
      {
        mark: { type: "point", filled: true, size: 34, opacity: 1, cursor: "pointer" },
        encoding: {
          x,
          y: { field: "foot", type: "quantitative", title },
          color: colours_of(there),
          tooltip: [
            { field: "frame", title: "frame" },
            { field: "series", title: "state" },
            { field: "figure", title, format: ".3" },
          ],
        },
      },
    ],
  });
  figure.view.addEventListener("click", (_, item) => {
    if (item?.datum?.frame !== undefined) choose(item.datum.frame);
  });
}

async function draw_times(figure, { run }) {
  const frames = floats(run.frames);
  const stages = run.stages.map(({ stage, ms }) => ({ stage, ms: floats(ms) }));
  // The smallest share a colour, so that the large ones keep theirs.
  const total = ({ ms }) => ms.reduce((sum, value) => sum + value, 0);
  const ranked = [...stages].sort((a, b) => total(b) - total(a));
  const named = new Set(ranked.slice(0, kColours - 1).map(({ stage }) => stage));
  const name_of = (stage) => (stages.length <= kColours || named.has(stage) ? stage : "the rest");
  const names = [...new Set(stages.map(({ stage }) => name_of(stage)))];
  const series = names.map((name, i) => ({
    name,
    colour: `var(--series-${(i % kColours) + 1})`,
  }));
  write_legend(figure, series);
  await draw(figure, {
    width: width_of(figure),
    height: 220,
    data: {
      values: stages.flatMap(({ stage, ms }) =>
        Array.from(ms, (value, i) => ({ series: name_of(stage), frame: frames[i], ms: value })),
      ),
    },
    mark: { type: "area" },
    encoding: {
      x: {
        field: "frame",
        type: "quantitative",
        title: "Frame",
        axis: { tickMinStep: 1 },
        scale: { nice: false },
      },
      y: { field: "ms", type: "quantitative", aggregate: "sum", title: "Time for a frame, ms" },
      color: colours_of(series),
      order: { field: "series" },
    },
  });
}

/** Draws the figures of a run, where the page is one of a run; a click on a frame shows its shape. */
export async function draw_run(data, viewer) {
  if (!data.run) return;
  const figures = [
    ["figure-run", (figure) => draw_frames(figure, data, (frame) => viewer?.show_frame(frame))],
    ["figure-run-times", (figure) => draw_times(figure, data)],
  ];
  for (const [id, draw_it] of figures) {
    const figure = document.getElementById(id);
    if (!figure) continue;
    await draw_it(figure);
    let width = window.innerWidth;
    window.addEventListener("resize", () => {
      if (window.innerWidth === width) return;
      width = window.innerWidth;
      draw_it(figure);
    });
  }
}
