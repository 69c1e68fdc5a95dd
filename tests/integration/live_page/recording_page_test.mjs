// SPDX-License-Identifier: Apache-2.0
// recording_page_test.mjs WEB SCREENSHOTS: records a run that this test plays, in its live page.
import assert from "node:assert/strict";
import { use_live_page } from "./live_page.mjs";
import { bent, kVertices, report_of } from "./scene.mjs";
import { numpy_array, unzipped } from "./unzipped.mjs";

/** The glTF is valid, and has the shapes of these frames, each from its time on. */
async function check_animation(bytes, frames) {
  const { default: validator } = await import(`${process.argv[2]}/node_modules/gltf-validator/index.js`);
  const { issues } = await validator.validateBytes(new Uint8Array(bytes));
  assert.equal(issues.numErrors + issues.numWarnings, 0, JSON.stringify(issues.messages));
  const json = JSON.parse(String(bytes.subarray(20, 20 + bytes.readUInt32LE(12))));
  const binary = bytes.subarray(28 + bytes.readUInt32LE(12));
  const numbers_of = (index) => {
    const { bufferView, byteOffset = 0, count, type } = json.accessors[index];
    const begin = json.bufferViews[bufferView].byteOffset + byteOffset;
    const length = count * { SCALAR: 1, VEC3: 3 }[type];
    return Array.from({ length }, (_, i) => binary.readFloatLE(begin + 4 * i));
  };
  const [{ primitives, extras }] = json.meshes;
  assert.deepEqual(extras.targetNames, frames.slice(1).map(String));
  assert.equal(json.images.length, 1); // the texture
  const first = numbers_of(primitives[0].attributes.POSITION);
  primitives[0].targets.forEach(({ POSITION }, target) => {
    const moved = numbers_of(POSITION);
    const expected = Float32Array.from(bent(frames[target + 1]));
    expected.forEach((x, i) => assert.ok(Math.abs(first[i] + moved[i] - x) < 1e-6));
  });
  const [{ samplers }] = json.animations;
  const times_s = numbers_of(samplers[0].input);
  times_s.forEach((t, i) => assert.ok(Math.abs(t - (frames[i] - frames[0]) / 30) < 1e-6));
  assert.equal(samplers[0].interpolation, "STEP");
  assert.deepEqual(numbers_of(samplers[0].output), [0, 0, 1, 0, 0, 1]);
}

await use_live_page(async (live) => {
  const { page } = live;
  const is_disabled = () => page.$eval("#record", (button) => button.disabled);

  // The page saves all frames between two clicks, also those without a shape or without an image.
  await live.show(0);
  let downloads = await live.downloads();
  await page.click("#record");
  assert.equal(await live.text("#record"), "End recording");
  for (const frame of [1, 2, 4]) await live.show(frame);
  const report = report_of(5, { state: "none" });
  await live.show(5, { vertices_m: null, visible: null, image: null, report });
  await live.until_text("#recording-count", "4 frames, 0.");
  await live.shot("going_on");
  await page.click("#record");
  await live.until_text("#recorded", "Saved 4 of the frames 1 to 5");
  assert.equal(await live.text("#record"), "Record");
  assert.equal(await live.text("#recording-count"), "");
  const files = unzipped(await downloads.file("weft_000001-000005.zip"));
  downloads.remove();
  const images = Object.keys(files).filter((name) => name.startsWith("frames/"));
  assert.deepEqual(images, [1, 2, 4].map((frame) => `frames/00000${frame}.jpg`));
  for (const frame of [1, 2, 4]) {
    assert.deepEqual(files[`frames/00000${frame}.jpg`], live.picture(frame));
  }
  const lines = String(files["frames.jsonl"]).trimEnd().split("\n").map(JSON.parse);
  assert.deepEqual(lines[1], { ...report_of(2), time_s: 2 / 30 });
  assert.deepEqual(lines.map(({ frame }) => frame), [1, 2, 4, 5]);
  const { numbers } = numpy_array(files["vertices_m.npy"], Float32Array);
  assert.equal(numbers.length, 4 * 3 * kVertices);
  assert.deepEqual(numbers.slice(0, 3 * kVertices), [...Float32Array.from(bent(1))]);
  assert.ok(Number.isNaN(numbers.at(-1)));
  assert.equal(JSON.parse(files["camera.json"]).width, 640);
  assert.equal(JSON.parse(files["settings.json"]).pipeline, "pipelines/live.yaml");
  await check_animation(files["animation.glb"], [1, 2, 4]);

  // Two clicks without a frame between them save nothing.
  downloads = await live.downloads();
  await page.click("#record");
  await page.click("#record");
  await live.until_text("#recorded", "Nothing was saved");

  // When the run ends, the recorded part of it is saved; another run is recorded anew.
  await page.click("#record");
  await live.show(6);
  const { port } = live.run;
  await live.run.end();
  await live.until_text("#recorded", "Saved frame 6");
  await live.until_text("#recorded", "The run went away.");
  assert.equal(await is_disabled(), true);
  await downloads.file("weft_000006-000006.zip");
  downloads.remove();
  live.run = await live.start(port);
  await live.until_text("#connection", "Connected");
  await live.until(() => !document.querySelector("#record").disabled);
  await live.show(7);
  live.forgive_tries();
});
