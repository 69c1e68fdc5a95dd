// SPDX-License-Identifier: Apache-2.0
// Figures over an axis of numbers: a measure against the axis, or the ROC curve that the axis draws
// when it is the threshold of a filter. Of the other axes one has a curve for each value; the
// reader chooses which, and a value for each of the rest.
import { element, floats, shown } from "./data.js";
import { band_rows } from "./curves.js";
import { draw_lines } from "./panels.js";
import { style_of } from "./selection.js";

const kEach = "a curve each";
const kCurves = 20; // the filters or solvers of one plan

/** The measure that a figure of responses shows. */
function make_measure(sweep, again) {
  const select = element("select", { ariaLabel: "measure" });
  for (const measure of sweep.measures) select.append(element("option", { textContent: measure }));
  select.addEventListener("change", again);
  return select;
}

/** For each other axis a choice: one of its values, or a curve for each, as families have at first. A
    ROC curve begins amid the values: at the first, often the easiest or the hardest, it may have
    nothing to show. */
function make_choices(sweep, again) {
  const family = sweep.others.findIndex(({ families }) => families);
  const few = ({ values }) => values.length > 1 && values.length <= kCurves;
  const curves = family >= 0 ? family : sweep.others.findLastIndex(few);
  return sweep.others.map(({ name, values }, i) => {
    const select = element("select", { ariaLabel: name });
    for (const value of [...values, kEach])
      select.append(element("option", { textContent: value }));
    if (sweep.roc) select.selectedIndex = values.length >> 1;
    if (i === curves) select.value = kEach;
    select.addEventListener("change", again);
    return select;
  });
}

/** The curves that the choices leave, with names of what still differs; twenty at most. */
function chosen_curves(sweep, choices) {
  const free = choices.map(({ value }) => value === kEach);
  const curves = sweep.curves.filter(({ others }) =>
    others.every((value, i) => free[i] || value === choices[i].value),
  );
  const series = curves.slice(0, kCurves).map((curve, slot) => ({
    name: curve.others.filter((_, i) => free[i]).join(" · ") || "all cells",
    note:
      curve.auc === null
        ? ""
        : `AUC ${shown(curve.auc, 3)}, to FPR 10 %: ${shown(curve.partial_auc, 3)}`,
    ...style_of(slot),
    curve,
  }));
  return { series, left_out: curves.length - series.length };
}

/** A point for each value of the axis. */
function with_points(series, x_of, y_of) {
  return series.map((each) => {
    const xs = x_of(each.curve),
      ys = y_of(each.curve);
    const points = Array.from(floats(each.curve.values), (value, i) => ({
      value,
      x: xs[i],
      y: ys[i],
    }));
    return { ...each, points: points.filter(({ x, y }) => !Number.isNaN(x) && !Number.isNaN(y)) };
  });
}

async function draw_roc(figure, sweep, series) {
  const percent = { scale: { domain: [0, 100], nice: false } };
  const curves = with_points(
    series,
    ({ figures }) => floats(figures[0]),
    ({ figures }) => floats(figures[1]),
  ).map((each) => ({ ...each, points: each.points.map((row) => ({ ...row, place: row.x + row.y })) }));
  const corners = [
    { x: 0, y: 0 },
    { x: 100, y: 100 },
  ];
  const axis = { type: "quantitative", title: null, ...percent };
  const encoding = { x: { field: "x", ...axis }, y: { field: "y", ...axis } };
  await draw_lines(figure, curves, {
    panels: true,
    square: true,
    dots: true,
    order: "place",
    below: [
      {
        data: { values: corners },
        mark: { type: "line", stroke: "var(--rule-strong)", strokeDash: [3, 3] },
        encoding,
      },
    ],
    tooltip: [
      { field: "series", title: "curve" },
      { field: "value", title: sweep.axis },
      { field: "x", title: "FPR, %", format: ".1f" },
      { field: "y", title: "TPR, %", format: ".1f" },
    ],
    x: { title: "Inliers rejected (FPR), %", ...percent },
    y: { title: "Mismatches rejected (TPR), %", ...percent },
  });
}

async function draw_response(figure, sweep, series, measure) {
  const title = sweep.measures[measure];
  const curves = with_points(
    series,
    ({ values }) => floats(values),
    ({ figures }) => floats(figures[measure]),
  ).map((each) => ({
    ...each,
    note: "",
    band: title === sweep.banded_measure ? band_rows(each.curve.band) : [],
  }));
  await draw_lines(figure, curves, {
    dots: true,
    zero: true,
    height: 260,
    tooltip: [
      { field: "series", title: "curve" },
      { field: "x", title: sweep.axis },
      { field: "y", title, format: ".4" },
    ],
    x: { title: sweep.axis, scale: { zero: false, nice: false } },
    y: { title },
  });
}

export async function draw_sweep(figure, sweep) {
  const again = async () => {
    const { series, left_out } = chosen_curves(sweep, choices);
    if (sweep.roc) await draw_roc(figure, sweep, series);
    else await draw_response(figure, sweep, series, measure.selectedIndex);
    if (left_out > 0) figure.querySelector(".plot").append(`${left_out} more are not drawn`);
  };
  const measure = make_measure(sweep, again);
  const choices = make_choices(sweep, again);
  const controls = figure.querySelector(".controls");
  if (!sweep.roc && sweep.measures.length > 1)
    controls.append(element("label", {}, "shown ", measure));
  sweep.others.forEach(({ name, values }, i) => {
    if (values.length > 1) controls.append(element("label", {}, `${name} `, choices[i]));
  });
  await again();
}
