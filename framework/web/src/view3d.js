// SPDX-License-Identifier: Apache-2.0
// A canvas whose scene is turned with the mouse; in the frame of WebGL: y up, z towards the viewer.
import {
  AmbientLight,
  Color,
  DirectionalLight,
  PerspectiveCamera,
  Scene,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { axes_of } from "./axes.js";

const kOblique = new Vector3(0.45, 0.35, 1);

/** A colour of the page's style. */
export function colour_of(name) {
  const text = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  return new Color(text);
}

export class View3d {
  #axes = null;
  #axes_shown = true;

  #axes_have_length;

  /** Throws where the browser has no WebGL. */
  constructor(canvas, { axes_have_length = true } = {}) {
    this.canvas = canvas;
    this.#axes_have_length = axes_have_length;
    this.renderer = new WebGLRenderer({
      canvas,
      antialias: true,
      alpha: true,
      preserveDrawingBuffer: true,
    });
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(40, 1, 0.001, 100);
    this.controls = new OrbitControls(this.camera, canvas);
    const lamp = new DirectionalLight(0xffffff, 2);
    lamp.position.set(0.4, 0.8, 1);
    this.scene.add(new AmbientLight(0xffffff, 1.4), lamp);
    this.controls.addEventListener("change", () => this.render());
    new ResizeObserver(() => this.render()).observe(canvas);
  }

  /** Near enough for `box` [m] to fill the view, which looks against `direction`: by default as the
      real camera does, but turned a little. */
  look_at(box, direction = kOblique) {
    if (box.isEmpty()) return;
    if (this.#axes) this.scene.remove(this.#axes);
    this.#axes = axes_of(box, colour_of("--ink"), this.#axes_have_length);
    this.#axes.visible = this.#axes_shown;
    this.scene.add(this.#axes);
    const centre = box.getCenter(new Vector3());
    const radius = 0.5 * box.getSize(new Vector3()).length();
    const { fov, aspect } = this.camera;
    const distance = radius / Math.tan((fov * Math.PI) / 360) / Math.min(1, aspect);
    this.camera.position
      .copy(centre)
      .add(direction.clone().normalize().multiplyScalar(0.9 * distance));
    this.camera.near = 0.01 * radius;
    this.camera.far = 100 * radius;
    this.camera.updateProjectionMatrix();
    this.controls.target.copy(centre);
    this.controls.update();
    this.render();
  }

  show_axes(shown) {
    if (shown === this.#axes_shown) return;
    this.#axes_shown = shown;
    if (this.#axes) this.#axes.visible = shown;
    this.render();
  }

  /** Whether the processor draws in place of a graphics card. */
  get is_software() {
    const gl = this.renderer.getContext();
    const names = gl.getExtension("WEBGL_debug_renderer_info");
    const name = names ? gl.getParameter(names.UNMASKED_RENDERER_WEBGL) : "";
    return /swiftshader|llvmpipe|software|basic render/i.test(name);
  }

  render() {
    const { clientWidth, clientHeight } = this.canvas;
    if (clientWidth === 0) return; // it is not shown
    const size = this.renderer.getSize(new Vector2());
    if (size.x !== clientWidth || size.y !== clientHeight) {
      this.renderer.setSize(clientWidth, clientHeight, false);
      this.camera.aspect = clientWidth / Math.max(1, clientHeight);
      this.camera.updateProjectionMatrix();
    }
    this.renderer.render(this.scene, this.camera);
  }
}
