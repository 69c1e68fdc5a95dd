// SPDX-License-Identifier: Apache-2.0
// The camera's image with the mesh over it, where the camera sees it.
import { palette, pen_of } from "./canvas.js";
import { project } from "./mesh.js";

const kHiddenShare = 0.25; // of the opacity of what is seen

export class ImageView {
  #camera = null;
  #edges = new Uint32Array();
  #frame = null;
  #shows_mesh = true;

  constructor(canvas) {
    this.canvas = canvas;
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** Camera and template of a run; the frames of another one are forgotten. */
  begin(camera, template) {
    this.#camera = camera;
    this.#edges = template?.edges ?? new Uint32Array();
    if (camera) this.canvas.style.aspectRatio = `${camera.width_px} / ${camera.height_px}`;
    this.show(null);
  }

  show_mesh(shown) {
    this.#shows_mesh = shown;
    this.draw();
  }

  /** A frame: {picture (ImageBitmap), vertices_m, visible, report}, each may be absent. */
  show(frame) {
    if (this.#frame?.picture && this.#frame.picture !== frame?.picture) this.#frame.picture.close();
    this.#frame = frame;
    this.draw();
  }

  draw() {
    const pen = pen_of(this.canvas);
    if (!this.#frame) return;
    const { picture, vertices_m, visible, report } = this.#frame;
    const { clientWidth, clientHeight } = this.canvas;
    if (picture) pen.drawImage(picture, 0, 0, clientWidth, clientHeight);
    if (!vertices_m || !this.#camera || !this.#shows_mesh) return;
    const scale = clientWidth / this.#camera.width_px;
    const at_px = project(vertices_m, this.#camera).map((px) => scale * px);
    const colour = palette()(`--mesh-${report?.state ?? "none"}`) || palette()("--mesh-none");
    const [seen, hidden] = this.#paths(at_px, visible);
    pen.lineJoin = "round";
    for (const [path, share] of [
      [hidden, kHiddenShare],
      [seen, 1],
    ]) {
      // Dark beside light, to be seen on any image.
      pen.globalAlpha = 0.35 * share;
      pen.strokeStyle = "#000";
      pen.lineWidth = 2.4;
      pen.stroke(path);
      pen.globalAlpha = 0.9 * share;
      pen.strokeStyle = colour;
      pen.lineWidth = 1;
      pen.stroke(path);
    }
    pen.globalAlpha = 1;
  }

  /** The edges between vertices that are seen, and the others. */
  #paths(at_px, visible) {
    const paths = [new Path2D(), new Path2D()];
    for (let e = 0; e < this.#edges.length; e += 2) {
      const a = this.#edges[e];
      const b = this.#edges[e + 1];
      if (Number.isNaN(at_px[2 * a]) || Number.isNaN(at_px[2 * b])) continue;
      const path = paths[!visible || (visible[a] && visible[b]) ? 0 : 1];
      path.moveTo(at_px[2 * a], at_px[2 * a + 1]);
      path.lineTo(at_px[2 * b], at_px[2 * b + 1]);
    }
    return paths;
  }
}
