// SPDX-License-Identifier: Apache-2.0
// The errors of combinations as curves: their distribution, over the frames, and how much their
// confidence is worth.
import { element, floats } from "./data.js";
import { draw_lines } from "./panels.js";

const kManyTimesMedian = 20; // from there on a logarithmic axis shows more
const kTogether = 0.15; // of the error: curves nearer to each other are drawn as differences

/** The points of a curve, and its band where it has one. */
export function curve_points({ x, y, band }) {
  const xs = floats(x),
    ys = floats(y);
  return {
    points: Array.from(xs, (place, i) => ({ x: place, y: Number.isNaN(ys[i]) ? null : ys[i] })),
    band: band ? band_rows(band) : [],
  };
}

export function band_rows({ x, low, high }) {
  const lows = floats(low),
    highs = floats(high);
  return Array.from(floats(x), (place, i) => ({ x: place, low: lows[i], high: highs[i] }));
}

function spread_is_large(series) {
  const values = series
    .flatMap(({ points }) => points.map(({ x }) => x))
    .filter((x) => x > 0)
    .sort((a, b) => a - b);
  return values.at(-1) > kManyTimesMedian * values[values.length >> 1];
}

/** Each curve with the foot that it rises from; on a logarithmic axis without what it cannot show. */
function rising(points, log) {
  const shown = log ? points.filter(({ x }) => x > 0) : points;
  return shown.length ? [{ x: shown[0].x, y: 0 }, ...shown] : [];
}

export async function draw_distribution(figure, data, series) {
  const curves = series.map((each) => ({
    ...each,
    points: curve_points(each.treatment.distribution).points,
  }));
  const log = spread_is_large(curves);
  await draw_lines(
    figure,
    curves.map((each) => ({ ...each, points: rising(each.points, log) })),
    {
      panels: true,
      step: true,
      x: {
        title: `${data.measure.name}, ${data.measure.unit}`,
        scale: { type: log ? "log" : "linear", nice: !log, ...(!log && { zero: true }) },
      },
      y: { title: "Share of all frames with truth, %", scale: { domain: [0, 100] } },
    },
  );
}

/** Whether the curves lie so close together that only their differences can be seen. */
function coincide(curves) {
  const by_frame = new Map();
  for (const { x, y } of curves.flatMap(({ points }) => points)) {
    if (y !== null) by_frame.set(x, [...(by_frame.get(x) ?? []), y]);
  }
  let apart = 0,
    level = 0;
  for (const values of by_frame.values()) {
    apart += Math.max(...values) - Math.min(...values);
    level += values.reduce((sum, value) => sum + value, 0) / values.length;
  }
  return curves.length > 1 && apart > 0 && apart < kTogether * level;
}

/** The reader's choice between errors and differences; curves that coincide begin as the latter. */
function choice_of(figure, reference, curves, again) {
  const known = figure.querySelector("select");
  if (known) return known;
  const select = element("select", { ariaLabel: "shown over the frames" });
  select.append(
    element("option", { textContent: "error" }),
    element("option", { textContent: `difference from ${reference}` }),
  );
  select.selectedIndex = coincide(curves) ? 1 : 0;
  select.addEventListener("change", again);
  figure
    .querySelector(".plot")
    .before(element("div", { className: "controls" }, element("label", {}, "shown ", select)));
  return select;
}

export async function draw_by_frame(figure, data, series) {
  const { name, unit } = data.measure;
  const curves_of = (key) =>
    series.map((each) => ({ ...each, ...curve_points(each.treatment[key]) }));
  const errors = curves_of("by_frame");
  const again = () => draw_by_frame(figure, data, figure.series);
  figure.series = series;
  const as_difference = choice_of(figure, data.reference, errors, again).selectedIndex === 1;
  const zero_line = {
    data: { values: [{}] },
    mark: { type: "rule", strokeDash: [3, 3] },
    encoding: { y: { datum: 0 } },
  };
  await draw_lines(
    figure,
    as_difference
      ? curves_of("by_frame_difference").filter((each) => each.name !== data.reference)
      : errors,
    {
      zero: !as_difference,
      below: as_difference ? [zero_line] : [],
      x: { title: "Frame", axis: { tickMinStep: 1 }, scale: { nice: false } },
      y: { title: as_difference ? `Difference of the error, ${unit}` : `${name}, ${unit}` },
    },
  );
}

/** What confidences promise, and what came true. */
export async function draw_reliability(figure, data, series) {
  const curves = series.map((each) => {
    const { x, y, frames } = each.treatment.reliability;
    const counts = floats(frames);
    const points = curve_points({ x, y }).points.map((row, i) => ({ ...row, frames: counts[i] }));
    return { ...each, points: points.length > 1 ? points : [] };
  });
  const unit = { domain: [0, 1], nice: false };
  const ends = [
    { x: 0, y: 0 },
    { x: 1, y: 1 },
  ];
  const axis = { type: "quantitative", scale: unit, title: null };
  const diagonal = {
    data: { values: ends },
    mark: { type: "line", strokeDash: [3, 3], strokeWidth: 1, color: "var(--muted)" },
    encoding: { x: { field: "x", ...axis }, y: { field: "y", ...axis } },
  };
  await draw_lines(figure, curves, {
    panels: true,
    square: true,
    dots: true,
    sizes: "frames",
    below: [diagonal],
    nothing: "Each of the chosen combinations has all its frames in one tenth: see the table.",
    x: { title: "Mean confidence", scale: unit },
    y: { title: "Share that is right", scale: unit },
  });
}
