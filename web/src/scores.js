// SPDX-License-Identifier: Apache-2.0
// What a filter thinks of mismatches and of correct matches: two histograms over its score, for one
// value of each axis.
import { element, floats } from "./data.js";
import { draw, series_channels, width_of, write_legend } from "./chart.js";
import { style_of } from "./selection.js";

const kHeight = 240;

const kSeries = [
  { key: "correct", name: "correct matches", ...style_of(0) },
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

export async function draw_scores(figure, { axes, combinations }) {
  const again = async () => {
    const shown = combinations.find(({ values }) =>
      values.every((value, i) => value === selects[i].value),
    );
    write_legend(figure, kSeries);
    await draw(figure, {
      width: width_of(figure),
      height: kHeight,
      data: {
        values: kSeries.flatMap(({ key, name }) => (shown ? outline(name, floats(shown[key])) : [])),
      },
      transform: [{ window: [{ op: "row_number", as: "place" }] }],
      mark: { type: "line", interpolate: "step-after", strokeWidth: 2 },
      encoding: {
        x: { field: "x", type: "quantitative", title: "Score", scale: { domain: [0, 1] } },
        y: { field: "y", type: "quantitative", title: "Share, %" },
        order: { field: "place" },
        ...series_channels(kSeries),
      },
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
