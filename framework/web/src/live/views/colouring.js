// SPDX-License-Identifier: Apache-2.0
// Colours of the mesh by what is known of its vertices, and the legend of each.
import { kRampStyle, kStops, round_number } from "../../errors.js";
import { percent } from "../words.js";
import { vertex_strain } from "./mesh.js";

const kLeastStd_mm = 0.01;
const kLeastStrain = 0.005;
const kNearlyAll = 0.98;
const kFrames = 150; // whose scale is one

export const kColourings = [
  { name: "std", title: "Standard deviation" },
  { name: "texture", title: "Texture" },
  { name: "confidence", title: "Confidence" },
  { name: "visibility", title: "Visibility" },
  { name: "strain", title: "Strain" },
];

/** The value below which nearly all are. */
function upper(values) {
  const sorted = [...values].filter(Number.isFinite).sort((a, b) => a - b);
  return sorted.length ? sorted[Math.floor(kNearlyAll * (sorted.length - 1))] : 0;
}

/** Gives each frame its colours. A scale is that of the last frames together, so that their colours
    can be compared. */
export class Colouring {
  #recent = { std: [], strain: [] }; // of each frame the value at the end of its own scale

  /** {shares [V] on the ramp from 0 to 1, legend}, or {legend} where the frame lacks it. A
      legend has {low, high} for the ends of the ramp, or `keys`, or a `text`. */
  of(name, frame, template) {
    const count = (frame.vertices_m?.length ?? 0) / 3;
    switch (name) {
      case "confidence":
        return this.#confidence(frame, count);
      case "std":
        return this.#std(frame, count);
      case "visibility":
        return this.#visibility(frame, count);
      case "strain":
        return this.#strain(frame, template);
      default:
        return { legend: template?.texture ? {} : { text: "The template has no texture." } };
    }
  }

  #confidence({ report }, count) {
    const confidence = report?.confidence;
    if (!Number.isFinite(confidence)) {
      return { legend: { text: "The solver reports no confidence." } };
    }
    return {
      shares: new Float32Array(count).fill(1 - confidence),
      legend: { low: "sure", high: "not at all", text: `now ${percent(confidence)}` },
    };
  }

  #std({ report }, count) {
    const values = report?.std_mm;
    if (!Array.isArray(values) || values.length !== count) {
      return { legend: { text: "The solver reports no standard deviations." } };
    }
    const scale = this.#scale("std", Math.max(kLeastStd_mm, upper(values)));
    return {
      shares: Float32Array.from(values, (value) => value / scale),
      legend: { low: "0", high: `${scale} mm and more` },
    };
  }

  #visibility({ visible }, count) {
    if (visible?.length !== count) {
      return { legend: { text: "No stage reports which vertices are visible." } };
    }
    return {
      shares: Float32Array.from(visible, (seen) => (seen ? 0 : 1)),
      legend: {
        keys: [
          { colour: kStops.at(0), name: "seen" },
          { colour: kStops.at(-1), name: "hidden" },
        ],
      },
    };
  }

  #strain({ vertices_m }, template) {
    if (!vertices_m || !template) return { legend: { text: "There is no shape." } };
    if (!template.edges.length) return { legend: { text: "The mesh has too many faces." } };
    const strain = vertex_strain(vertices_m, template.edges, template.rest_m);
    const scale = this.#scale("strain", Math.max(kLeastStrain, upper(strain.map(Math.abs))));
    const end = `${Number((100 * scale).toPrecision(3))}\u00a0%`;
    return {
      shares: strain.map((value) => 0.5 + (0.5 * value) / scale),
      legend: { low: `shorter by ${end}`, high: `longer by ${end}` },
    };
  }

  #scale(name, value) {
    const recent = this.#recent[name];
    recent.push(value);
    if (recent.length > kFrames) recent.shift();
    return round_number(Math.max(...recent));
  }
}

/** Writes a legend, or none, into its element, and what else is to be seen beside the colours. */
export function write_legend(root, legend, { is_hatched, beside }) {
  const content = JSON.stringify([legend, is_hatched, beside]);
  if (root.dataset.content === content) return; // each writing costs a layout
  root.dataset.content = content;
  const text = (selector, words) => {
    const node = root.querySelector(selector);
    node.textContent = words ?? "";
    node.hidden = !words;
  };
  const ramp = root.querySelector(".ramp");
  ramp.style.background = kRampStyle;
  ramp.hidden = !legend.low;
  text(".low", legend.low);
  text(".high", legend.high);
  text(".text", legend.text);
  root.querySelector(".hatched").hidden = !is_hatched;
  root.querySelector(".beside").hidden = !beside;
  root.querySelector(".beside > :last-child").textContent = beside;
  const keys = legend.keys ?? [];
  root.querySelector(".keys").replaceChildren(
    ...keys.flatMap(({ colour, name }) => {
      const sample = document.createElement("span");
      sample.className = "key";
      sample.style.background = colour;
      return [sample, name];
    }),
  );
}
