// SPDX-License-Identifier: Apache-2.0
// The frames that this page was shown while somebody recorded, as files for other programs.
import { StoredFile, zip } from "./zip.js";

// A browser holds them, and a ZIP holds 65534 files.
const kMostBytes = 1e9;
const kMostFrames = 50000;
const kDigits = 6;
const kUntold = 255; // in place of 0 and 1, where nothing is said of a vertex

const bytes_of = (array) => new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
export const text_file = (name, text) => new StoredFile(name).add(new TextEncoder().encode(text));
const numbered = (frame) => String(frame).padStart(kDigits, "0");

/** A file of NumPy (format 1.0): arrays one behind another as the rows of one with that shape. */
function npy_file(name, type, shape, arrays) {
  const words = `{'descr': '${type}', 'fortran_order': False, 'shape': (${shape.join(", ")}), }`;
  const before = 10; // magic, version and the length of what follows
  const length = Math.ceil((before + words.length + 1) / 64) * 64 - before;
  const text = `\x93NUMPY\x01\0${String.fromCharCode(length & 255, length >> 8)}`;
  const head = `${text}${words.padEnd(length - 1)}\n`;
  const file = new StoredFile(name).add(Uint8Array.from(head, (one) => one.charCodeAt(0)));
  for (const array of arrays) file.add(bytes_of(array));
  return file;
}

/** The camera of images that were made smaller to be sent; pixel centres are whole numbers. */
export function camera_of_picture({ fx, fy, cx, cy, width_px, height_px }, picture) {
  const { width, height } = picture ?? { width: width_px, height: height_px };
  const x = width / width_px;
  const y = height / height_px;
  const centre = { cx: x * (cx + 0.5) - 0.5, cy: y * (cy + 0.5) - 0.5 };
  return { fx: x * fx, fy: y * fy, ...centre, width, height, distortion: null };
}

export class Recording {
  #scene;
  #frames = []; // {frame, time_s, line, vertices_m, visible}
  #images = [];
  #picture = null; // {width, height} of the images
  #bytes = 0;

  /** What holds for all frames: {camera, template, settings}, each may be null. */
  constructor(scene) {
    this.#scene = scene;
  }

  /** {first, last, frames, bytes}; the numbers are absent before the first frame. */
  get summary() {
    const [first, last] = [this.#frames[0]?.frame, this.#frames.at(-1)?.frame];
    return { first, last, frames: this.#frames.length, bytes: this.#bytes };
  }

  get is_full() {
    return this.#bytes >= kMostBytes || this.#frames.length >= kMostFrames;
  }

  get file_name() {
    const { first, last } = this.summary;
    return `weft_${numbered(first)}-${numbered(last)}.zip`;
  }

  /** A frame: {frame, time_s, report, image, picture, vertices_m, visible}, of which all but the
      first may be absent. */
  push({ frame, time_s = null, report, image, picture, vertices_m, visible }) {
    const line = `${JSON.stringify({ ...report, frame, time_s })}\n`;
    // Copies, since the arrays are views of whole messages.
    const copies = { vertices_m: vertices_m?.slice(), visible: visible?.slice() };
    this.#frames.push({ frame, time_s, line, ...copies });
    if (image) {
      const file = new StoredFile(`frames/${numbered(frame)}.jpg`).add(image, new Blob([image]));
      this.#images.push(file);
      this.#picture ??= { width: picture.width, height: picture.height };
    }
    this.#bytes += line.length;
    for (const part of [image, vertices_m, visible]) this.#bytes += part?.byteLength ?? 0;
  }

  /** {template, shapes}: the frames with a shape, with a time each: 1/30 s apart if none is known. */
  get surface() {
    const { template } = this.#scene;
    const values = template?.vertices_m.length;
    const shapes = this.#frames
      .filter(({ vertices_m }) => vertices_m?.length === values && vertices_m.every(Number.isFinite))
      .map(({ frame, time_s, vertices_m }, i) => ({ frame, time_s: time_s ?? i / 30, vertices_m }));
    return { template, shapes };
  }

  /** All of it as one Blob, with these files beside it. */
  zip(others = []) {
    const { camera, settings } = this.#scene;
    const lines = this.#frames.map(({ line }) => line).join("");
    const files = [text_file("frames.jsonl", lines)];
    if (settings) files.push(text_file("settings.json", `${JSON.stringify(settings, null, 1)}\n`));
    if (camera) {
      const pinhole = camera_of_picture(camera, this.#picture);
      files.push(text_file("camera.json", `${JSON.stringify(pinhole, null, 2)}\n`));
    }
    return zip([...files, ...this.#mesh_files(), ...others, ...this.#images]);
  }

  #mesh_files() {
    const { template } = this.#scene;
    if (!template) return [];
    const { vertices_m, faces } = template;
    const count = vertices_m.length / 3;
    const frames = this.#frames.length;
    const rows = (name, length, absent) =>
      this.#frames.map((each) => (each[name]?.length === length ? each[name] : absent));
    const none = new Float32Array(3 * count).fill(NaN);
    const untold = new Uint8Array(count).fill(kUntold);
    const shapes = rows("vertices_m", 3 * count, none);
    const seen = rows("visible", count, untold);
    return [
      npy_file("rest_m.npy", "<f4", [count, 3], [vertices_m]),
      npy_file("faces.npy", "<u4", [faces.length / 3, 3], [faces]),
      npy_file("vertices_m.npy", "<f4", [frames, count, 3], shapes),
      npy_file("visible.npy", "|u1", [frames, count], seen),
    ];
  }
}
