// SPDX-License-Identifier: Apache-2.0
// Differences of pairs with their intervals: over all scenes, and scene by scene.
import { draw, names_axis, width_of } from "./chart.js";

const kMostPairs = 16; // panels of a figure
const kPanelWidth = 150;
const kGap = 22;
const kManyTimes = 4;

/** Differences with their intervals, where they have one: what lies across zero is not decided. */
export async function draw_differences(figure, { pairs, unit }) {
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
      y: names_axis({ grid: true }),
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

/** Which of two is better where the interval leaves zero out. */
function better({ difference, low, high }, low_is_good) {
  if (low === null || low <= 0 === high >= 0) return "undecided";
  return difference < 0 === low_is_good ? "a" : "b";
}

/** A row for each scene, a panel for each pair. */
export async function draw_scenes(figure, { pairs, scenes, unit, low_is_good }) {
  const reference = pairs.every(({ b }) => b === pairs[0].b) ? pairs[0].b : null;
  const name_of = ({ a, b }) => (reference === null ? `${a} − ${b}` : a);
  const shown = pairs.flatMap((pair, i) => (scenes[i].length ? [{ pair, rows: scenes[i] }] : []));
  const some = shown.slice(0, kMostPairs);
  const values = some.flatMap(({ pair, rows }) =>
    rows.map((row) => ({ ...row, pair: name_of(pair), better: better(row, low_is_good) })),
  );
  const names = [...new Set(values.map(({ scene }) => scene))];
  const room = width_of(figure) + 70;
  const label_width = Math.min(0.4 * room, 12 + 6.7 * Math.max(...names.map((n) => n.length)));
  const columns = Math.max(
    1,
    Math.min(some.length, Math.floor((room - label_width) / (kPanelWidth + kGap))),
  );
  const width = Math.min(420, Math.floor((room - label_width) / columns) - kGap);
  const colour = {
    field: "better",
    type: "nominal",
    legend: null,
    scale: {
      domain: ["a", "b", "undecided"],
      range: ["var(--series-1)", "var(--series-2)", "var(--muted)"],
    },
  };
  // Where some pairs are much farther apart than others, each has a scale of its own.
  const reach = some.map(({ rows }) => Math.max(...rows.map((row) => Math.abs(row.difference))));
  const typical = [...reach].sort((a, b) => a - b)[reach.length >> 1];
  const apart = Math.max(...reach) > kManyTimes * typical;
  const with_interval = values.some(({ low }) => low !== null);
  const y = {
    field: "scene",
    type: "nominal",
    sort: names,
    title: null,
    axis: { labelLimit: label_width, domain: false, ticks: false, grid: true },
  };
  await draw(figure, {
    data: { values },
    facet: {
      field: "pair",
      type: "nominal",
      sort: some.map(({ pair }) => name_of(pair)),
      title: `Difference${reference === null ? "" : ` from ${reference}`}${unit && `, ${unit}`}`,
      header: {
        titleOrient: "bottom",
        titleFontWeight: 500,
        titleFontSize: 12.5,
        labelAnchor: "start",
        labelFontWeight: 500,
        labelLimit: width,
      },
    },
    columns,
    ...(apart && { resolve: { scale: { x: "independent" } } }),
    spacing: { row: 14, column: kGap },
    spec: {
      width,
      height: { step: 19 },
      layer: [
        {
          data: { values: [{}] },
          mark: { type: "rule", strokeDash: [3, 3] },
          encoding: { x: { datum: 0 } },
        },
        ...(with_interval
          ? [
              {
                transform: [{ filter: "isValid(datum.low)" }],
                mark: { type: "rule", strokeWidth: 2 },
                encoding: {
                  y,
                  x: { field: "low", type: "quantitative", title: null, axis: { tickCount: 4 } },
                  x2: { field: "high" },
                  color: colour,
                },
              },
            ]
          : []),
        {
          mark: { type: "point", filled: true, size: 48, opacity: 1 },
          encoding: {
            y,
            x: { field: "difference", type: "quantitative", title: null, axis: { tickCount: 4 } },
            color: colour,
            tooltip: [
              { field: "pair", title: reference === null ? "A − B" : "A" },
              { field: "scene" },
              { field: "difference", format: ".3" },
              { field: "low", title: "95 % from", format: ".3" },
              { field: "high", title: "to", format: ".3" },
            ],
          },
        },
      ],
    },
  });
  if (shown.length > some.length) {
    figure.querySelector(".plot").append(`${shown.length - some.length} more pairs are not drawn`);
  }
}
