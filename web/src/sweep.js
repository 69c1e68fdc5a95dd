// SPDX-License-Identifier: Apache-2.0
// Figures over an axis of numbers: a measure against the axis, or the ROC curve that the axis draws
// when it is the threshold of a filter. Of the other axes one gives the colours; the reader chooses
// which, and a value for each of the rest.
import { element, floats, shown } from "./data.js";
import { draw, series_channels, width_of, write_legend } from "./chart.js";
import { kColours, style_of } from "./selection.js";

const kColour = "by colour";
const kCurves = 12; // the filters of one plan

/** Colour and dashes of a curve: behind the last colour they begin anew, dotted. */
function style_of_curve(slot) {
  return slot < kColours ? style_of(slot) : { ...style_of(slot - kColours), dash: [1, 3] };
}

/** The measure that a figure of responses shows. */
function make_measure(sweep, again) {
  const select = element("select", { ariaLabel: "measure" });
  for (const measure of sweep.measures) select.append(element("option", { textContent: measure }));
  select.addEventListener("change", again);
  return select;
}

/** For each other axis a choice: one of its values, or the colours, which families have at first. A
    ROC curve begins amid the values: at the first, often the easiest or the hardest, it may have
    nothing to show. */
function make_choices(sweep, again) {
  const family = sweep.others.findIndex(({ families }) => families);
  const few = ({ values }) => values.length > 1 && values.length <= kColours;
  const colours = family >= 0 ? family : sweep.others.findLastIndex(few);
  return sweep.others.map(({ name, values }, i) => {
    const select = element("select", { ariaLabel: name });
    for (const value of [...values, kColour])
      select.append(element("option", { textContent: value }));
    if (sweep.roc) select.selectedIndex = values.length >> 1;
    if (i === colours) select.value = kColour;
    select.addEventListener("change", again);
    return select;
  });
}

/** The curves that the choices leave, with names of what still differs; twelve at most. */
function chosen_curves(sweep, choices) {
  const free = choices.map(({ value }) => value === kColour);
  const curves = sweep.curves.filter(({ others }) =>
    others.every((value, i) => free[i] || value === choices[i].value),
  );
  const series = curves.slice(0, kCurves).map((curve, slot) => ({
    name: curve.others.filter((_, i) => free[i]).join(" · ") || "all cells",
    note:
      curve.auc === null
        ? ""
        : `AUC ${shown(curve.auc, 4)}, to FPR 10 %: ${shown(curve.partial_auc, 4)}`,
    ...style_of_curve(slot),
    curve,
  }));
  return { series, left_out: curves.length - series.length };
}

/** A row for each value of the axis: the value and the figures x and y. */
function points_of(series, x_of, y_of) {
  return series.flatMap(({ name, curve }) => {
    const values = floats(curve.values),
      xs = x_of(curve),
      ys = y_of(curve);
    return Array.from(values, (value, i) => ({ series: name, value, x: xs[i], y: ys[i] })).filter(
      ({ x, y }) => !Number.isNaN(x) && !Number.isNaN(y),
    );
  });
}

function roc_spec(figure, sweep, series) {
  const points = points_of(
    series,
    ({ figures }) => floats(figures[0]),
    ({ figures }) => floats(figures[1]),
  );
  const whole = series.flatMap(({ name }) => [
    { series: name, x: 0, y: 0 },
    ...points.filter((point) => point.series === name),
    { series: name, x: 100, y: 100 },
  ]);
  const side = Math.min(440, width_of(figure));
  const diagonal = [
    { x: 0, y: 0 },
    { x: 100, y: 100 },
  ];
  const percent = { type: "quantitative", scale: { domain: [0, 100] } };
  return {
    width: side,
    height: side,
    layer: [
      {
        data: { values: diagonal },
        mark: { type: "line", stroke: "var(--rule-strong)", strokeDash: [3, 3] },
        encoding: { x: { field: "x", ...percent }, y: { field: "y", ...percent } },
      },
      {
        data: { values: whole },
        mark: { type: "line", strokeWidth: 1, opacity: 0.6 },
        encoding: {
          x: { field: "x", ...percent },
          y: { field: "y", ...percent },
          order: { field: "place" },
          ...series_channels(series),
        },
        transform: [{ calculate: "datum.x + datum.y", as: "place" }],
      },
      {
        data: { values: points },
        mark: { type: "line", strokeWidth: 2, point: { filled: true, size: 16 } },
        encoding: {
          x: {
            field: "x",
            ...percent,
            title: "Correct matches rejected (FPR), %",
            axis: { grid: true },
          },
          y: { field: "y", ...percent, title: "Mismatches rejected (TPR), %" },
          order: { field: "x" },
          tooltip: [
            { field: "series", title: "curve" },
            { field: "value", title: sweep.axis },
            { field: "x", title: "FPR, %", format: ".1f" },
            { field: "y", title: "TPR, %", format: ".1f" },
          ],
          ...series_channels(series),
        },
      },
    ],
  };
}

function response_spec(figure, sweep, series, measure) {
  const title = sweep.measures[measure];
  const points = points_of(
    series,
    ({ values }) => floats(values),
    ({ figures }) => floats(figures[measure]),
  );
  return {
    width: width_of(figure),
    height: 260,
    data: { values: points },
    mark: { type: "line", strokeWidth: 2, point: { filled: true, size: 22 } },
    encoding: {
      x: {
        field: "x",
        type: "quantitative",
        title: sweep.axis,
        scale: { zero: false, nice: false },
      },
      y: { field: "y", type: "quantitative", title, scale: { zero: true } },
      tooltip: [
        { field: "series", title: "curve" },
        { field: "x", title: sweep.axis },
        { field: "y", title, format: ".4" },
      ],
      ...series_channels(series),
    },
  };
}

export async function draw_sweep(figure, sweep) {
  const again = async () => {
    const { series, left_out } = chosen_curves(sweep, choices);
    write_legend(figure, series, left_out);
    await draw(
      figure,
      sweep.roc
        ? roc_spec(figure, sweep, series)
        : response_spec(figure, sweep, series, measure.selectedIndex),
    );
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
