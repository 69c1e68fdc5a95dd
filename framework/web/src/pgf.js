// SPDX-License-Identifier: Apache-2.0
// A drawn figure as PGF, for \input in LaTeX with the package pgf.

const kPtPerPx = 0.75;
const kArcPoints = 24; // corners of what has an arc
const kAnchors = { start: "left,base", middle: "base", end: "right,base" };

const kEscapes = {
  "\\": "\\textbackslash{}",
  "~": "\\textasciitilde{}",
  "^": "\\textasciicircum{}",
  "−": "$-$",
  "–": "--",
  "·": "$\\cdot$",
  "…": "\\dots{}",
};

const escaped = (text) =>
  text.replaceAll(/[\\~^−–·…&%$#_{}]/g, (letter) => kEscapes[letter] ?? `\\${letter}`);

/** "rgb(11, 107, 179)" as a share of each colour; null for no paint. */
function rgb_of(paint) {
  const parts = paint.match(/[\d.]+/g)?.map(Number);
  if (!parts || parts[3] === 0) return null;
  return parts.slice(0, 3).map((part) => (part / 255).toFixed(3)).join(",");
}

/** Corners of a path or line in its own units, and whether it is closed: Vega writes M, L, H, V, h, v,
    Z and arcs. */
function corners_of(path) {
  if (path.tagName === "line") {
    const end = (name) => Number(path.getAttribute(name) ?? 0);
    return [{ closed: false, points: [[end("x1"), end("y1")], [end("x2"), end("y2")]] }];
  }
  const text = path.getAttribute("d") ?? "";
  if (/[AaCcQq]/.test(text)) {
    const length = path.getTotalLength();
    const at = (i) => path.getPointAtLength((length * i) / kArcPoints);
    return [{ closed: true, points: Array.from({ length: kArcPoints }, (_, i) => [at(i).x, at(i).y]) }];
  }
  const outlines = [];
  let x = 0,
    y = 0;
  for (const [, command, list] of text.matchAll(/([A-Za-z])([^A-Za-z]*)/g)) {
    const numbers = (list.match(/-?[\d.]+(?:e-?\d+)?/g) ?? []).map(Number);
    if (command === "M") outlines.push({ closed: false, points: [] });
    if (command === "Z") outlines.at(-1).closed = true;
    const step = "MLl".includes(command) ? 2 : 1;
    for (let i = 0; i + step <= numbers.length; i += step) {
      const relative = command === command.toLowerCase();
      if (step === 2) {
        x = numbers[i] + (relative ? x : 0);
        y = numbers[i + 1] + (relative ? y : 0);
      } else if (/h/i.test(command)) x = numbers[i] + (relative ? x : 0);
      else if (/v/i.test(command)) y = numbers[i] + (relative ? y : 0);
      outlines.at(-1).points.push([x, y]);
    }
  }
  return outlines.filter(({ points }) => points.length > 1);
}

/** The figure's marks as PGF, in their present colours. */
export function pgf_of(figure) {
  const svg = figure.querySelector(".plot svg");
  const frame = svg.getBoundingClientRect();
  const point = (matrix, [x, y]) => {
    const across = matrix.a * x + matrix.c * y + matrix.e - frame.left;
    const down = matrix.b * x + matrix.d * y + matrix.f - frame.top;
    const [right, up] = [across, frame.height - down].map((px) => (px * kPtPerPx).toFixed(2));
    return `\\pgfpoint{${right}pt}{${up}pt}`;
  };
  const opacity_of = (node) =>
    node === svg ? 1 : Number(getComputedStyle(node).opacity) * opacity_of(node.parentElement);
  const lines = [];
  const draw_path = (node, style, opacity) => {
    const fill = rgb_of(style.fill);
    const stroke = Number.parseFloat(style.strokeWidth) > 0 ? rgb_of(style.stroke) : null;
    const matrix = node.getScreenCTM();
    const path = corners_of(node)
      .map(
        ({ points, closed }) =>
          points
            .map((place, i) => `\\pgfpath${i ? "lineto" : "moveto"}{${point(matrix, place)}}`)
            .join("") + (closed ? "\\pgfpathclose" : ""),
      )
      .join("");
    if (path === "" || (!fill && !stroke)) return;
    const uses = [fill && "fill", stroke && "stroke"].filter(Boolean).join(",");
    const dashed = style.strokeDasharray !== "none" ? "{2pt}{2pt}" : "";
    lines.push(
      `${path}\\pgfsetfillopacity{${(opacity * Number(style.fillOpacity)).toFixed(2)}}` +
        `\\pgfsetstrokeopacity{${(opacity * Number(style.strokeOpacity)).toFixed(2)}}` +
        (fill ? `\\definecolor{weft}{rgb}{${fill}}\\pgfsetfillcolor{weft}` : "") +
        (stroke ? `\\definecolor{weft}{rgb}{${stroke}}\\pgfsetstrokecolor{weft}` : "") +
        `\\pgfsetdash{${dashed}}{0pt}` +
        `\\pgfsetlinewidth{${(Number.parseFloat(style.strokeWidth) * kPtPerPx).toFixed(2)}pt}` +
        `\\pgfusepath{${uses}}`,
    );
  };
  const write_text = (node, style) => {
    const size = (Number.parseFloat(style.fontSize) * kPtPerPx).toFixed(1);
    lines.push(
      `\\definecolor{weft}{rgb}{${rgb_of(style.fill)}}\\pgftext[at=${point(node.getScreenCTM(), [0, 0])},` +
        `${kAnchors[style.textAnchor]}]{\\fontsize{${size}}{${size}}\\selectfont\\color{weft}` +
        `${Number(style.fontWeight) >= 600 ? "\\bfseries " : ""}${escaped(node.textContent)}}`,
    );
  };
  for (const node of svg.querySelectorAll("path, line, text")) {
    const style = getComputedStyle(node);
    const opacity = opacity_of(node);
    if (style.display === "none" || opacity === 0) continue;
    if (node.tagName === "text") write_text(node, style);
    else draw_path(node, style, opacity);
  }
  const [width, height] = [frame.width, frame.height].map((px) => (px * kPtPerPx).toFixed(2));
  return (
    `% ${figure.id}, a figure of a report of Weft\n\\begin{pgfpicture}\n` +
    `\\pgfpathrectangle{\\pgfpointorigin}{\\pgfpoint{${width}pt}{${height}pt}}` +
    `\\pgfusepath{use as bounding box}\n${lines.join("\n")}\n\\end{pgfpicture}\n`
  );
}
