// SPDX-License-Identifier: Apache-2.0
// Draws Vega-Lite specifications as SVG whose colours are those of the page's style, so that a
// change of theme and print need no second drawing.
import { View, parse, Warn } from "vega";
import { compile } from "vega-lite";
import { element } from "./data.js";
import { save_file } from "./files.js";
import { pgf_of } from "./pgf.js";

// A family by name, so that Vega can measure its texts.
const kFont = "system-ui, -apple-system, Segoe UI, Helvetica Neue, DejaVu Sans, sans-serif";

const kConfig = {
  background: null,
  font: kFont,
  view: { stroke: null },
  axis: {
    labelColor: "var(--muted)",
    titleColor: "var(--ink)",
    gridColor: "var(--rule)",
    domainColor: "var(--rule-strong)",
    tickColor: "var(--rule-strong)",
    labelFontSize: 12,
    titleFontSize: 12.5,
    titleFontWeight: 500,
    titlePadding: 8,
    labelOverlap: "greedy",
    labelSeparation: 6,
  },
  axisX: { grid: false, tickCount: 10 },
  axisY: { titleAngle: 0, titleAlign: "left", titleAnchor: "end", titleY: -14, titleX: 0 },
  header: { labelColor: "var(--ink)", titleColor: "var(--ink)", labelFontSize: 12.5 },
  legend: { labelColor: "var(--ink)", titleColor: "var(--muted)" },
  rule: { stroke: "var(--rule-strong)" },
  text: { fill: "var(--ink)" },
};

/** Colours of the page in place of their names, for a file that stands alone. */
function with_plain_colours(svg) {
  const style = getComputedStyle(document.documentElement);
  return svg.replaceAll(/var\((--[\w-]+)\)/g, (_, name) => style.getPropertyValue(name).trim());
}

/** A button that saves what `text` gives as a file of the figure. */
function save_button(figure, ending, type, text) {
  const button = element("button", {
    type: "button",
    textContent: ending.toUpperCase(),
    title: `Save as ${figure.id}.${ending}`,
  });
  button.addEventListener("click", async () => {
    save_file(new Blob([await text()], { type }), `${figure.id}.${ending}`);
  });
  return button;
}

function offer_files(figure, view) {
  figure.querySelector(".save")?.remove();
  const svg = async () => with_plain_colours(await view.toSVG());
  const command = `rsvg-convert --format=pdf --output=${figure.id}.pdf ${figure.id}.svg`;
  figure.querySelector(".plot").after(
    element(
      "p",
      { className: "save files" },
      "Save as ",
      save_button(figure, "svg", "image/svg+xml", svg),
      save_button(figure, "pgf", "text/plain", () => pgf_of(figure)),
      " as PDF: ",
      element("code", { className: "command", textContent: command }),
    ),
  );
}

/** Draws `spec` in the figure in place of what was there. */
export async function draw(figure, spec) {
  const plot = figure.querySelector(".plot");
  figure.view?.finalize();
  plot.replaceChildren();
  const compiled = compile({ ...spec, config: kConfig }).spec;
  const view = new View(parse(compiled), {
    renderer: "svg",
    container: plot,
    logLevel: Warn,
    hover: true,
  });
  await view.runAsync();
  plot.querySelector("svg")?.setAttribute("role", "img");
  figure.view = view;
  offer_files(figure, view);
}

/** The colours of series by name, as a channel of an encoding. */
export function colours_of(series) {
  return {
    field: "series",
    type: "nominal",
    legend: null,
    scale: { domain: series.map(({ name }) => name), range: series.map(({ colour }) => colour) },
  };
}

/** The legend of a plot of areas or bars: a colour and a name for each series. */
export function write_legend(figure, series) {
  const items = series.map(({ name, colour }) => {
    const sample = element("span", { className: "sample" });
    sample.style.setProperty("--colour", colour);
    return element("li", {}, sample, element("span", { textContent: name }));
  });
  figure.querySelector(".legend").replaceChildren(...items);
}

/** The encoding of rows by the name of what they show, in the order of the data. */
export function names_axis(axis = {}) {
  return {
    field: "name",
    type: "nominal",
    sort: null,
    title: null,
    axis: { labelLimit: 260, domain: false, ticks: false, ...axis },
  };
}

/** The inner width that a plot has where it stands. */
export function width_of(figure) {
  return Math.max(220, Math.min(figure.querySelector(".plot").clientWidth, 1100) - 70);
}
