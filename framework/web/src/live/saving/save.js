// SPDX-License-Identifier: Apache-2.0
// The picture of the page that the browser saves.
import { element } from "../../data.js";
import { save_file } from "../../files.js";

const kCaptionHeight = 40;
/** Saves both canvases side by side, with the words below them, as PNG. */
export async function save_picture(image, mesh, words, name) {
  const height = Math.max(image.height, mesh.height);
  const canvas = element("canvas", {
    width: image.width + mesh.width,
    height: height + kCaptionHeight,
  });
  const pen = canvas.getContext("2d");
  const style = getComputedStyle(document.documentElement);
  pen.fillStyle = style.getPropertyValue("--paper").trim();
  pen.fillRect(0, 0, canvas.width, canvas.height);
  pen.drawImage(image, 0, 0);
  pen.drawImage(mesh, image.width, 0);
  pen.fillStyle = style.getPropertyValue("--ink").trim();
  pen.font = "18px system-ui, DejaVu Sans, sans-serif";
  pen.textBaseline = "middle";
  pen.fillText(words, 12, height + kCaptionHeight / 2, canvas.width - 24);
  save_file(await new Promise((done) => canvas.toBlob(done, "image/png")), name);
}
