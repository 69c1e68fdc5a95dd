// SPDX-License-Identifier: Apache-2.0
// A match from near: its patch of the texture beside that of the image.
import { match_words } from "../words.js";

const kRadius_px = 24; // of the image, in both patches

export class Patch {
  constructor(root) {
    this.root = root;
    this.words = root.querySelector("figcaption");
    [this.of_texture, this.of_image] = root.querySelectorAll("canvas");
    root.querySelector("button").addEventListener("click", () => this.hide());
  }

  hide() {
    this.root.hidden = true;
  }

  /** Shows a match of a frame with a picture; `texture` is a loaded image or null. */
  show(frame, index, texture, camera) {
    this.root.hidden = false;
    this.words.textContent = match_words(frame, index);
    const [x_px, y_px] = frame.match_px.subarray(2 * index, 2 * index + 2);
    const shrunk = frame.picture ? frame.picture.width / camera.width_px : 1;
    const centre_px = [(x_px + 0.5) * shrunk, (y_px + 0.5) * shrunk];
    this.#draw(this.of_image, frame.picture, centre_px, kRadius_px * shrunk);
    const [u, v] = frame.match_uv.subarray(2 * index, 2 * index + 2);
    const { naturalWidth: width = 0, naturalHeight: height = 0 } = texture ?? {};
    // As much of the texture as an image that it fills would show.
    const radius = (kRadius_px * width) / camera.width_px;
    this.#draw(this.of_texture, texture, [u * width, v * height], radius);
  }

  #draw(canvas, source, [x, y], radius) {
    const pen = canvas.getContext("2d");
    pen.clearRect(0, 0, canvas.width, canvas.height);
    if (!source) return;
    pen.imageSmoothingEnabled = false;
    const side = 2 * radius;
    pen.drawImage(source, x - radius, y - radius, side, side, 0, 0, canvas.width, canvas.height);
    pen.strokeStyle = "#ff3df2";
    pen.strokeRect(canvas.width / 2 - 4, canvas.height / 2 - 4, 8, 8);
  }
}
