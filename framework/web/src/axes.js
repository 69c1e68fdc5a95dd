// SPDX-License-Identifier: Apache-2.0
// The camera's axes at a corner of what is drawn, each as long as is written at it.
import {
  BufferAttribute,
  BufferGeometry,
  CanvasTexture,
  Group,
  LineBasicMaterial,
  LineSegments,
  SRGBColorSpace,
  Sprite,
  SpriteMaterial,
  Vector3,
} from "three";
import { round_number } from "./errors.js";

const kMmPerM = 1000;
const kShareOfBox = 0.4;
const kTextPx = 40;

/** A text that faces the viewer, `height` m high. */
function label(text, colour, height) {
  const canvas = document.createElement("canvas");
  const pen = canvas.getContext("2d");
  const font = `500 ${kTextPx}px system-ui, DejaVu Sans, sans-serif`;
  pen.font = font;
  canvas.width = Math.ceil(pen.measureText(text).width) + 8;
  canvas.height = kTextPx + 12;
  pen.font = font;
  pen.fillStyle = `#${colour.getHexString()}`;
  pen.textBaseline = "middle";
  pen.fillText(text, 4, canvas.height / 2);
  const map = new CanvasTexture(canvas);
  map.colorSpace = SRGBColorSpace;
  const sprite = new Sprite(new SpriteMaterial({ map, depthTest: false, transparent: true }));
  sprite.renderOrder = 1; // over what is transparent
  sprite.scale.set((height * canvas.width) / canvas.height, height, 1);
  return sprite;
}

/** Axes for a box [m] in the frame of WebGL (y up, z towards the viewer): x to the right, y down and
    z ahead, as the camera has them; that of y with its length, unless something else shows a scale. */
export function axes_of(box, colour, has_length) {
  const size = box.getSize(new Vector3());
  const extent = Math.max(size.x, size.y, size.z);
  const length_mm = round_number(kShareOfBox * extent * kMmPerM, true);
  const length = length_mm / kMmPerM;
  const corner = new Vector3(box.min.x, box.max.y, box.max.z);
  const ends = [
    ["x", new Vector3(length, 0, 0)],
    ["y", new Vector3(0, -length, 0)],
    ["z", new Vector3(0, 0, -length)],
  ];
  const group = new Group();
  const points = ends.flatMap(([, end]) => [corner, corner.clone().add(end)]);
  group.add(
    new LineSegments(
      new BufferGeometry().setAttribute(
        "position",
        new BufferAttribute(new Float32Array(points.flatMap((point) => point.toArray())), 3),
      ),
      new LineBasicMaterial({ color: colour }),
    ),
  );
  const height = 0.05 * extent;
  for (const [name, end] of ends) {
    const sprite = label(name === "y" && has_length ? `y, ${length_mm} mm` : name, colour, height);
    sprite.position.copy(corner).addScaledVector(end, 1.1);
    group.add(sprite);
  }
  return group;
}
