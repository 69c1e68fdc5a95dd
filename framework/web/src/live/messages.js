// SPDX-License-Identifier: Apache-2.0
// What the server sends, as numbers.
import { floats, indices } from "../data.js";
import { edge_lengths, edges_of } from "./mesh.js";

const kMagic = 0x314c4657; // "WFL1"
const kHeadBytes = 8;
const kAlignment = 4;

function typed(name, type, bytes) {
  if (type === "f32") {
    if (bytes.byteLength % 4 !== 0) throw new Error(`its part '${name}' ends within a number`);
    return new Float32Array(bytes);
  }
  return new Uint8Array(bytes);
}

/** A frame: {frame, time_s, report} and its parts by name (image: bytes of a JPEG, vertices_m
    [3 V], visible [V]). Throws an Error that says what is wrong with it. */
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
  for (const { name, type, bytes } of parts) {
    if (at + bytes > buffer.byteLength) throw new Error(`its part '${name}' is cut off`);
    frame[name] = typed(name, type, buffer.slice(at, at + bytes));
    at += Math.ceil(bytes / kAlignment) * kAlignment;
  }
  return frame;
}

/** The template of a `hello` with its edges and their lengths at rest; null without one. */
export function template_of({ template }) {
  if (!template) return null;
  const vertices_m = floats(template.vertices_m);
  const faces = indices(template.faces);
  const edges = edges_of(faces);
  return {
    vertices_m,
    faces,
    edges,
    rest_m: edge_lengths(vertices_m, edges),
    uv: template.uv ? floats(template.uv) : null,
    texture: template.texture || null,
  };
}
