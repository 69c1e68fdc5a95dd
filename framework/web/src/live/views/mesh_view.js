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
  Points,
  PointsMaterial,
  Raycaster,
  SRGBColorSpace,
  TextureLoader,
  Vector2,
  Vector3,
} from "three";
import { colours_of } from "../../errors.js";
import { View3d, colour_of } from "../../view3d.js";
import { hatch, measured_of } from "./hatch.js";
import { write_scale_bar } from "./scale_bar.js";
import { Surroundings } from "./surroundings.js";
import { Trail } from "./trail.js";

const kRoom = 0.35; // of the box of a shape, around it, in which it may move before the view follows
const kMargin = 0.08; // of the box of a shape, around it in a view that fits
const kTurn = Math.PI / 24; // by a key
const kApproach = 0.87; // of the distance, by a key
const kNearest = 0.05; // of the size of the mesh
const kFarthest = 40;
const kDrag = 4; // px, below which a press is a click
const kOpacities = { predicted: 0.55, lost: 0.35 }; // of a shape that is older than its frame

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

const lines = (opacity) =>
  new LineSegments(new BufferGeometry(), new LineBasicMaterial({ transparent: true, opacity }));

export class MeshView {
  #texture = null;
  #position = null;
  #colour = null;
  #measured = null;
  #other = null; // positions of the mesh to compare with
  #box = null; // in which the shape may be without the view being moved
  #touched = false;
  #is_gliding = false;
  #picked;

  /** `picked(vertex)` is called after a click on the mesh. Throws where the browser has no WebGL. */
  constructor(canvas, scale_bar, picked) {
    this.canvas = canvas;
    this.scale_bar = scale_bar;
    this.#picked = picked;
    this.view = new View3d(canvas, { axes_have_length: false });
    const material = new MeshLambertMaterial({
      side: DoubleSide,
      transparent: true,
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
    });
    hatch(material, this.view.renderer.getPixelRatio());
    this.surface = new Mesh(new BufferGeometry(), material);
    this.edges = lines(0.25);
    this.other = lines(0.9);
    this.truth = new Points(new BufferGeometry(), new PointsMaterial({ size: 3, sizeAttenuation: false }));
    this.trail = new Trail();
    this.surroundings = new Surroundings();
    this.group = new Group();
    // OpenCV's axes to those of WebGL.
    this.group.rotation.x = Math.PI;
    for (const object of [this.surface, this.edges, this.other, this.truth]) {
      object.frustumCulled = false; // its bounds change with each frame
      this.group.add(object);
    }
    this.group.add(this.trail);
    this.group.visible = false;
    this.view.scene.add(this.group, this.surroundings);
    this.#control(canvas);
    this.colour();
  }

  #control(canvas) {
    const { controls } = this.view;
    controls.enableDamping = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    controls.dampingFactor = 0.12;
    controls.addEventListener("start", () => (this.#touched = true));
    controls.addEventListener("change", () => {
      this.#write_scale();
      this.#glide();
    });
    canvas.addEventListener("keydown", (event) => this.#press(event));
    new ResizeObserver(() => this.#resize()).observe(canvas);
    let pressed_at = null;
    canvas.addEventListener("pointerdown", ({ clientX, clientY }) => (pressed_at = [clientX, clientY]));
    canvas.addEventListener("pointerup", (event) => {
      const [x, y] = pressed_at ?? [NaN, NaN];
      if (Math.hypot(event.clientX - x, event.clientY - y) < kDrag) this.#pick(event);
    });
  }

  #resize() {
    this.view.render();
    this.#write_scale();
    if (this.#box && !this.#touched) this.fit();
  }

  #write_scale() {
    const { camera, controls } = this.view;
    write_scale_bar(this.scale_bar, camera, controls.target, this.canvas.clientHeight);
  }

  /** Lets a turn end slowly. */
  #glide() {
    if (this.#is_gliding) return;
    this.#is_gliding = true;
    const go_on = () => {
      this.#is_gliding = this.view.controls.update();
      if (this.#is_gliding) requestAnimationFrame(go_on);
    };
    requestAnimationFrame(go_on);
  }

  /** Vertices [3 V] m that are drawn now; none without a shape. */
  positions() {
    return this.group.visible ? [...this.#position.array] : [];
  }

  /** Camera and template of a run, or null; the view starts anew. */
  begin(camera, template) {
    for (const { geometry } of [this.surface, this.edges, this.other]) geometry.dispose();
    this.#texture?.dispose();
    this.#texture = null;
    this.#position = null;
    this.group.visible = false;
    this.other.visible = false;
    this.truth.visible = false;
    this.trail.pick(null);
    this.surroundings.begin(camera);
    this.#touched = false;
    this.#box = null;
    if (template) this.#build(template);
    this.view.render();
  }

  #build({ vertices_m, faces, edges, uv, texture }) {
    const count = vertices_m.length / 3;
    const changing = (size) =>
      new BufferAttribute(new Float32Array(size * count), size).setUsage(DynamicDrawUsage);
    this.#position = changing(3);
    this.#other = changing(3);
    this.#colour = changing(3);
    this.#measured = changing(1);
    const surface = new BufferGeometry();
    surface.setAttribute("position", this.#position);
    surface.setAttribute("color", this.#colour);
    surface.setAttribute("measured", this.#measured);
    surface.setIndex(new BufferAttribute(faces, 1));
    if (uv) surface.setAttribute("uv", new BufferAttribute(uv, 2));
    this.surface.geometry = surface;
    const edged = (position) =>
      new BufferGeometry().setAttribute("position", position).setIndex(new BufferAttribute(edges, 1));
    this.edges.geometry = edged(this.#position);
    this.other.geometry = edged(this.#other);
    if (!texture || !uv) return;
    this.#texture = new TextureLoader().load(texture, () => this.view.render());
    this.#texture.flipY = false; // uv begins at the top left
    this.#texture.colorSpace = SRGBColorSpace;
  }

  /** A frame: {vertices_m, visible, report}; with `shares` [V] each vertex has its colour of the
      ramp, without them the mesh has its texture. Says whether a part is hatched. */
  show(frame, shares) {
    const length = this.#position?.array.length ?? 0;
    this.group.visible = length > 0 && frame.vertices_m?.length === length;
    let is_hatched = false;
    if (this.group.visible) {
      this.#position.copyArray(frame.vertices_m);
      this.#position.needsUpdate = true;
      const measured = measured_of(frame, length / 3);
      is_hatched = measured.includes(0);
      this.#measured.copyArray(measured);
      this.#measured.needsUpdate = true;
      this.surface.geometry.computeVertexNormals();
      this.#paint(shares ?? null);
      this.surface.material.opacity = kOpacities[frame.report?.state] ?? 1;
      this.#follow();
    }
    this.view.render();
    return is_hatched;
  }

  /** Another mesh [3 V] m as lines, and true points [3 T] m; each may be null. For the next show(). */
  compare(vertices_m, truth_m) {
    this.other.visible = Boolean(vertices_m) && vertices_m.length === this.#other?.array.length;
    if (this.other.visible) {
      this.#other.copyArray(vertices_m);
      this.#other.needsUpdate = true;
    }
    this.truth.visible = Boolean(truth_m);
    if (!truth_m) return;
    this.truth.geometry.dispose();
    this.truth.geometry = new BufferGeometry();
    this.truth.geometry.setAttribute("position", new BufferAttribute(truth_m, 3));
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

  /** The view stays where it is until the shape leaves its surroundings; once it was turned by hand,
      until no vertex is visible. */
  #follow() {
    if (this.#touched && this.#box) {
      if (!this.#sees_mesh()) this.#look(this.#direction());
      return;
    }
    if (!this.#box?.containsBox(this.#bounds())) this.#look();
  }

  #direction() {
    return this.view.camera.position.clone().sub(this.view.controls.target);
  }

  #sees_mesh() {
    const { array } = this.#position;
    const { camera } = this.view;
    camera.updateMatrixWorld();
    const point = new Vector3();
    for (let i = 0; i < array.length; i += 3) {
      point.set(array[i], -array[i + 1], -array[i + 2]).project(camera);
      if (Math.max(Math.abs(point.x), Math.abs(point.y), Math.abs(point.z)) < 1) return true;
    }
    return false;
  }

  #look(direction) {
    const { controls } = this.view;
    const box = this.#bounds();
    const size_m = box.getSize(new Vector3()).length();
    this.#box = box.clone().expandByVector(box.getSize(new Vector3()).multiplyScalar(kRoom));
    this.#stop();
    controls.minDistance = kNearest * size_m;
    controls.maxDistance = kFarthest * size_m;
    this.surroundings.build(box);
    const margin = box.getSize(new Vector3()).multiplyScalar(kMargin);
    this.view.look_at(box.clone().expandByVector(margin), direction);
  }

  /** Ends a turn that still goes on. */
  #stop() {
    const { controls } = this.view;
    const glides = controls.enableDamping;
    controls.enableDamping = false;
    controls.update();
    controls.enableDamping = glides;
  }

  /** Fits the mesh into the view: as before it was turned, or from "front", "side" or "top". */
  fit(name) {
    this.#touched = name in kDirections;
    this.#box = null;
    if (this.group.visible) this.#look(kDirections[name]);
  }

  /** After a change of theme. */
  colour() {
    this.edges.material.color = colour_of("--ink");
    this.other.material.color = colour_of("--series-2");
    this.truth.material.color = colour_of("--series-3");
    this.trail.colour();
    if (this.#box) this.#look(this.#direction());
    this.view.render();
  }

  #pick({ offsetX, offsetY }) {
    if (!this.group.visible) return;
    const { clientWidth, clientHeight } = this.canvas;
    const place = new Vector2((2 * offsetX) / clientWidth - 1, 1 - (2 * offsetY) / clientHeight);
    const ray = new Raycaster();
    ray.setFromCamera(place, this.view.camera);
    this.surface.geometry.computeBoundingSphere();
    const [hit] = ray.intersectObject(this.surface);
    if (!hit) return this.#picked(null);
    const point = this.group.worldToLocal(hit.point);
    const distance = (v) => new Vector3().fromBufferAttribute(this.#position, v).distanceTo(point);
    const { a, b, c } = hit.face;
    this.#picked([a, b, c].reduce((best, v) => (distance(v) < distance(best) ? v : best)));
  }

  #press(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "Home") {
      this.fit();
    } else {
      const act = kKeys[event.key];
      if (!act) return;
      this.#touched = true;
      act(this.view.controls);
    }
    event.preventDefault();
  }
}
