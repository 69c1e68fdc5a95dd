// SPDX-License-Identifier: Apache-2.0
// Times of a pass that took them: frames a second against the error, and what each stage takes.
import { draw, colours_of, names_axis, width_of, write_legend } from "./chart.js";

const kHeight = 340;
const kCharacter = 6.7; // px of a letter, about
const kLine = 15;

/** Where names may stand about their points, the best place first: dx, dy, alignment. */
const kPlaces = [
  [0, -14, "center"],
  [0, 15, "center"],
  [9, -12, "left"],
  [-9, -12, "right"],
  [9, 13, "left"],
  [-9, 13, "right"],
  [9, 0, "left"],
  [-9, 0, "right"],
];

const overlaps = (a, b) => a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;

/** Gives each point, at `px` and `py`, a place of its name that covers nothing, if there is one. */
function place_names(values, width) {
  const taken = values.map(({ px, py }) => ({ x0: px - 6, x1: px + 6, y0: py - 6, y1: py + 6 }));
  values.forEach((value, own) => {
    const long = value.series.length * kCharacter;
    const boxes = kPlaces.map(([dx, dy, align]) => {
      const x0 = value.px + dx - (align === "left" ? 0 : align === "right" ? long : long / 2);
      const y0 = value.py + dy - kLine / 2;
      return { x0, x1: x0 + long, y0, y1: y0 + kLine };
    });
    const free = boxes.findIndex(
      (box) =>
        box.x0 >= 0 &&
        box.x1 <= width &&
        taken.every((other, i) => i === own || !overlaps(box, other)),
    );
    const place = Math.max(0, free);
    [value.dx, value.dy, value.align] = kPlaces[place];
    taken.push(boxes[place]);
  });
}

/** Whether no other is faster and as accurate, or as fast and more accurate. */
const is_best = ({ fps, error }, values) =>
  !values.some(
    (other) =>
      other.fps >= fps && other.error <= error && (other.fps > fps || other.error < error),
  );

/** How many frames fit into a second against how far off they are, each point with its name. */
export async function draw_speed(figure, data, series) {
  const values = series
    .map(({ name, treatment }) => ({
      series: name,
      error: treatment.mean_mm,
      low: treatment.low_mm,
      high: treatment.high_mm,
      fps: 1000 / treatment.processor_ms,
    }))
    .filter(({ error, fps }) => error !== null && Number.isFinite(fps));
  if (values.length === 0) return;
  const width = width_of(figure);
  const all_fps = values.map(({ fps }) => fps);
  const domain = [Math.min(...all_fps) / 1.3, Math.max(...all_fps) * 1.3];
  const end = 1.05 * Math.max(...values.map(({ error, high }) => Math.max(error, high ?? 0)));
  for (const value of values) {
    value.best = is_best(value, values);
    value.px = (value.error / end) * width;
    value.py = kHeight * (1 - Math.log(value.fps / domain[0]) / Math.log(domain[1] / domain[0]));
  }
  place_names(values, width);
  const x = {
    field: "error",
    type: "quantitative",
    title: `${data.measure.name}, ${data.measure.unit}`,
    scale: { domain: [0, end], nice: false },
  };
  const y = {
    field: "fps",
    type: "quantitative",
    title: "Frames a second, of one processor core",
    scale: { type: "log", domain, nice: false },
    axis: { tickCount: 4, format: "~r" },
  };
  const front = values.filter(({ best }) => best);
  const names = ["left", "right", "center"].map((align) => ({
    transform: [{ filter: `datum.align === "${align}"` }],
    mark: {
      type: "text",
      align,
      baseline: "middle",
      dx: { expr: "datum.dx" },
      dy: { expr: "datum.dy" },
      fontSize: 12,
    },
    encoding: { x, y, text: { field: "series" } },
  }));
  await draw(figure, {
    width,
    height: kHeight,
    data: { values },
    layer: [
      {
        data: { values: front },
        mark: { type: "line", strokeWidth: 1, strokeDash: [3, 3], color: "var(--muted)" },
        encoding: { x, y, order: { field: "error" } },
      },
      {
        transform: [{ filter: "isValid(datum.low)" }],
        mark: { type: "rule", strokeWidth: 1.5, color: "var(--series-1)", opacity: 0.6 },
        encoding: { x: { ...x, field: "low" }, x2: { field: "high" }, y },
      },
      {
        mark: { type: "point", size: 80, opacity: 1, strokeWidth: 2, color: "var(--series-1)" },
        encoding: {
          x,
          y,
          fill: {
            condition: { test: "datum.best", value: "var(--series-1)" },
            value: "var(--paper)",
          },
          tooltip: [
            { field: "series", title: "combination" },
            { field: "error", title: "mean, mm", format: ".3" },
            { field: "fps", title: "frames a second", format: ".3" },
          ],
        },
      },
      ...names.filter((_, i) => values.some(({ align }) => align === ["left", "right", "center"][i])),
    ],
  });
}

export async function draw_stage_times(figure, drawn) {
  const values = drawn.flatMap(({ name, treatment }) =>
    treatment.stages.map(({ stage, ms }, order) => ({ name, stage, ms, order })),
  );
  const stages = [...new Set(values.map(({ stage }) => stage))];
  const series = stages.map((name, i) => ({
    name,
    colour: `var(--series-${(i % 8) + 1})`,
  }));
  write_legend(figure, series);
  await draw(figure, {
    width: Math.max(220, width_of(figure) - 260),
    height: { step: 24 },
    data: { values },
    mark: { type: "bar" },
    encoding: {
      y: names_axis(),
      x: { field: "ms", type: "quantitative", title: "Mean time for a frame, ms" },
      order: { field: "order" },
      color: colours_of(series),
    },
    transform: [{ calculate: "datum.stage", as: "series" }],
  });
}
