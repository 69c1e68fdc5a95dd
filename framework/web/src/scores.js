// SPDX-License-Identifier: Apache-2.0
// Scores of a filter for mismatches and inliers: two histograms over its score, for one
// value of each axis.
import { element, floats } from "./data.js";
import { colours_of, draw, width_of } from "./chart.js";
import { style_of } from "./selection.js";

const kHeight = 240;

const kSeries = [
  { key: "correct", name: "inliers", ...style_of(0) },
  { key: "mismatches", name: "mismatches", ...style_of(1) },
];

/** The outline of a histogram whose bins share [0, 1], from and to the axis. */
function outline(name, shares) {
  if (shares.length === 0) return [];
  const steps = Array.from(shares, (y, i) => ({ series: name, x: i / shares.length, y }));
  return [{ series: name, x: 0, y: 0 }, ...steps, { series: name, x: 1, y: shares.at(-1) }, {
    series: name,
    x: 1,
    y: 0,
  }];
}

/** The names of the outlines, each over its highest bin; apart where these are the same. */
function names_of(outlines) {
  const tops = outlines
    .filter((points) => points.length > 0)
    .map((points) => points.reduce((a, b) => (b.y > a.y ? b : a)));
  const near = tops.length === 2 && Math.abs(tops[0].x - tops[1].x) < 0.2;
  return tops.map((top, i) => ({ ...top, dy: near && i === 1 ? -24 : -9 }));
}

export async function draw_scores(figure, { axes, combinations }) {
  const again = async () => {
    const shown = combinations.find(({ values }) =>
      values.every((value, i) => value === selects[i].value),
    );
    const outlines = kSeries.map(({ key, name }) =>
      shown ? outline(name, floats(shown[key])) : [],
    );
    const x = { field: "x", type: "quantitative", title: "Score", scale: { domain: [0, 1] } };
    const y = { field: "y", type: "quantitative", title: "Share, %" };
    await draw(figure, {
      width: width_of(figure),
      height: kHeight,
      layer: [
        {
          data: { values: outlines.flat() },
          transform: [{ window: [{ op: "row_number", as: "place" }] }],
          mark: { type: "line", interpolate: "step-after", strokeWidth: 2 },
          encoding: { x, y, order: { field: "place" }, color: colours_of(kSeries) },
        },
        {
          data: { values: names_of(outlines) },
          mark: { type: "text", fontSize: 12, dy: { expr: "datum.dy" } },
          encoding: { x, y, text: { field: "series" } },
        },
      ],
    });
  };
  const selects = axes.map(({ name, values }, i) => {
    const select = element("select", { ariaLabel: name });
    for (const value of values) select.append(element("option", { textContent: value }));
    select.value = combinations[0].values[i];
    select.addEventListener("change", again);
    return select;
  });
  const controls = figure.querySelector(".controls");
  axes.forEach(({ name, values }, i) => {
    if (values.length > 1) controls.append(element("label", {}, `${name} `, selects[i]));
  });
  await again();
}
