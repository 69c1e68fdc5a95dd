// SPDX-License-Identifier: Apache-2.0
// recording_page_test.mjs WEB SCREENSHOTS: records a run that this test plays, in its live page.
import assert from "node:assert/strict";
import { use_live_page } from "./live_page.mjs";
import { bent, kVertices, report_of } from "./scene.mjs";
import { numpy_array, unzipped } from "./unzipped.mjs";

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
