// SPDX-License-Identifier: Apache-2.0
// Lines that say their names themselves: a few in one plot, each with its name at its end; more of
// them a panel each, in which the others are grey.
import { colours_of, draw, width_of } from "./chart.js";

const kHeight = 300;
const kPanelHeight = 150;
const kPanelWidth = 210;
const kGap = 26;
const kAxisWidth = 46;
const kLabelled = 4; // lines of one plot
const kManyTimesMedian = 20; // from there on a logarithmic axis shows more
const kCharacter = 6.7; // px of a letter, about
const kLineHeight = 15;

/** Series whose points are the same, as one. */
function without_copies(series) {
  const merged = new Map();
  for (const each of series) {
    const key = JSON.stringify(each.points.map(({ x, y }) => [x, y]));
    if (!merged.has(key)) merged.set(key, { ...each, copies: [] });
    else merged.get(key).copies.push(each.name);
  }
  return [...merged.values()].map(({ copies, ...each }) => ({
    ...each,
    name:
      copies.length === 0
        ? each.name
        : copies.length === 1
          ? `${each.name}, ${copies[0]}`
          : `${each.name} and ${copies.length} more`,
    tip: [each.name, ...copies].join(", "),
  }));
}

/** Whether most would be flat were all on a linear scale. */
function spread_is_large(series) {
  const values = series
    .flatMap(({ points }) => points.map(({ y }) => y))
    .filter((y) => y !== null)
    .sort((a, b) => a - b);
  return values[0] > 0 && values.at(-1) > kManyTimesMedian * values[values.length >> 1];
}

/** Numbers from a little below all to a little above, with zero where an axis begins there. */
function domain_of(series, { domain, zero, log }) {
  if (domain) return domain;
  const values = series.flatMap(({ points, band }) => [
    ...points.map(({ y }) => y),
    ...(band ?? []).flatMap(({ low, high }) => [low, high]),
  ]).filter((value) => value !== null && Number.isFinite(value));
  if (log) {
    const above = values.filter((value) => value > 0);
    return [Math.min(...above) / 1.1, Math.max(...above) * 1.1];
  }
  const low = Math.min(...values, ...(zero ? [0] : []));
  const high = Math.max(...values, ...(zero ? [0] : []));
  const margin = 0.04 * (high - low || Math.abs(high) || 1);
  return [zero && low >= 0 ? 0 : low - margin, zero && high <= 0 ? 0 : high + margin];
}

/** Heights of names that would stand at `wanted`, px from the top: as near as none overlaps. */
function spread(wanted, height) {
  const order = wanted.map((_, i) => i).sort((a, b) => wanted[a] - wanted[b]);
  const placed = [...wanted];
  order.forEach((i, rank) => {
    if (rank > 0) placed[i] = Math.max(placed[i], placed[order[rank - 1]] + kLineHeight);
  });
  for (let rank = order.length - 1, below = height + kLineHeight; rank >= 0; --rank) {
    placed[order[rank]] = Math.min(placed[order[rank]], below - kLineHeight);
    below = placed[order[rank]];
  }
  return placed;
}

function rows_of(series) {
  return series.flatMap(({ name, points }) => points.map((point) => ({ series: name, ...point })));
}

function bands_of(series) {
  return series.flatMap(({ name, band }) =>
    (band ?? []).map((row) => ({ series: name, band: true, ...row })),
  );
}

/** What both kinds of plot have: bands, lines and points, and what lies below them. */
function layers_of(series, { x, y, order, step, dots, sizes, tooltip, below = [] }) {
  const color = colours_of(series);
  const line = {
    mark: {
      type: "line",
      strokeWidth: 2,
      clip: true,
      invalid: "break-paths-show-path-domains",
      ...(step && { interpolate: "step-after" }),
    },
    encoding: { x, y, color, ...(order && { order: { field: order } }) },
    transform: [{ filter: "!datum.band" }],
  };
  const points = {
    transform: [{ filter: "!datum.band" }],
    mark: { type: "point", filled: true, opacity: 1, size: 22 },
    encoding: {
      x,
      y,
      color,
      ...(tooltip && { tooltip }),
      ...(sizes && {
        size: { field: sizes, type: "quantitative", legend: null, scale: { range: [20, 160] } },
      }),
    },
  };
  const band = {
    mark: { type: "area", opacity: 0.18, clip: true },
    encoding: { x, y: { ...y, field: "low" }, y2: { field: "high" }, color },
    transform: [{ filter: "datum.band" }],
  };
  const has_band = series.some(({ band: rows }) => rows?.length);
  return [...below, ...(has_band ? [band] : []), line, ...(dots ? [points] : [])];
}

function one_plot(figure, series, options) {
  const { x, y, height = kHeight } = options;
  const longest = Math.max(...series.map(({ name }) => name.length)) * kCharacter + 16;
  const [low, high] = options.y_domain;
  const ends = series.map(({ points }) => points.findLast((point) => point.y !== null) ?? {});
  const place = (value) => (height * (high - value)) / (high - low);
  const heights = spread(ends.map((end) => place(end.y ?? low)), height);
  const labels = series.map(({ name, tip }, i) => ({ series: name, tip, height: heights[i] }));
  const width = width_of(figure) - longest;
  return {
    width,
    height,
    data: { values: [...rows_of(series), ...bands_of(series)] },
    layer: [
      ...layers_of(series, { ...options, x, y }),
      {
        data: { values: labels },
        mark: { type: "text", align: "left", baseline: "middle", fontSize: 12 },
        encoding: {
          x: { value: width + 8 },
          y: { field: "height", type: "quantitative", scale: null },
          text: { field: "series" },
          tooltip: { field: "tip" },
        },
      },
    ],
  };
}

function many_panels(figure, series, options) {
  const { x, y, square } = options;
  const room = width_of(figure) + kGap;
  const most = Math.max(1, Math.floor((room - kAxisWidth) / (kPanelWidth + kGap)));
  const columns = Math.min(most, series.length);
  const width = Math.min(
    Math.floor((room - kAxisWidth) / columns) - kGap,
    series.length === 1 ? Infinity : square ? 260 : 420,
  );
  const height = square ? width : series.length === 1 ? kHeight : kPanelHeight;
  const [bare_x, bare_y] = [x, y].map((channel) => ({
    ...channel,
    title: null,
    axis: { tickCount: square ? 3 : 4, ...channel.axis },
  }));
  const lines = rows_of(series);
  const grey = {
    data: { name: "others", values: lines.map((row) => ({ ...row, other: true })) },
    mark: {
      type: "line",
      strokeWidth: 1,
      stroke: "var(--rule-strong)",
      opacity: 0.55,
      clip: true,
      invalid: "break-paths-show-path-domains",
      ...(options.step && { interpolate: "step-after" }),
    },
    encoding: {
      x: bare_x,
      y: bare_y,
      detail: { field: "series" },
      ...(options.order && { order: { field: options.order } }),
    },
  };
  const titles = Object.fromEntries(
    series.map(({ name, note }) => [name, note ? [name, note] : [name]]),
  );
  return {
    title: {
      text: y.title,
      anchor: "start",
      color: "var(--ink)",
      fontSize: 12.5,
      fontWeight: 500,
      offset: 10,
    },
    data: { values: [...lines, ...bands_of(series)] },
    facet: {
      field: "series",
      type: "nominal",
      sort: series.map(({ name }) => name),
      title: x.title,
      header: {
        titleOrient: "bottom",
        labelAnchor: "start",
        labelLimit: width + kGap - 6,
        labelPadding: 4,
        labelFontWeight: 500,
        labelExpr: `(${JSON.stringify(titles)})[datum.value]`,
        titleFontWeight: 500,
        titleFontSize: 12.5,
      },
    },
    columns,
    spacing: { row: 18, column: kGap },
    spec: {
      width,
      height,
      layer: [
        ...(series.length > 1 ? [grey] : []),
        ...layers_of(series, { ...options, x: bare_x, y: bare_y }),
      ],
    },
  };
}

/** Draws lines: series of {name, note, colour, points [{x, y}], band [{x, low, high}]}. Options: the
    channels `x` and `y` without data, `step`, `dots`, `sizes` (a field of points), `order` (a
    field), `square`, `panels` (never one plot), `below` (layers under the lines), `zero`, `nothing`
    (what stands in place of no line). */
export async function draw_lines(figure, all, options) {
  const series = without_copies(all.filter(({ points }) => points.length > 0));
  if (series.length === 0) {
    figure.querySelector(".plot").replaceChildren(options.nothing ?? "Nothing to draw.");
    return;
  }
  const log = Boolean(options.zero) && spread_is_large(series);
  const { domain } = options.y.scale ?? {};
  const y_domain = domain_of(series, { domain, zero: options.zero, log });
  const x = { field: "x", type: "quantitative", ...options.x };
  const y = {
    field: "y",
    type: "quantitative",
    ...options.y,
    scale: { ...options.y.scale, domain: y_domain, nice: false, type: log ? "log" : "linear" },
    ...(log && { axis: { format: "~r" } }),
  };
  const longest = Math.max(...series.map(({ name }) => name.length)) * kCharacter;
  const fits = longest < 0.3 * width_of(figure);
  const together = !options.panels && !log && series.length <= kLabelled && fits;
  const plot = together ? one_plot : many_panels;
  await draw(figure, plot(figure, series, { ...options, x, y, y_domain }));
}
