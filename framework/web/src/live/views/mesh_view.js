// SPDX-License-Identifier: Apache-2.0
// The mesh in 3D, in the camera's frame (x right, y down, z ahead), turned by mouse or keyboard.
import {
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
import { Surroundings } from "./surroundings.js";
import { Trail } from "./trail.js";
import { Viewpoint } from "./viewpoint.js";

const kDrag = 4; // px, below which a press is a click
const kOpacities = { predicted: 0.55, lost: 0.35 }; // of a shape that is older than its frame

const lines = (opacity) =>
  new LineSegments(new BufferGeometry(), new LineBasicMaterial({ transparent: true, opacity }));

export class MeshView {
  #texture = null;
  #position = null;
  #colour = null;
  #measured = null;
  #other = null; // positions of the mesh to compare with
  #picked;

  /** `picked(vertex)` is called after a click on the mesh. Throws where the browser has no WebGL. */
  constructor(canvas, scale_bar, picked) {
    this.canvas = canvas;
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
    this.viewpoint = new Viewpoint(this.view, this.surroundings, scale_bar);
    this.#listen(canvas);
    this.colour();
  }

  #listen(canvas) {
    let pressed_at = null;
    canvas.addEventListener("pointerdown", ({ clientX, clientY }) => (pressed_at = [clientX, clientY]));
    canvas.addEventListener("pointerup", (event) => {
      const [x, y] = pressed_at ?? [NaN, NaN];
      if (Math.hypot(event.clientX - x, event.clientY - y) < kDrag) this.#pick(event);
    });
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
    this.viewpoint.begin();
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
      this.viewpoint.follow(this.#position.array);
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

  /** After a change of theme. */
  colour() {
    this.edges.material.color = colour_of("--ink");
    this.other.material.color = colour_of("--series-2");
    this.truth.material.color = colour_of("--series-3");
    this.trail.colour();
    this.viewpoint.recolour();
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
}
