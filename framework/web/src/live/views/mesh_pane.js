// SPDX-License-Identifier: Apache-2.0
// The 3D view with its buttons, legend and picked vertex; or words, where the browser has no WebGL.
import { decode_frame } from "../link/messages.js";
import { vertex_words } from "../words.js";
import { Colouring, write_legend } from "./colouring.js";
import { MeshView } from "./mesh_view.js";
import { Pace } from "./pace.js";
import { kTrail } from "./trail.js";

const kSoftwareDraws_per_s = 10; // without a graphics card: one takes as long as a stage of a run

export class MeshPane {
  #colouring = new Colouring();
  #template = null;
  #view = null;
  #pace = new Pace(0);

  /** `changed()` is called when another vertex is picked. */
  constructor(root, notices, changed) {
    this.root = root;
    this.notices = notices;
    this.vertex = root.querySelector("#vertex");
    this.vertex.addEventListener("input", () => {
      this.#pick(this.vertex.checkValidity() ? this.vertex.valueAsNumber : NaN);
      changed();
    });
    for (const button of root.querySelectorAll("[data-view-from]")) {
      button.addEventListener("click", () => this.fit(button.dataset.viewFrom));
    }
    const canvas = root.querySelector("#mesh");
    try {
      this.#view = new MeshView(canvas, root.querySelector("#scale-bar"), (vertex) => {
        this.vertex.value = vertex ?? "";
        this.#pick(vertex ?? NaN);
        changed();
      });
      if (this.#view.view.is_software) this.#pace = new Pace(kSoftwareDraws_per_s);
    } catch {
      root.classList.add("without-webgl");
    }
  }

  /** Vertices [3 V] m that are drawn. */
  positions() {
    return this.#view?.positions() ?? [];
  }

  fit(from) {
    this.#view?.viewpoint.fit(from);
  }

  render() {
    this.#view?.view.render();
  }

  colour() {
    this.#view?.colour();
  }

  begin(camera, template) {
    this.#colouring = new Colouring();
    this.#template = template;
    const count = (template?.vertices_m.length ?? 0) / 3;
    this.vertex.max = Math.max(0, count - 1);
    this.vertex.value = "";
    if (template && !template.edges.length) {
      const faces = (template.faces.length / 3).toLocaleString("en");
      this.notices.add(`The mesh has ${faces} faces: the page shows it without edges and strain.`);
    }
    this.#view?.begin(camera, template);
    this.#pick(NaN);
  }

  #pick(vertex) {
    this.#view?.trail.pick(Number.isInteger(vertex) ? vertex : null);
  }

  /** Calls `draw` now; or a little later, and only the last one of several, where the processor draws
      and has drawn much just before. */
  when_due(draw) {
    this.#pace.when_due(draw);
  }

  /** A frame with the choices {colouring, surroundings, other: {vertices_m, words} or null, truth_m},
      and the history up to the sample `until` for the trail. */
  show(frame, { colouring, surroundings, other, truth_m, history, until }) {
    const { shares, legend } = this.#colouring.of(colouring, frame, this.#template);
    const view = this.#view;
    let is_hatched = false;
    if (view) {
      view.compare(other?.vertices_m, truth_m);
      view.surroundings.visible = surroundings;
      view.view.show_axes(surroundings);
      if (until && view.trail.vertex !== null) {
        const recent = history.up_to(until.place, kTrail);
        view.trail.show(recent, ({ message }) => decode_frame(message).vertices_m);
      }
      is_hatched = view.show(frame, shares);
    }
    const truth_words = truth_m ? "ground truth" : "";
    const beside = other?.words ?? truth_words;
    write_legend(this.root.querySelector("#legend"), legend, { is_hatched, beside });
    this.#write_vertex(frame);
  }

  #write_vertex({ vertices_m, report }) {
    const vertex = this.#view?.trail.vertex ?? null;
    const has = vertex !== null && vertices_m?.length > 3 * vertex;
    const words = has ? vertex_words(vertex, vertices_m, report?.std_mm) : "";
    const picked = this.root.querySelector("#picked");
    if (picked.value !== words) picked.value = words;
  }
}
