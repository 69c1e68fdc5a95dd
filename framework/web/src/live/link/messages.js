// SPDX-License-Identifier: Apache-2.0
// What the server sends, as numbers.
import { floats, indices } from "../../data.js";
import { edge_lengths, edges_of } from "../views/mesh.js";

const kMagic = 0x314c4657; // "WFL1"
const kHeadBytes = 8;
const kAlignment = 4;
const kMostFaces = 300000; // whose edges are drawn

function typed({ name, type, bytes }, buffer, at) {
  if (type !== "f32") return new Uint8Array(buffer, at, bytes);
  if (bytes % 4 !== 0) throw new Error(`its part '${name}' ends within a number`);
  return new Float32Array(buffer, at, bytes / 4);
}

/** A frame: {frame, time_s, report, ...} and its parts by name, as views of the buffer (image: bytes
    of a JPEG, vertices_m [3 V], visible [V], ...). Throws an Error that names the fault. */
export function decode_frame(buffer) {
  const view = new DataView(buffer);
  if (buffer.byteLength < kHeadBytes || view.getUint32(0, true) !== kMagic) {
    throw new Error("it does not begin like a frame");
  }
  const length = view.getUint32(4, true);
  let at = kHeadBytes + length;
  if (at > buffer.byteLength) throw new Error("it is cut off");
  const { parts, ...head } = JSON.parse(
    new TextDecoder().decode(new Uint8Array(buffer, kHeadBytes, length)),
  );
  const frame = { ...head };
  for (const part of parts) {
    if (at + part.bytes > buffer.byteLength) throw new Error(`its part '${part.name}' is cut off`);
    frame[part.name] = typed(part, buffer, at);
    at += Math.ceil(part.bytes / kAlignment) * kAlignment;
  }
  return frame;
}

/** The same with its image decoded as `picture`, an ImageBitmap to be closed, or null. */
export async function read_frame(buffer) {
  const frame = decode_frame(buffer);
  const blob = frame.image && new Blob([frame.image], { type: "image/jpeg" });
  frame.picture = blob ? await createImageBitmap(blob) : null;
  return frame;
}

/** The template of a `hello` with its edges and their lengths at rest; null without one. A huge mesh
    has no edges here. */
export function template_of({ template }) {
  if (!template) return null;
  const vertices_m = floats(template.vertices_m);
  const faces = indices(template.faces);
  const is_huge = faces.length > 3 * kMostFaces;
  const edges = is_huge ? new Uint32Array() : edges_of(faces);
  return {
    vertices_m,
    faces,
    edges,
    rest_m: edge_lengths(vertices_m, edges),
    uv: template.uv ? floats(template.uv) : null,
    texture: template.texture || null,
  };
}
