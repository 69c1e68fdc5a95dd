// SPDX-License-Identifier: Apache-2.0
// The surface of a recording as it moves, for Blender and other programs: glTF 2.0 with texture.
import {
  AnimationClip,
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
  Group,
  InterpolateDiscrete,
  Mesh,
  MeshBasicMaterial,
  NumberKeyframeTrack,
  SRGBColorSpace,
  TextureLoader,
} from "three";
import { GLTFExporter } from "three/examples/jsm/exporters/GLTFExporter.js";

// Each shape has a weight for each other one: more make the file large and viewers slow.
export const kMostShapes = 600;
const kName = "surface";

/** The shapes as a surface whose first shape is at rest and whose others are morph targets. */
async function surface_of(shapes, { faces, uv, texture }) {
  const [first, ...others] = shapes;
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(first.vertices_m, 3));
  geometry.setIndex(new BufferAttribute(faces, 1));
  if (uv) geometry.setAttribute("uv", new BufferAttribute(uv, 2));
  geometry.morphTargetsRelative = true;
  geometry.morphAttributes.position = others.map(({ frame, vertices_m }) => {
    const moved = new BufferAttribute(vertices_m.map((x, i) => x - first.vertices_m[i]), 3);
    moved.name = String(frame);
    return moved;
  });
  const material = new MeshBasicMaterial({ side: DoubleSide });
  if (texture && uv) {
    material.map = await new TextureLoader().loadAsync(texture);
    material.map.flipY = false; // uv begins at the top left
    material.map.colorSpace = SRGBColorSpace;
  }
  const surface = new Mesh(geometry, material);
  surface.name = kName;
  return surface;
}

/** Each shape from its time until that of the next one. */
function clip_of(shapes) {
  const count = shapes.length - 1;
  const weights = new Float32Array(shapes.length * count);
  for (let shape = 1; shape < shapes.length; ++shape) weights[shape * count + shape - 1] = 1;
  const times_s = shapes.map(({ time_s }) => time_s - shapes[0].time_s);
  const track = `${kName}.morphTargetInfluences`;
  return new AnimationClip("run", -1, [
    new NumberKeyframeTrack(track, times_s, weights, InterpolateDiscrete),
  ]);
}

/** Bytes of a .glb; null without two shapes. `shapes`: [{frame, time_s, vertices_m}] in the camera's
    frame (x right, y down, z ahead), ascending; of more than kMostShapes, the first ones. */
export async function animation_of(shapes, template) {
  if (!template || shapes.length < 2) return null;
  const some = shapes.slice(0, kMostShapes);
  const scene = new Group();
  scene.rotation.x = Math.PI; // OpenCV's axes to those of glTF
  scene.add(await surface_of(some, template));
  const options = { binary: true, animations: [clip_of(some)] };
  return new Uint8Array(await new GLTFExporter().parseAsync(scene, options));
}
