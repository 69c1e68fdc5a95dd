// SPDX-License-Identifier: Apache-2.0
// recording_test.mjs WEB: what is in the files that the live page saves.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { test } from "node:test";
import { hello_message, sheet } from "./messages.mjs";
import { module_loader } from "./modules.mjs";
import { numpy_array, unzipped } from "./unzipped.mjs";

const load = module_loader(process.argv[2]);
const { crc32 } = await load("saving/zip");
const { Recording } = await load("saving/recording");
const { template_of } = await load("link/messages");
const { recorded_words } = await load("words");

const kCamera = { fx: 500, fy: 400, cx: 319.5, cy: 239.5, width_px: 640, height_px: 480 };
const kMesh = sheet(3, 2, 0.2, 0.1);
const kVertices = 6;
const kTemplate = template_of(
  hello_message({ camera: null, mesh: kMesh, texture: "", settings: null }),
);

/** The files of what a recording saves. */
async function saved_by(recording) {
  const folder = mkdtempSync(path.join(tmpdir(), "weft-recording-"));
  const file = path.join(folder, "saved.zip");
  writeFileSync(file, Buffer.from(await recording.zip().arrayBuffer()));
  const files = unzipped(file);
  rmSync(folder, { recursive: true });
  return files;
}

const frame_of = (frame, changes = {}) => ({
  frame,
  time_s: frame / 4,
  report: { frame, state: "estimated", confidence: 0.9 },
  image: Uint8Array.from([255, 216, frame]),
  picture: { width: 640, height: 480 },
  vertices_m: Float32Array.from({ length: 3 * kVertices }, (_, i) => frame + i / 8),
  visible: Uint8Array.from({ length: kVertices }, (_, v) => v % 2),
  ...changes,
});

test("checksums are those of ZIP", () => {
  const bytes = (text) => new TextEncoder().encode(text);
  assert.equal(crc32(bytes("123456789")), 0xcbf43926); // the value by which CRC-32 is known
  assert.equal(crc32(bytes("6789"), crc32(bytes("12345"))), 0xcbf43926);
  assert.equal(crc32(bytes("")), 0);
});

test("a recording holds what came, frame by frame", async () => {
  const settings = { pipeline: "ü.yaml", stages: [] };
  const recording = new Recording({ camera: kCamera, template: kTemplate, settings });
  recording.push(frame_of(3));
  recording.push(frame_of(5));
  const { bytes, ...summary } = recording.summary;
  assert.deepEqual(summary, { first: 3, last: 5, frames: 2 });
  assert.ok(bytes > 2 * (3 + 12 * kVertices + kVertices));
  assert.equal(recording.file_name, "weft_000003-000005.zip");
  const files = await saved_by(recording);
  assert.deepEqual(Object.keys(files), [
    "frames.jsonl",
    "settings.json",
    "camera.json",
    "rest_m.npy",
    "faces.npy",
    "vertices_m.npy",
    "visible.npy",
    "frames/000003.jpg",
    "frames/000005.jpg",
  ]);
  assert.deepEqual([...files["frames/000005.jpg"]], [255, 216, 5]);
  assert.deepEqual(JSON.parse(files["settings.json"]), settings);
  const lines = String(files["frames.jsonl"]).trimEnd().split("\n").map(JSON.parse);
  const line = { frame: 5, state: "estimated", confidence: 0.9, time_s: 1.25 };
  assert.deepEqual(lines, [{ ...line, frame: 3, time_s: 0.75 }, line]);
  assert.deepEqual(JSON.parse(files["camera.json"]), {
    ...{ fx: 500, fy: 400, cx: 319.5, cy: 239.5, width: 640, height: 480, distortion: null },
  });

  const vertices = numpy_array(files["vertices_m.npy"], Float32Array);
  assert.equal(vertices.magic, "\x93NUMPY\x01\0");
  assert.equal(vertices.start % 64, 0);
  const shape = `(2, ${kVertices}, 3)`;
  assert.equal(vertices.head, `{'descr': '<f4', 'fortran_order': False, 'shape': ${shape}, }`);
  const expected = [3, 5].flatMap((frame) => [...frame_of(frame).vertices_m]);
  assert.deepEqual(vertices.numbers, expected);
  const visible = numpy_array(files["visible.npy"], Uint8Array);
  assert.match(visible.head, /'\|u1'.*\(2, 6\)/);
  assert.deepEqual(visible.numbers, [0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1]);
  const faces = numpy_array(files["faces.npy"], Uint32Array);
  assert.deepEqual(faces.numbers, kMesh.faces);
  const rest_m = numpy_array(files["rest_m.npy"], Float32Array);
  assert.deepEqual(rest_m.numbers, [...Float32Array.from(kMesh.vertices_m)]);
});

test("what a frame does not have is marked in the arrays", async () => {
  const recording = new Recording({ camera: null, template: kTemplate, settings: null });
  const bare = { image: null, picture: null, vertices_m: undefined, visible: undefined };
  recording.push(frame_of(1, { ...bare, report: null, time_s: null }));
  recording.push(frame_of(2, { visible: undefined }));
  const files = await saved_by(recording);
  const names = Object.keys(files);
  assert.deepEqual(names.filter((name) => name.startsWith("frames/")), ["frames/000002.jpg"]);
  assert.ok(!names.includes("camera.json") && !names.includes("settings.json"));
  const [first] = String(files["frames.jsonl"]).split("\n");
  assert.deepEqual(JSON.parse(first), { frame: 1, time_s: null });
  const { numbers } = numpy_array(files["vertices_m.npy"], Float32Array);
  assert.ok(numbers.slice(0, 3 * kVertices).every(Number.isNaN));
  assert.deepEqual(numbers.slice(3 * kVertices), [...frame_of(2).vertices_m]);
  const visible = numpy_array(files["visible.npy"], Uint8Array);
  assert.deepEqual([...new Set(visible.numbers)], [255]);
});

test("the camera is that of the images as they were sent", async () => {
  const recording = new Recording({ camera: kCamera, template: null, settings: null });
  recording.push(frame_of(0, { picture: { width: 320, height: 240 } }));
  const files = await saved_by(recording);
  // The middle of the image stays in its middle, since pixel centres are whole numbers.
  assert.deepEqual(JSON.parse(files["camera.json"]), {
    ...{ fx: 250, fy: 200, cx: 159.5, cy: 119.5, width: 320, height: 240, distortion: null },
  });
  assert.equal(files["vertices_m.npy"], undefined);
});

test("a recording is full before a browser or a ZIP is", () => {
  const recording = new Recording({ camera: null, template: null, settings: null });
  const image = { byteLength: 4e8, length: 0, [Symbol.iterator]: () => [].values() };
  for (let frame = 0; frame < 2; ++frame) {
    assert.equal(recording.is_full, false);
    recording.push(frame_of(frame, { image }));
  }
  recording.push(frame_of(2, { image }));
  assert.equal(recording.is_full, true);
});

test("words tell which frames were saved, and that some are not there", () => {
  const saved = (first, last, frames) => recorded_words({ first, last, frames, bytes: 21.34e6 });
  assert.equal(saved(312, 411, 100), "Saved 100 frames, 312 to 411, 21.3 MB.");
  assert.equal(saved(312, 411, 90), "Saved 90 of the frames 312 to 411, 21.3 MB.");
  assert.equal(saved(312, 312, 1), "Saved frame 312, 21.3 MB.");
  assert.match(saved(undefined, undefined, 0), /^Nothing was saved/);
});
