// SPDX-License-Identifier: Apache-2.0
// A picked vertex, and where it was in the frames before.
import {
  BufferAttribute,
  BufferGeometry,
  DynamicDrawUsage,
  Group,
  Line,
  LineBasicMaterial,
  Points,
  PointsMaterial,
} from "three";
import { colour_of } from "../../view3d.js";

export const kTrail = 300; // frames at most

export class Trail extends Group {
  #vertex = null;
  #places = new Map(); // of frames -> [x, y, z] m
  #position = new BufferAttribute(new Float32Array(3 * kTrail), 3);

  constructor() {
    super();
    this.#position.setUsage(DynamicDrawUsage);
    const points = () => new BufferGeometry().setAttribute("position", this.#position);
    const over_all = { depthTest: false, transparent: true };
    this.line = new Line(points(), new LineBasicMaterial(over_all));
    // At the end of the line.
    this.dot = new Points(points(), new PointsMaterial({ size: 9, sizeAttenuation: false, ...over_all }));
    for (const object of [this.line, this.dot]) {
      object.frustumCulled = false;
      object.renderOrder = 1;
      this.add(object);
    }
    this.pick(null);
    this.colour();
  }

  get vertex() {
    return this.#vertex;
  }

  pick(vertex) {
    this.#vertex = vertex;
    this.#places.clear();
    this.visible = vertex !== null;
  }

  colour() {
    this.line.material.color = colour_of("--series-2");
    this.dot.material.color = colour_of("--series-2");
  }

  /** Draws the trail through at most kTrail samples; `vertices_of(sample)` gives [3 V] m or none. */
  show(samples, vertices_of) {
    if (this.#vertex === null) return;
    const points = samples.map((sample) => this.#point_of(sample, vertices_of)).filter(Boolean);
    const first = samples[0]?.place;
    for (const place of this.#places.keys()) if (place < first) this.#places.delete(place);
    points.forEach((point, i) => this.#position.set(point, 3 * i));
    this.#position.needsUpdate = true;
    this.line.geometry.setDrawRange(0, points.length);
    this.dot.geometry.setDrawRange(Math.max(0, points.length - 1), Math.min(1, points.length));
  }

  #point_of(sample, vertices_of) {
    if (!this.#places.has(sample.place)) {
      const vertices_m = vertices_of(sample);
      const at = 3 * this.#vertex;
      const point = vertices_m?.length > at ? vertices_m.slice(at, at + 3) : null;
      this.#places.set(sample.place, point);
    }
    return this.#places.get(sample.place);
  }
}
