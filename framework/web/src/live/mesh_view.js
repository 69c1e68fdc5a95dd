// SPDX-License-Identifier: Apache-2.0
// The mesh in 3D, in the camera's frame (x right, y down, z ahead), turned by mouse or keyboard.
import {
  Box3,
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  DynamicDrawUsage,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
  SRGBColorSpace,
  TextureLoader,
  Vector3,
} from "three";
import { colours_of } from "../errors.js";
import { View3d, colour_of } from "../view3d.js";

const kRoom = 0.5; // of the box of a shape, around it, in which it may move before the view follows
const kTurn = Math.PI / 24; // by a key
const kApproach = 0.87; // of the distance, by a key
const kOpacities = { predicted: 0.55, lost: 0.35 }; // of a shape that is older than its frame

const kKeys = {
  ArrowLeft: (controls) => controls.rotateLeft(-kTurn),
  ArrowRight: (controls) => controls.rotateLeft(kTurn),
  ArrowUp: (controls) => controls.rotateUp(-kTurn),
  ArrowDown: (controls) => controls.rotateUp(kTurn),
  "+": (controls) => controls.dollyIn(kApproach),
  "-": (controls) => controls.dollyOut(kApproach),
};

export class MeshView {
  #texture = null;
  #position = null;
  #colour = null;
  #box = null; // in which the shape may be without the view being moved
  #touched = false;

  /** Throws where the browser has no WebGL. */
  constructor(canvas) {
    this.canvas = canvas;
    this.view = new View3d(canvas);
    this.surface = new Mesh(
      new BufferGeometry(),
      new MeshLambertMaterial({
        side: DoubleSide,
        transparent: true,
        polygonOffset: true,
        polygonOffsetFactor: 1,
        polygonOffsetUnits: 1,
      }),
    );
    this.edges = new LineSegments(
      new BufferGeometry(),
      new LineBasicMaterial({ transparent: true, opacity: 0.25 }),
    );
    this.group = new Group();
    // OpenCV's axes to those of WebGL.
    this.group.rotation.x = Math.PI;
    for (const object of [this.surface, this.edges]) {
      object.frustumCulled = false; // its bounds change with each frame
      this.group.add(object);
    }
    this.group.visible = false;
    this.view.scene.add(this.group);
    this.view.controls.addEventListener("start", () => (this.#touched = true));
    canvas.addEventListener("keydown", (event) => this.#press(event));
    this.colour();
  }

  /** Vertices [3 V] m that are drawn now; none without a shape. */
  positions() {
    return this.group.visible ? [...this.#position.array] : [];
  }

  /** The template of a run, or null; the view starts anew. */
  begin(template) {
    this.surface.geometry.dispose();
    this.edges.geometry.dispose();
    this.#texture?.dispose();
    this.#texture = null;
    this.#position = null;
    this.group.visible = false;
    this.#touched = false;
    this.#box = null;
    if (template) this.#build(template);
    this.view.render();
  }

  #build({ vertices_m, faces, edges, uv, texture }) {
    const changing = () => {
      const attribute = new BufferAttribute(new Float32Array(vertices_m.length), 3);
      return attribute.setUsage(DynamicDrawUsage);
    };
    this.#position = changing();
    this.#colour = changing();
    const surface = new BufferGeometry();
    surface.setAttribute("position", this.#position);
    surface.setAttribute("color", this.#colour);
    surface.setIndex(new BufferAttribute(faces, 1));
    if (uv) surface.setAttribute("uv", new BufferAttribute(uv, 2));
    const lines = new BufferGeometry();
    lines.setAttribute("position", this.#position);
    lines.setIndex(new BufferAttribute(edges, 1));
    this.surface.geometry = surface;
    this.edges.geometry = lines;
    if (!texture || !uv) return;
    this.#texture = new TextureLoader().load(texture, () => this.view.render());
    this.#texture.flipY = false; // uv begins at the top left
    this.#texture.colorSpace = SRGBColorSpace;
  }

  /** A frame: {vertices_m, report}; with `shares` [V] each vertex has its colour of the ramp,
      without them the mesh has its texture. */
  show({ vertices_m, report }, shares) {
    const length = this.#position?.array.length ?? 0;
    this.group.visible = length > 0 && vertices_m?.length === length;
    if (this.group.visible) {
      this.#position.copyArray(vertices_m);
      this.#position.needsUpdate = true;
      this.surface.geometry.computeVertexNormals();
      this.#paint(shares ?? null);
      this.surface.material.opacity = kOpacities[report?.state] ?? 1;
      this.#follow();
    }
    this.view.render();
  }

  #paint(shares) {
    const { material } = this.surface;
    if (shares) {
      this.#colour.copyArray(colours_of(shares, 1));
      this.#colour.needsUpdate = true;
    }
    const map = shares ? null : this.#texture;
    material.needsUpdate = material.vertexColors !== Boolean(shares) || material.map !== map;
    material.vertexColors = Boolean(shares);
    material.map = map;
    material.color = shares || map ? new Color(0xffffff) : colour_of("--series-1");
  }

  #bounds() {
    const box = new Box3();
    const { array } = this.#position;
    for (let i = 0; i < array.length; i += 3) {
      box.expandByPoint(new Vector3(array[i], -array[i + 1], -array[i + 2]));
    }
    return box;
  }

  /** The view stays where it is until the shape leaves its surroundings, and for good once somebody
      has turned it. */
  #follow() {
    const box = this.#bounds();
    if (this.#box && (this.#touched || this.#box.containsBox(box))) return;
    this.#box = box.clone().expandByVector(box.getSize(new Vector3()).multiplyScalar(kRoom));
    this.view.look_at(box);
  }

  /** The view as it is before anybody turns it. */
  reset() {
    this.#touched = false;
    this.#box = null;
    if (this.group.visible) this.#follow();
  }

  /** After a change of theme. */
  colour() {
    this.edges.material.color = colour_of("--ink");
    if (this.#box && !this.#touched) this.reset();
    this.view.render();
  }

  #press(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "Home") {
      this.reset();
    } else {
      const act = kKeys[event.key];
      if (!act) return;
      this.#touched = true;
      act(this.view.controls);
    }
    event.preventDefault();
  }
}
