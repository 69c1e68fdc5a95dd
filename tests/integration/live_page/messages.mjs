// SPDX-License-Identifier: Apache-2.0
// Messages of the protocol weft.live.1, as a run sends them.

const kMagic = 0x314c4657;

const padded = (bytes) => Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4)]);
const kTypes = {
  image: "jpeg",
  vertices_m: "f32",
  visible: "u8",
  match_px: "f32",
  match_uv: "f32",
  match_kept: "u8",
  match_score: "f32",
  truth_m: "f32",
  other_m: "f32",
};
const kHead = ["taken_s", "written", "matches"];

/** A frame; each of the parts image (Buffer) and those of numbers may be absent. */
export function frame_message({ frame, time_s = null, report = null, ...given }) {
  const parts = Object.entries(kTypes)
    .filter(([name]) => given[name])
    .map(([name, type]) => {
      const value = given[name];
      const bytes =
        type === "f32" ? Buffer.from(Float32Array.from(value).buffer) : Buffer.from(value);
      return { name, type, bytes };
    });
  const head = { frame, time_s, report };
  for (const name of kHead) if (given[name] !== undefined) head[name] = given[name];
  head.parts = parts.map(({ name, type, bytes }) => ({ name, type, bytes: bytes.length }));
  const text = Buffer.from(JSON.stringify(head));
  const json = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, " ")]);
  const lengths = Buffer.alloc(8);
  lengths.writeUInt32LE(kMagic, 0);
  lengths.writeUInt32LE(json.length, 4);
  return Buffer.concat([lengths, json, ...parts.map(({ bytes }) => padded(bytes))]);
}

const base64 = (numbers) => Buffer.from(numbers.buffer).toString("base64");

/** The first message, of a mesh {vertices_m, faces, uv} and its other entries. */
export function hello_message({ camera, mesh, texture, settings }) {
  return {
    type: "hello",
    weft: "0.1.0",
    camera,
    template: {
      vertices_m: base64(Float32Array.from(mesh.vertices_m)),
      faces: base64(Int32Array.from(mesh.faces)),
      uv: base64(Float32Array.from(mesh.uv)),
      texture,
    },
    settings,
  };
}

/** A flat surface of columns x rows vertices, in the plane z = 0 about the origin. */
export function sheet(columns, rows, width_m, height_m) {
  const vertices_m = [],
    uv = [],
    faces = [];
  for (let y = 0; y < rows; ++y) {
    for (let x = 0; x < columns; ++x) {
      const [u, v] = [x / (columns - 1), y / (rows - 1)];
      vertices_m.push((u - 0.5) * width_m, (v - 0.5) * height_m, 0);
      uv.push(u, v);
    }
  }
  for (let y = 0; y + 1 < rows; ++y) {
    for (let x = 0; x + 1 < columns; ++x) {
      const a = y * columns + x;
      faces.push(a, a + 1, a + columns, a + 1, a + columns + 1, a + columns);
    }
  }
  return { vertices_m, faces, uv };
}
