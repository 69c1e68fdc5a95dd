// SPDX-License-Identifier: Apache-2.0
// The camera's image with the mesh over it, where the camera sees it, and with its matches.
import { palette, pen_of } from "./canvas.js";
import { contrasting_colour, pixels_of } from "./contrast.js";
import { draw_matches, nearest_match } from "./matches.js";
import { project } from "./mesh.js";
import { Patch } from "./patch.js";
import { Spot } from "./spot.js";

const kHiddenShare = 0.25; // of the opacity of what is seen
const kBeside = 0.8; // px of the screen, from a line to the one beside it
const kLoupeRadius = 80;
const kLoupeFactor = 4;
const kReach = 12; // px of the screen within which a click finds a match

export class ImageView {
  #camera = null;
  #edges = new Uint32Array();
  #frame = null;
  #other_m = null; // [3 V] vertices of the mesh to compare with
  #texture = null;
  #colour = null; // of an estimated mesh, chosen against the texture
  #options = { opacity: 0.9, matches: "none", loupe: false };

  constructor(canvas, patch) {
    this.canvas = canvas;
    this.patch = new Patch(patch);
    this.spot = new Spot(canvas, {
      moved: () => this.#options.loupe && this.draw(),
      chosen: (reach) => this.#choose_match(reach),
      left: () => this.patch.hide(),
    });
    new ResizeObserver(() => this.draw()).observe(canvas.parentElement);
  }

  /** Camera and template of a run; the frames of another one are forgotten. */
  begin(camera, template) {
    this.#camera = camera;
    this.#edges = template?.edges ?? new Uint32Array();
    this.#other_m = null;
    this.#load(template?.texture);
    this.show(null);
  }

  #load(address) {
    this.#texture = null;
    this.#colour = null;
    if (!address) return;
    const texture = new Image();
    texture.addEventListener("load", () => {
      this.#texture = texture;
      this.#colour = contrasting_colour(pixels_of(texture));
      this.draw();
    });
    texture.src = address;
  }

  /** Changes some of {opacity: 0 to 1, matches: a name of kMatchModes, loupe}. */
  set(options) {
    Object.assign(this.#options, options);
    this.draw();
  }

  /** Another mesh [3 V] m to draw beside that of the frame, or null. */
  compare(vertices_m) {
    this.#other_m = vertices_m;
  }

  /** A frame: {picture (ImageBitmap), vertices_m, visible, report}, each may be absent. */
  show(frame) {
    if (this.#frame?.picture && this.#frame.picture !== frame?.picture) this.#frame.picture.close();
    this.#frame = frame;
    this.patch.hide();
    this.draw();
  }

  /** Where the canvas shows the image: {scale, left, top} in pixels of the page. */
  get fit() {
    const { clientWidth, clientHeight } = this.canvas;
    const { width, height } = this.#frame?.picture ?? { width: 1, height: 1 };
    const { width_px, height_px } = this.#camera ?? { width_px: width, height_px: height };
    const scale = Math.min(clientWidth / width_px, clientHeight / height_px);
    const left = (clientWidth - scale * width_px) / 2;
    return { scale, left, top: (clientHeight - scale * height_px) / 2, width_px, height_px };
  }

  /** A function from image points to the canvas; pixel centres are whole numbers. */
  place_of() {
    const { scale, left, top } = this.fit;
    return (x_px, y_px) => [left + scale * (x_px + 0.5), top + scale * (y_px + 0.5)];
  }

  /** The canvas is as large as the image: a browser copies its pixels for each frame. */
  #lay_out() {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    const { width, height } = this.#frame?.picture ?? { width: clientWidth, height: clientHeight };
    const { width_px, height_px } = this.#camera ?? { width_px: width, height_px: height };
    const scale = Math.min(clientWidth / width_px, clientHeight / height_px);
    const { style } = this.canvas;
    const sizes = [scale * width_px, scale * height_px].map((side) => `${Math.round(side)}px`);
    if (style.width !== sizes[0]) [style.width] = sizes;
    if (style.height !== sizes[1]) style.height = sizes[1];
  }

  draw() {
    if (this.canvas.parentElement.clientWidth === 0) return; // it is not shown
    this.#lay_out();
    const pen = pen_of(this.canvas);
    if (!this.#frame) return;
    this.#paint(pen);
    const at = this.#options.loupe ? this.spot.at : null;
    if (at) this.#draw_loupe(pen, at);
  }

  #paint(pen) {
    const { picture, vertices_m, visible, report, match_px } = this.#frame;
    const { scale, left, top, width_px, height_px } = this.fit;
    if (picture) pen.drawImage(picture, left, top, scale * width_px, scale * height_px);
    if (!this.#camera) return;
    const { opacity, matches } = this.#options;
    const colours = palette();
    const state = report?.state ?? "none";
    const own = (state === "estimated" && this.#colour) || colours(`--mesh-${state}`);
    if (vertices_m && opacity > 0) {
      this.#draw_mesh(pen, vertices_m, visible, own || colours("--mesh-none"));
    }
    if (this.#other_m) this.#draw_mesh(pen, this.#other_m, null, colours("--mesh-compared"));
    if (match_px && matches !== "none") draw_matches(pen, this.#frame, matches, this.place_of());
  }

  #draw_mesh(pen, vertices_m, visible, colour) {
    const place_of = this.place_of();
    const at_px = project(vertices_m, this.#camera);
    const [seen, hidden] = this.#paths(at_px, visible, place_of);
    const { opacity } = this.#options;
    const is_dark = parseInt(colour.slice(1, 3), 16) < 64;
    pen.lineJoin = "round";
    pen.lineWidth = 1; // wider ones take several times as long where the processor draws
    for (const [path, share] of [
      [hidden, kHiddenShare],
      [seen, 1],
    ]) {
      // Dark beside light, to be seen on any image.
      pen.globalAlpha = 0.6 * share * opacity;
      pen.strokeStyle = is_dark ? "#fff" : "#000";
      pen.translate(kBeside, kBeside);
      pen.stroke(path);
      pen.translate(-kBeside, -kBeside);
      pen.globalAlpha = share * opacity;
      pen.strokeStyle = colour;
      pen.stroke(path);
    }
    pen.globalAlpha = 1;
  }

  /** The edges between vertices that are seen, and the others. */
  #paths(at_px, visible, place_of) {
    const paths = [new Path2D(), new Path2D()];
    for (let e = 0; e < this.#edges.length; e += 2) {
      const a = this.#edges[e];
      const b = this.#edges[e + 1];
      if (Number.isNaN(at_px[2 * a]) || Number.isNaN(at_px[2 * b])) continue;
      const path = paths[!visible || (visible[a] && visible[b]) ? 0 : 1];
      path.moveTo(...place_of(at_px[2 * a], at_px[2 * a + 1]));
      path.lineTo(...place_of(at_px[2 * b], at_px[2 * b + 1]));
    }
    return paths;
  }

  #draw_loupe(pen, [x, y]) {
    pen.save();
    const circle = new Path2D();
    circle.arc(x, y, kLoupeRadius, 0, 2 * Math.PI);
    pen.save();
    pen.clip(circle);
    pen.clearRect(0, 0, this.canvas.clientWidth, this.canvas.clientHeight);
    pen.translate(x, y);
    pen.scale(kLoupeFactor, kLoupeFactor);
    pen.translate(-x, -y);
    pen.imageSmoothingEnabled = false;
    this.#paint(pen);
    pen.restore();
    pen.strokeStyle = palette()("--ink");
    pen.lineWidth = 1.5;
    pen.stroke(circle);
    pen.restore();
  }

  /** Shows the match nearest to the spot, within `reach` px of the screen or the usual ones. */
  #choose_match(reach = kReach) {
    const { matches } = this.#options;
    const { at } = this.spot;
    if (!at || !this.#frame?.match_px || matches === "none") return;
    const { scale, left, top } = this.fit;
    const point_px = [(at[0] - left) / scale - 0.5, (at[1] - top) / scale - 0.5];
    const index = nearest_match(this.#frame, matches, point_px, reach / scale);
    if (index < 0) return this.patch.hide();
    this.patch.show(this.#frame, index, this.#texture, this.#camera);
  }
}
