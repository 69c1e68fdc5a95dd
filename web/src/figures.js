// SPDX-License-Identifier: Apache-2.0
// The figures of the page, each drawn where the program has left a place for it.
import { floats } from "./data.js";
import { draw, series_channels, width_of, write_legend } from "./chart.js";
import { draw_sweep } from "./sweep.js";
import { draw_scores } from "./scores.js";

const kHeight = 300;
const kManyTimesMedian = 20; // from there on a logarithmic axis shows more

function named(drawn) {
  return drawn.map(({ treatment, ...style }) => ({ name: treatment.name, ...style, treatment }));
}

/** One row a point of the curve that a treatment holds under `curve`. */
function points_of(series, curve) {
  return series.flatMap(({ name, treatment }) => {
    const xs = floats(treatment[curve].x),
      ys = floats(treatment[curve].y);
    return Array.from(xs, (x, i) => ({ series: name, x, y: Number.isNaN(ys[i]) ? null : ys[i] }));
  });
}

/** Each curve with the foot that it rises from. */
function rising_from_zero(points) {
  return points.flatMap((point, i) =>
    i > 0 && points[i - 1].series === point.series ? [point] : [{ ...point, y: 0 }, point],
  );
}

function spread_is_large(points) {
  const values = points
    .map(({ x }) => x)
    .filter((x) => x > 0)
    .sort((a, b) => a - b);
  return values.at(-1) > kManyTimesMedian * values[values.length >> 1];
}

async function draw_distribution(figure, data, series) {
  const points = rising_from_zero(points_of(series, "distribution"));
  const log = spread_is_large(points);
  write_legend(figure, series);
  await draw(figure, {
    width: width_of(figure),
    height: kHeight,
    data: { values: log ? points.filter(({ x }) => x > 0) : points },
    mark: { type: "line", interpolate: "step-after", strokeWidth: 2, clip: true },
    encoding: {
      x: {
        field: "x",
        type: "quantitative",
        title: `${data.measure.name}, ${data.measure.unit}`,
        scale: { type: log ? "log" : "linear", nice: !log, ...(!log && { zero: true }) },
      },
      y: {
        field: "y",
        type: "quantitative",
        title: "Share of all frames with truth, %",
        scale: { domain: [0, 100] },
      },
      ...series_channels(series),
    },
  });
}

async function draw_by_frame(figure, data, series) {
  write_legend(figure, series);
  await draw(figure, {
    width: width_of(figure),
    height: kHeight,
    data: { values: points_of(series, "by_frame") },
    mark: { type: "line", strokeWidth: 1.75, invalid: "break-paths-show-path-domains" },
    encoding: {
      x: {
        field: "x",
        type: "quantitative",
        title: "Frame",
        axis: { tickMinStep: 1 },
        scale: { nice: false },
      },
      y: {
        field: "y",
        type: "quantitative",
        title: `${data.measure.name}, ${data.measure.unit}`,
        scale: { zero: true },
      },
      ...series_channels(series),
    },
  });
}

/** What confidences promise, and what came true. */
async function draw_reliability(figure, data, series) {
  const values = series.flatMap(({ name, treatment }) => {
    const { x, y, frames } = treatment.reliability;
    const counts = floats(frames),
      shares = floats(y);
    return Array.from(floats(x), (said, i) => ({
      series: name,
      x: said,
      y: shares[i],
      frames: counts[i],
    }));
  });
  const unit = { domain: [0, 1], nice: false };
  const x = { field: "x", type: "quantitative", title: "Mean confidence", scale: unit };
  const y = { field: "y", type: "quantitative", title: "Share that is right", scale: unit };
  const ends = [
    { x: 0, y: 0 },
    { x: 1, y: 1 },
  ];
  write_legend(figure, series);
  await draw(figure, {
    width: Math.min(width_of(figure), kHeight + 120),
    height: kHeight,
    layer: [
      {
        data: { values: ends },
        mark: { type: "line", strokeDash: [3, 3], strokeWidth: 1, color: "var(--muted)" },
        encoding: { x, y },
      },
      {
        data: { values },
        mark: { type: "line", strokeWidth: 1.75 },
        encoding: { x, y, ...series_channels(series) },
      },
      {
        data: { values },
        mark: { type: "point", filled: true, opacity: 1 },
        encoding: {
          x,
          y,
          size: { field: "frames", type: "quantitative", legend: null, scale: { range: [20, 160] } },
          color: series_channels(series).color,
        },
      },
    ],
  });
}

/** Differences with their intervals, where they have one: what lies across zero is not decided. */
async function draw_differences(figure, { pairs, unit }) {
  const title = `Difference${unit && `, ${unit}`}`;
  const values = pairs.map((pair) => ({ ...pair, name: `${pair.a} − ${pair.b}` }));
  const with_interval = values.filter(({ low }) => low !== null);
  const interval = {
    data: { values: with_interval },
    mark: { type: "rule", strokeWidth: 2 },
    encoding: {
      x: { field: "low", type: "quantitative" },
      x2: { field: "high" },
      stroke: {
        condition: { test: "datum.decided", value: "var(--series-1)" },
        value: "var(--muted)",
      },
    },
  };
  await draw(figure, {
    width: Math.max(220, width_of(figure) - 260),
    height: { step: 26 },
    data: { values },
    encoding: {
      y: {
        field: "name",
        type: "nominal",
        sort: null,
        title: null,
        axis: { labelLimit: 260, domain: false, ticks: false, grid: true },
      },
    },
    layer: [
      { mark: { type: "rule", strokeDash: [3, 3] }, encoding: { x: { datum: 0 }, y: null } },
      ...(with_interval.length ? [interval] : []),
      {
        mark: { type: "point", filled: true, size: 60, opacity: 1 },
        encoding: {
          x: { field: "difference", type: "quantitative", title },
          fill: {
            condition: { test: "datum.decided", value: "var(--series-1)" },
            value: "var(--muted)",
          },
        },
      },
    ],
  });
}

async function draw_stage_times(figure, data) {
  const values = data.treatments.flatMap(({ name, stages }) =>
    stages.map(({ stage, ms }, order) => ({ name, stage, ms, order })),
  );
  const stages = [...new Set(values.map(({ stage }) => stage))];
  const series = stages.map((name, i) => ({
    name,
    colour: `var(--series-${(i % 8) + 1})`,
    dash: [1, 0],
  }));
  write_legend(figure, series);
  await draw(figure, {
    width: Math.max(220, width_of(figure) - 260),
    height: { step: 24 },
    data: { values },
    mark: { type: "bar" },
    encoding: {
      y: {
        field: "name",
        type: "nominal",
        sort: null,
        title: null,
        axis: { labelLimit: 260, domain: false, ticks: false },
      },
      x: { field: "ms", type: "quantitative", title: "Mean time for a frame, ms" },
      order: { field: "order" },
      color: series_channels(series).color,
    },
    transform: [{ calculate: "datum.stage", as: "series" }],
  });
}

/** Whether the name of a point would run into that of one just below it. */
function is_above_another({ error, fps }, values) {
  const reach = 0.2 * Math.max(...values.map((value) => value.error));
  return values.some(
    (other) =>
      other.fps < fps && other.fps > fps / 1.4 && Math.abs(other.error - error) < reach,
  );
}

/** How many frames fit into a second against how far off they are, each point with its name. */
async function draw_speed(figure, data, series) {
  const values = series
    .map(({ name, treatment }) => ({
      series: name,
      error: treatment.mean_mm,
      fps: 1000 / treatment.processor_ms,
    }))
    .filter(({ error, fps }) => error !== null && Number.isFinite(fps));
  for (const value of values) value.name_dy = is_above_another(value, values) ? -7 : 0;
  const all_fps = values.map(({ fps }) => fps);
  const domain = [Math.min(...all_fps) / 1.3, Math.max(...all_fps) * 1.3];
  await draw(figure, {
    width: width_of(figure),
    height: kHeight,
    data: { values },
    encoding: {
      x: {
        field: "error",
        type: "quantitative",
        title: `${data.measure.name}, ${data.measure.unit}`,
        scale: { zero: true },
      },
      y: {
        field: "fps",
        type: "quantitative",
        title: "Frames a second, of one processor core",
        scale: { type: "log", domain, nice: false },
        axis: { tickCount: 4, format: "~r" },
      },
    },
    layer: [
      {
        mark: { type: "point", filled: true, size: 90, opacity: 1 },
        encoding: { color: series_channels(series).color },
      },
      {
        mark: { type: "text", align: "left", dx: 9, dy: { expr: "datum.name_dy" }, fontSize: 12 },
        encoding: { text: { field: "series" } },
      },
    ],
  });
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
  await keep_drawn("figure-times", selection, (figure) => draw_stage_times(figure, data));
  for (const figure of document.querySelectorAll("figure.differences")) {
    await draw_differences(figure, data.comparisons[Number(figure.dataset.comparison)]);
  }
  for (const figure of document.querySelectorAll("figure.sweep")) {
    await draw_sweep(figure, data.sweeps[Number(figure.dataset.sweep)]);
  }
  for (const figure of document.querySelectorAll("figure.scores")) {
    await draw_scores(figure, data.scores[Number(figure.dataset.scores)]);
  }
}
