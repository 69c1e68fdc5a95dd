// SPDX-License-Identifier: Apache-2.0
// What is around the mesh: a grid below it, and the frustum of the camera at the origin; in the frame
// of WebGL (y up, z towards the viewer).
import {
  BufferAttribute,
  BufferGeometry,
  GridHelper,
  Group,
  LineBasicMaterial,
  LineSegments,
  Vector3,
} from "three";
import { round_number } from "../../errors.js";
import { colour_of } from "../../view3d.js";

const kCells = 12;
const kCellsOfBox = 5;
const kBelow = 0.15; // of the box's height, below it
const kBody = 0.12; // of the distance to the mesh: the drawn body of the camera

export class Surroundings extends Group {
  #camera = null;

  /** The camera of a run, or null. */
  begin(camera) {
    this.#camera = camera;
    this.clear();
  }

  /** Draws all of it for a box [m] of the mesh; the grid's cells have a round size, m. */
  build(box) {
    for (const { geometry, material } of this.children) {
      geometry.dispose();
      material.dispose();
    }
    this.clear();
    const size = box.getSize(new Vector3());
    const centre = box.getCenter(new Vector3());
    const cell_m = round_number(Math.max(size.x, size.z, 0.3 * size.y) / kCellsOfBox);
    const colour = colour_of("--rule-strong");
    const grid = new GridHelper(kCells * cell_m, kCells, colour, colour);
    grid.material.transparent = true;
    grid.material.opacity = 0.35;
    const snap = (value) => Math.round(value / cell_m) * cell_m;
    grid.position.set(snap(centre.x), box.min.y - kBelow * size.y, snap(centre.z));
    this.add(grid);
    if (this.#camera) this.#add_frustum(this.#camera, -centre.z);
  }

  #add_frustum({ fx, fy, cx, cy, width_px, height_px }, depth_m) {
    const corner = (x_px, y_px, z_m) => [((x_px - cx) / fx) * z_m, (-(y_px - cy) / fy) * z_m, -z_m];
    const corners = (z_m) =>
      [
        [0, 0],
        [width_px, 0],
        [width_px, height_px],
        [0, height_px],
      ].map(([x_px, y_px]) => corner(x_px - 0.5, y_px - 0.5, z_m));
    const [near, far] = [corners(kBody * depth_m), corners(depth_m)];
    const around = (ring) => ring.flatMap((each, i) => [each, ring[(i + 1) % 4]]);
    const rays = near.flatMap((each) => [[0, 0, 0], each]);
    this.#add_lines([...rays, ...around(near)], "--ink", 0.9);
    this.#add_lines([...near.flatMap((each, i) => [each, far[i]]), ...around(far)], "--muted", 0.35);
  }

  #add_lines(points, colour, opacity) {
    const position = new BufferAttribute(new Float32Array(points.flat()), 3);
    const material = new LineBasicMaterial({ color: colour_of(colour), transparent: true, opacity });
    const geometry = new BufferGeometry().setAttribute("position", position);
    this.add(new LineSegments(geometry, material));
  }
}
