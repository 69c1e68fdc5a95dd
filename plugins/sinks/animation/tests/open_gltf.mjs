// SPDX-License-Identifier: Apache-2.0
// open_gltf.mjs WEB FILE TIME_S...: opens a .glb with programs that Weft did not write. Prints as
// JSON the messages of Khronos' validator, the names of the morph targets and, as three.js plays it,
// at each time the scale of the mesh and its vertices in the world (y up).
import { readFileSync } from "node:fs";
import path from "node:path";
import { pathToFileURL } from "node:url";

const [web, file, ...times] = process.argv.slice(2);
const load = (file) => import(pathToFileURL(path.join(web, "node_modules", file)).href);

const bytes = readFileSync(file);
const { default: validator } = await load("gltf-validator/index.js");
const { issues, info } = await validator.validateBytes(new Uint8Array(bytes));

globalThis.self = globalThis;
const three = await load("three/build/three.module.js");
const { GLTFLoader } = await load("three/examples/jsm/loaders/GLTFLoader.js");
const loader = new GLTFLoader();
// Node has no codec for images; the validator has read the texture.
loader.register(() => ({ name: "none", loadTexture: async () => new three.Texture() }));
const { scene, cameras, animations } = await loader.parseAsync(
  bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length),
  "",
);
const mesh = scene.getObjectByProperty("isMesh", true);
const mixer = new three.AnimationMixer(scene);
for (const clip of animations) mixer.clipAction(clip).play();
const shown = times.map((time) => {
  mixer.setTime(Number(time));
  scene.updateMatrixWorld(true);
  const point = new three.Vector3();
  const vertices = Array.from({ length: mesh.geometry.attributes.position.count }, (_, v) =>
    mesh.getVertexPosition(v, point).applyMatrix4(mesh.matrixWorld).toArray(),
  );
  return { scale: mesh.scale.x, vertices: vertices.flat() };
});
console.log(
  JSON.stringify({
    messages: issues.messages,
    textures: info.hasTextures,
    targets: Object.keys(mesh.morphTargetDictionary ?? {}),
    duration_s: animations[0]?.duration ?? 0,
    fov_degrees: cameras[0].fov,
    aspect: cameras[0].aspect,
    shown,
  }),
);
