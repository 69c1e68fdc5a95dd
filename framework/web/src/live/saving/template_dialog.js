// SPDX-License-Identifier: Apache-2.0
// The dialog that makes a template: the frame with a ring at each corner of the object.
import { fault_of, first_corners, kNames, make_ring, to_share, within } from "../../corners.js";
import { save_file } from "../../files.js";
import { template_zip } from "./template.js";

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
    this.rings = kNames.map((name, k) => this.#make_ring(name, k));
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
    this.#corners = first_corners({ width_px: width, height_px: height });
    this.dialog.querySelector("svg").setAttribute("viewBox", `-0.5 -0.5 ${width} ${height}`);
    for (const ring of this.rings) ring.hidden = !this.#image;
    this.#draw();
    this.dialog.showModal();
  }

  #make_ring(name, k) {
    const ring = make_ring(name, {
      box: () => this.canvas.getBoundingClientRect(),
      sizes_px: () => this.#size,
      place: () => this.#corners[k],
      move: (place_px) => {
        this.#corners[k] = within(place_px, this.#size);
        this.#draw();
      },
    });
    ring.textContent = k + 1;
    ring.setAttribute("aria-label", `${k + 1}, ${name} corner`);
    return ring;
  }

  #draw() {
    this.rings.forEach((ring, k) => {
      const [x, y] = this.#corners[k].map((px, axis) => 100 * to_share(px, this.#size[axis]));
      ring.style.left = `${x}%`;
      ring.style.top = `${y}%`;
    });
    this.lines.setAttribute("points", this.#corners.map((corner) => corner.join(",")).join(" "));
    this.#check();
  }

  #check() {
    let words = this.#image ? fault_of(this.#corners) : "";
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
