// SPDX-License-Identifier: Apache-2.0
// The dialog that makes a template: the frame with a ring at each corner of the object.
import { element } from "../../data.js";
import { save_file } from "./save.js";
import { corners_fault, kCorners, template_zip } from "./template.js";

const kInset = 0.15; // of the image, where the rings are at first
const kArrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export class TemplateDialog {
  #corners = []; // [x, y] px of the image, whose top left pixel has its centre at (0, 0)
  #image = null; // JPEG of the frame
  #size = [0, 0]; // px of the image

  /** `scene()` gives {camera, pipeline} of the run. */
  constructor(dialog, scene) {
    this.dialog = dialog;
    this.scene = scene;
    const part = (selector) => dialog.querySelector(selector);
    this.canvas = part("canvas");
    this.lines = part("polygon");
    this.width = part("#template-width");
    this.words = part("output");
    this.save = part("#save-template");
    this.rings = kCorners.map((name, k) => this.#make_ring(name, k));
    part(".photo").append(...this.rings);
    this.width.addEventListener("input", () => this.#check());
    part("form").addEventListener("submit", (event) => {
      if (event.submitter !== this.save) return;
      event.preventDefault();
      this.#save();
    });
  }

  /** Opens it with a frame; refuses in words where it has no image. */
  open(frame) {
    this.#image = frame?.picture && this.scene().camera ? frame.image.slice() : null;
    const { width, height } = this.#image ? frame.picture : { width: 1, height: 1 };
    this.#size = [width, height];
    this.canvas.width = width;
    this.canvas.height = height;
    if (this.#image) this.canvas.getContext("2d").drawImage(frame.picture, 0, 0);
    const [low, high] = [kInset, 1 - kInset];
    const shares = [[low, low], [high, low], [high, high], [low, high]];
    this.#corners = shares.map((at) => at.map((share, axis) => Math.round(share * this.#size[axis])));
    this.dialog.querySelector("svg").setAttribute("viewBox", `-0.5 -0.5 ${width} ${height}`);
    for (const ring of this.rings) ring.hidden = !this.#image;
    this.#draw();
    this.dialog.showModal();
  }

  #make_ring(name, k) {
    const ring = element("button", { type: "button", className: "ring", textContent: k + 1 });
    ring.setAttribute("aria-label", `${k + 1}, ${name} corner`);
    let is_held = false;
    ring.addEventListener("pointerdown", (event) => {
      is_held = true;
      ring.setPointerCapture(event.pointerId);
      ring.focus();
      event.preventDefault();
    });
    ring.addEventListener("pointermove", (event) => {
      if (!is_held) return;
      const box = this.canvas.getBoundingClientRect();
      const shares = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
      this.#move(k, shares.map((share, axis) => share * this.#size[axis] - 0.5));
    });
    for (const end of ["pointerup", "pointercancel"]) {
      ring.addEventListener(end, () => (is_held = false));
    }
    ring.addEventListener("keydown", (event) => {
      const arrow = kArrows[event.key];
      if (!arrow) return;
      event.preventDefault();
      const step_px = event.shiftKey ? 10 : 1;
      this.#move(k, this.#corners[k].map((px, axis) => px + step_px * arrow[axis]));
    });
    return ring;
  }

  #move(k, place_px) {
    this.#corners[k] = place_px.map((px, axis) =>
      Math.min(this.#size[axis] - 0.5, Math.max(-0.5, px)),
    );
    this.#draw();
  }

  #draw() {
    this.rings.forEach((ring, k) => {
      const [x, y] = this.#corners[k].map((px, axis) => (100 * (px + 0.5)) / this.#size[axis]);
      ring.style.left = `${x}%`;
      ring.style.top = `${y}%`;
    });
    this.lines.setAttribute("points", this.#corners.map((corner) => corner.join(",")).join(" "));
    this.#check();
  }

  #check() {
    let words = this.#image ? corners_fault(this.#corners) : "";
    if (!this.#image) words = "This frame has no image or no camera: a template needs both.";
    const has_width = this.width.value !== "" && this.width.checkValidity();
    if (!words && !has_width) words = "Give the width of the object in mm.";
    this.words.value = words;
    this.save.disabled = words !== "";
  }

  #save() {
    const { width, height } = this.canvas;
    const made = template_zip({
      ...this.scene(),
      image: this.#image,
      picture: { width, height },
      corners: this.#corners,
      width_mm: this.width.valueAsNumber,
    });
    save_file(made, "weft_template.zip");
    this.words.value = "Saved weft_template.zip. Unpack it, then: weft live object.yaml";
  }
}
