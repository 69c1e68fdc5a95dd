// SPDX-License-Identifier: Apache-2.0
// The estimate against the truth, frame by frame, in the camera's frame (x right, y down, z ahead).
import {
  Box3,
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
  Points,
  PointsMaterial,
  Vector3,
  WireframeGeometry,
} from "three";
import { animation_of } from "./animation.js";
import { floats, indices, shown } from "./data.js";
import { colours_of, kRampStyle, scale_of, vertex_errors } from "./errors.js";
import { save_file } from "./files.js";
import { View3d, colour_of } from "./view3d.js";

const kPlayMs = 100;

/** What is drawn: the estimate as a surface with its edges, the truth as points or as edges, and a
    line from each true point to its place on the estimate. */
export class Drawing {
  constructor() {
    this.group = new Group();
    // OpenCV's axes to those of WebGL: y up, z towards the viewer.
    this.group.rotation.x = Math.PI;
    this.surface = new Mesh(
      new BufferGeometry(),
      new MeshLambertMaterial({
        side: DoubleSide,
        transparent: true,
        opacity: 0.82,
        polygonOffset: true,
        polygonOffsetFactor: 1,
        polygonOffsetUnits: 1,
      }),
    );
    this.edges = new LineSegments(
      new BufferGeometry(),
      new LineBasicMaterial({ transparent: true, opacity: 0.4 }),
    );
    this.truth = new Points(
      new BufferGeometry(),
      new PointsMaterial({ sizeAttenuation: false, size: 4 }),
    );
    this.errors = new LineSegments(new BufferGeometry(), new LineBasicMaterial());
    this.group.add(this.surface, this.edges, this.truth, this.errors);
    this.enlarged = 1;
    this.by_error = true;
    this.colour();
  }

  colour() {
    const { material } = this.surface;
    material.color = material.vertexColors ? new Color(0xffffff) : colour_of("--series-1");
    this.edges.material.color = colour_of("--ink");
    this.truth.material.color = colour_of("--series-2");
    this.errors.material.color = colour_of("--series-2");
  }

  /** Without a shape only the truth is seen. */
  show(cell, frame) {
    const geometry = new BufferGeometry();
    if (frame.vertices.length) {
      geometry.setAttribute("position", new BufferAttribute(frame.vertices, 3));
      geometry.setIndex(new BufferAttribute(cell.faces, 1));
      geometry.computeVertexNormals();
    }
    this.#colour_by_error(geometry, cell, frame);
    this.#replace(this.surface, geometry);
    this.#replace(
      this.edges,
      frame.vertices.length ? new WireframeGeometry(geometry) : new BufferGeometry(),
    );
    this.#replace(this.truth, points_geometry(frame.truth));
    this.#replace(this.errors, points_geometry(segments(frame, this.enlarged)));
  }

  #colour_by_error(geometry, cell, frame) {
    const errors = this.by_error && cell.scale_mm !== null ? vertex_errors(frame) : null;
    if (errors) {
      geometry.setAttribute("color", new BufferAttribute(colours_of(errors, cell.scale_mm), 3));
    }
    const { material } = this.surface;
    material.needsUpdate = material.vertexColors !== Boolean(errors);
    material.vertexColors = Boolean(errors);
    this.colour();
  }

  #replace(object, geometry) {
    object.geometry.dispose();
    object.geometry = geometry;
  }
}

function points_geometry(positions) {
  return new BufferGeometry().setAttribute("position", new BufferAttribute(positions, 3));
}

/** From each true point towards its place on the estimate, where it has one. */
function segments({ truth, placed }, enlarged) {
  const ends = [];
  for (let i = 0; i < placed.length; i += 3) {
    if (Number.isNaN(placed[i])) continue;
    for (let axis = i; axis < i + 3; ++axis) ends.push(truth[axis]);
    for (let axis = i; axis < i + 3; ++axis) {
      ends.push(truth[axis] + enlarged * (placed[axis] - truth[axis]));
    }
  }
  return new Float32Array(ends);
}

/** A cell with numbers for its base64, and the end of the scale of its errors, mm. */
export function decoded(cell) {
  const frames = cell.frames.map((frame) => ({
    ...frame,
    vertices: floats(frame.vertices),
    truth: floats(frame.truth),
    placed: floats(frame.placed),
  }));
  return { ...cell, faces: indices(cell.faces), frames, scale_mm: scale_of(frames) };
}

class Viewer {
  #cell;
  #index = 0;
  #timer = null;

  constructor(root, cells) {
    this.root = root;
    this.cells = cells;
    this.view = new View3d(root.querySelector("canvas"));
    this.drawing = new Drawing();
    this.view.scene.add(this.drawing.group);
    this.#listen();
    this.choose(0);
  }

  /** Vertices [V,3] m of the estimate that is drawn now, one after the other. */
  positions() {
    return [...(this.drawing.surface.geometry.getAttribute("position")?.array ?? [])];
  }

  choose(index) {
    this.#cell = decoded(this.cells[index]);
    this.slider.max = this.#cell.frames.length - 1;
    this.#show_scale();
    this.show(Number(this.slider.max) < this.#index ? 0 : this.#index);
    this.look_from_camera();
    this.root.querySelector(".command").textContent = this.#cell.command;
  }

  #show_scale() {
    const { scale_mm } = this.#cell;
    const scale = this.root.querySelector(".error-scale");
    scale.hidden = scale_mm === null;
    scale.querySelector(".ramp").style.background = kRampStyle;
    scale.querySelector(".high").textContent = `${scale_mm} mm and more`;
  }

  /** The frame of that number, or the nearest one that the page has. */
  show_frame(number) {
    const distances = this.#cell.frames.map(({ frame }) => Math.abs(frame - number));
    this.show(distances.indexOf(Math.min(...distances)));
    this.root.scrollIntoView({ behavior: "smooth", block: "nearest" });
  }

  show(index) {
    this.#index = index;
    const frame = this.#cell.frames[index];
    this.slider.value = index;
    this.root.querySelector(".readout").textContent =
      `frame ${frame.frame} · ${frame.state}` +
      (frame.truth.length ? ` · mean error ${shown(frame.mean_mm ?? NaN)} mm` : "");
    this.drawing.show(this.#cell, frame);
    this.view.render();
  }

  /** So that all frames of the cell lie in the view. */
  look_from_camera() {
    const box = new Box3();
    for (const frame of this.#cell.frames) {
      for (const points of [frame.vertices, frame.truth]) {
        for (let i = 0; i < points.length; i += 3) {
          box.expandByPoint(new Vector3(points[i], -points[i + 1], -points[i + 2]));
        }
      }
    }
    this.view.look_at(box);
  }

  toggle_play() {
    if (this.#timer) {
      clearInterval(this.#timer);
      this.#timer = null;
    } else {
      this.#timer = setInterval(
        () => this.show((this.#index + 1) % this.#cell.frames.length),
        kPlayMs,
      );
    }
    this.root.querySelector(".play").textContent = this.#timer ? "Pause" : "Play";
  }

  /** The frames of the page that have a shape, at the pace at which they are played here. */
  async save_animation() {
    const shapes = this.#cell.frames
      .filter(({ vertices }) => vertices.length > 0)
      .map(({ frame, vertices }, i) => ({ frame, time_s: (i * kPlayMs) / 1000, vertices_m: vertices }));
    const bytes = await animation_of(shapes, this.#cell);
    const readout = this.root.querySelector(".readout");
    if (bytes) save_file(new Blob([bytes], { type: "model/gltf-binary" }), "shapes.glb");
    else readout.textContent = "An animation needs two frames with a shape.";
  }

  #listen() {
    this.slider = this.root.querySelector("input[type=range]");
    this.slider.addEventListener("input", () => this.show(Number(this.slider.value)));
    this.root
      .querySelector("select")
      .addEventListener("change", (event) => this.choose(event.target.selectedIndex));
    this.root.querySelector(".enlarged").addEventListener("change", (event) => {
      this.drawing.enlarged = Number(event.target.value);
      this.show(this.#index);
    });
    this.root.querySelector(".play").addEventListener("click", () => this.toggle_play());
    this.root.querySelector(".reset").addEventListener("click", () => this.look_from_camera());
    this.root.querySelector(".save-gltf").addEventListener("click", () => this.save_animation());
    this.root.querySelector(".axes").addEventListener("change", ({ target }) => {
      this.view.show_axes(target.checked);
    });
    this.root.querySelector(".by-error").addEventListener("change", ({ target }) => {
      this.drawing.by_error = target.checked;
      this.show(this.#index);
    });
    for (const box of this.root.querySelectorAll("input[type=checkbox][value]:not([value=''])")) {
      box.addEventListener("change", () => {
        for (const part of box.value.split(" ")) this.drawing[part].visible = box.checked;
        this.view.render();
      });
    }
    document.documentElement.addEventListener("themechange", () => {
      this.drawing.colour();
      this.look_from_camera();
    });
  }
}

/** Starts the view where the page has one; says why where the browser cannot draw it. */
export function start_viewer(data) {
  const root = document.getElementById("viewer");
  if (!root || data.cells.length === 0) return null;
  const choice = root.querySelector("select");
  for (const { name } of data.cells) choice.append(new Option(name));
  choice.closest("label").hidden = data.cells.length < 2;
  try {
    const viewer = new Viewer(root, data.cells);
    root.classList.add("started");
    return viewer;
  } catch (error) {
    root.querySelector(".readout").textContent = `This browser draws no 3D view: ${error.message}`;
    return null;
  }
}
