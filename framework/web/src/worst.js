// SPDX-License-Identifier: Apache-2.0
// Pictures of the worst frames: the estimate coloured by its error, and the truth, both as the
// camera sees them.
import {
  AmbientLight,
  DirectionalLight,
  PerspectiveCamera,
  Scene,
  WebGLRenderer,
} from "three";
import { element } from "./data.js";
import { kRampStyle } from "./errors.js";
import { Drawing, decoded } from "./viewer.js";

const kWidth = 420;
const kHeight = 340;
const kMargin = 1.12;

/** The real camera's picture, cut to all points that are before it, with a margin. */
function camera_for({ vertices, truth }) {
  const x = [],
    y = [],
    z = [];
  for (const points of [vertices, truth]) {
    for (let i = 0; i < points.length; i += 3) {
      if (!(points[i + 2] > 0)) continue;
      x.push(points[i] / points[i + 2]);
      y.push(-points[i + 1] / points[i + 2]);
      z.push(points[i + 2]);
    }
  }
  if (z.length === 0) return null;
  const least = (values) => values.reduce((a, b) => Math.min(a, b));
  const most = (values) => values.reduce((a, b) => Math.max(a, b));
  const centre_x = 0.5 * (least(x) + most(x)),
    centre_y = 0.5 * (least(y) + most(y));
  const half_y =
    0.5 * kMargin * Math.max(most(y) - least(y), ((most(x) - least(x)) * kHeight) / kWidth, 1e-6);
  const half_x = (half_y * kWidth) / kHeight;
  const near = 0.5 * least(z);
  const camera = new PerspectiveCamera();
  camera.projectionMatrix.makePerspective(
    (centre_x - half_x) * near,
    (centre_x + half_x) * near,
    (centre_y + half_y) * near,
    (centre_y - half_y) * near,
    near,
    2 * most(z),
  );
  camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert();
  return camera;
}

function picture(renderer, scene, camera, title) {
  renderer.render(scene, camera);
  const image = element("img", { alt: title, src: renderer.domElement.toDataURL() });
  return element("div", { className: "view" }, image, element("span", { textContent: title }));
}

/** Adds to each figure in `.worst` what the page knows of its frame: `find(figure)` gives the cell,
    decoded, and the frame. */
function add_views(find) {
  const figures = [...document.querySelectorAll(".worst figure")];
  if (figures.length === 0) return;
  const renderer = new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
  renderer.setPixelRatio(2);
  renderer.setSize(kWidth, kHeight, false);
  const drawing = new Drawing();
  drawing.errors.visible = false;
  drawing.surface.material.opacity = 1;
  drawing.edges.material.opacity = 0.25;
  const lamp = new DirectionalLight(0xffffff, 1.2);
  lamp.position.set(0.3, 0.5, 1);
  const scene = new Scene();
  scene.add(drawing.group, new AmbientLight(0xffffff, 2.2), lamp);
  for (const figure of figures) {
    for (const old of figure.querySelectorAll(".view")) old.remove();
    const { cell, frame } = find(figure);
    const camera = frame && camera_for(frame);
    if (!camera) continue;
    drawing.show(cell, frame);
    drawing.colour();
    const caption = figure.querySelector("figcaption");
    const has_truth = frame.truth.length > 0;
    drawing.truth.visible = false;
    drawing.surface.visible = true;
    if (frame.vertices.length) {
      const title = has_truth ? "estimate, by its error" : "estimate";
      caption.before(picture(renderer, scene, camera, title));
    }
    if (!has_truth) continue;
    drawing.truth.visible = true;
    drawing.surface.visible = false;
    caption.before(picture(renderer, scene, camera, "truth, and the estimate's edges"));
    if (figure.querySelector(".error-scale")) continue;
    caption.before(
      element(
        "div",
        { className: "error-scale" },
        element("span", { textContent: "0" }),
        element("span", { className: "ramp", style: `background: ${kRampStyle}` }),
        element("span", { textContent: `${cell.scale_mm} mm and more` }),
      ),
    );
  }
  renderer.dispose();
  renderer.forceContextLoss();
}

/** Draws them now, and anew in another theme. */
export function draw_worst(data) {
  const cells = (data.run ? data.cells : data.worst ?? []).map(decoded);
  const find = ({ dataset }) => {
    if (!data.run) {
      const cell = cells[Number(dataset.worst)];
      return { cell, frame: cell?.frames[0] };
    }
    const number = Number(dataset.frame);
    return { cell: cells[0], frame: cells[0]?.frames.find(({ frame }) => frame === number) };
  };
  try {
    add_views(find);
  } catch (error) {
    return; // a browser without WebGL: the pictures of the video are there all the same
  }
  document.documentElement.addEventListener("themechange", () => add_views(find));
}
