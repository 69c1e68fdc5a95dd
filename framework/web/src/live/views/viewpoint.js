// SPDX-License-Identifier: Apache-2.0
// From where the mesh is seen: the view follows it, fits it, and is turned by mouse or keyboard.
import { Box3, Vector3 } from "three";
import { round_number } from "../../errors.js";

const kRoom = 0.35; // of the box of a shape, around it, in which it may move before the view follows
const kMargin = 0.08; // of the box, around it in a view that fits
const kNearest = 0.05; // of the size of the mesh
const kFarthest = 40;
const kTurn = Math.PI / 24; // by a key
const kApproach = 0.87; // of the distance, by a key
const kLongestBar = 120; // px of the page

const kKeys = {
  ArrowLeft: (controls) => controls.rotateLeft(-kTurn),
  ArrowRight: (controls) => controls.rotateLeft(kTurn),
  ArrowUp: (controls) => controls.rotateUp(-kTurn),
  ArrowDown: (controls) => controls.rotateUp(kTurn),
  "+": (controls) => controls.dollyIn(kApproach),
  "-": (controls) => controls.dollyOut(kApproach),
};
/** From the mesh to the viewer; the front is what the camera sees. */
const kDirections = {
  front: new Vector3(0, 0, 1),
  side: new Vector3(1, 0, 0),
  top: new Vector3(0, 1, 0.001),
};

export class Viewpoint {
  #view;
  #surroundings;
  #scale_bar;
  #vertices_m = null; // [3 V] that are seen
  #box = null; // in which the mesh may be without the view being moved
  #touched = false; // by a person
  #is_gliding = false;

  /** `surroundings` are built anew with each view; `scale_bar` is an element over the canvas. */
  constructor(view, surroundings, scale_bar) {
    this.#view = view;
    this.#surroundings = surroundings;
    this.#scale_bar = scale_bar;
    const { controls, canvas } = view;
    controls.enableDamping = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    controls.dampingFactor = 0.12;
    controls.addEventListener("start", () => (this.#touched = true));
    controls.addEventListener("change", () => {
      this.#write_scale();
      this.#glide();
    });
    canvas.addEventListener("keydown", (event) => this.#press(event));
    new ResizeObserver(() => this.#resize()).observe(canvas);
  }

  /** Another mesh is to come; the view starts anew. */
  begin() {
    this.#vertices_m = null;
    this.#touched = false;
    this.#box = null;
  }

  /** The mesh has these vertices [3 V] m now. The view stays where it is until the mesh leaves its
      surroundings; once it was turned by hand, until no vertex is visible. */
  follow(vertices_m) {
    this.#vertices_m = vertices_m;
    if (this.#touched && this.#box) {
      if (!this.#sees_mesh()) this.#look(this.#direction());
    } else if (!this.#box?.containsBox(this.#bounds())) {
      this.#look();
    }
  }

  /** Fits the mesh into the view: as before it was turned, or from "front", "side" or "top". */
  fit(from) {
    this.#touched = from in kDirections;
    this.#box = null;
    if (this.#vertices_m) this.#look(kDirections[from]);
  }

  /** Builds the surroundings anew, after a change of theme. */
  recolour() {
    if (this.#box) this.#look(this.#direction());
  }

  #look(direction) {
    const { controls } = this.#view;
    const box = this.#bounds();
    const size = box.getSize(new Vector3());
    this.#box = box.clone().expandByVector(size.clone().multiplyScalar(kRoom));
    this.#stop();
    controls.minDistance = kNearest * size.length();
    controls.maxDistance = kFarthest * size.length();
    this.#surroundings.build(box);
    this.#view.look_at(box.expandByVector(size.multiplyScalar(kMargin)), direction);
  }

  #bounds() {
    const box = new Box3();
    const point = new Vector3();
    for (let v = 0; v < this.#vertices_m.length; v += 3) {
      box.expandByPoint(this.#place(v, point));
    }
    return box;
  }

  /** A vertex in the frame of WebGL. */
  #place(v, point) {
    const vertices_m = this.#vertices_m;
    return point.set(vertices_m[v], -vertices_m[v + 1], -vertices_m[v + 2]);
  }

  #sees_mesh() {
    const { camera } = this.#view;
    camera.updateMatrixWorld();
    const point = new Vector3();
    for (let v = 0; v < this.#vertices_m.length; v += 3) {
      const { x, y, z } = this.#place(v, point).project(camera);
      if (Math.max(Math.abs(x), Math.abs(y), Math.abs(z)) < 1) return true;
    }
    return false;
  }

  #direction() {
    return this.#view.camera.position.clone().sub(this.#view.controls.target);
  }

  /** Lets a turn end slowly. */
  #glide() {
    if (this.#is_gliding) return;
    this.#is_gliding = true;
    const go_on = () => {
      this.#is_gliding = this.#view.controls.update();
      if (this.#is_gliding) requestAnimationFrame(go_on);
    };
    requestAnimationFrame(go_on);
  }

  /** Ends a turn that still goes on. */
  #stop() {
    const { controls } = this.#view;
    const glides = controls.enableDamping;
    controls.enableDamping = false;
    controls.update();
    controls.enableDamping = glides;
  }

  #resize() {
    this.#view.render();
    this.#write_scale();
    if (this.#box && !this.#touched) this.fit();
  }

  /** The bar is as long as is written at it, at the depth about which the view turns. */
  #write_scale() {
    const { camera, controls, canvas } = this.#view;
    const distance_m = camera.position.distanceTo(controls.target);
    const view_m = 2 * distance_m * Math.tan((camera.fov * Math.PI) / 360);
    const px_per_m = canvas.clientHeight / view_m;
    const length_mm = round_number((1000 * kLongestBar) / Math.max(1e-9, px_per_m), true);
    this.#scale_bar.style.width = `${(length_mm / 1000) * px_per_m}px`;
    this.#scale_bar.textContent = length_mm < 1000 ? `${length_mm} mm` : `${length_mm / 1000} m`;
  }

  #press(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const act = kKeys[event.key];
    if (event.key === "Home") {
      this.fit();
    } else if (act) {
      this.#touched = true;
      act(this.#view.controls);
    } else {
      return;
    }
    event.preventDefault();
  }
}
