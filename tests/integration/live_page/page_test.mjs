// SPDX-License-Identifier: Apache-2.0
// page_test.mjs WEB SCREENSHOTS: looks at the live page of a run that this test plays.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { overflow_of } from "../../support/chromium.mjs";
import { expect_contrast } from "./contrast.mjs";
import { pause, use_live_page } from "./live_page.mjs";
import { bent, camera, report_of } from "./scene.mjs";

await use_live_page(async (live) => {
  const { page } = live;
  const mesh_pixels = () => page.$eval("#mesh", (canvas) => canvas.toDataURL());
  /** The colour of the canvas at an image point, px. */
  const image_pixel = (x_px, y_px) =>
    page.$eval(
      "#image",
      (canvas, at_px) => {
        const copy = new OffscreenCanvas(canvas.width, canvas.height);
        const pen = copy.getContext("2d", { willReadFrequently: true });
        pen.drawImage(canvas, 0, 0);
        const ratio = canvas.width / canvas.clientWidth;
        const at = window.weft_live.image.place_of()(...at_px).map((one) => Math.round(ratio * one));
        return [...pen.getImageData(...at, 1, 1).data];
      },
      [x_px, y_px],
    );

  // Frames run: the image changes, the mesh has the vertices that were sent, words report it.
  await live.show(0);
  const corner = await image_pixel(12, 12);
  await live.show(1);
  assert.notDeepEqual(await image_pixel(12, 12), corner, "the image did not change");
  const positions = await page.evaluate(() => window.weft_live.mesh.positions());
  assert.deepEqual(positions, [...Float32Array.from(bent(1))]);
  assert.equal(await live.text("#state .title"), "Estimated");
  assert.equal(await live.text("#state .text"), "97\u00a0% sure");
  await live.until_text("#moment-words", "frame 1 · 0.03 s");
  assert.equal(await live.text("#pipeline"), "pipelines/live.yaml");
  await live.until_text("#announcement", "Estimated");

  // The mesh lies over the image where the camera sees it, and nowhere else.
  await live.show(2, { image: null });
  const [x, y, z] = bent(2).slice(0, 3);
  const seen = [(camera.fx * x) / z + camera.cx, (camera.fy * y) / z + camera.cy];
  const inked = async (u, v) => (await image_pixel(u, v))[3] > 0;
  assert.equal(await inked(...seen), true);
  assert.equal(await inked(seen[0] - 12, seen[1] - 12), false);
  await page.focus("#opacity");
  await page.keyboard.press("Home");
  assert.equal(await inked(...seen), false);
  await page.keyboard.press("End");
  assert.equal(await inked(...seen), true);

  // Mouse and keyboard turn the mesh.
  await live.show(3);
  const turned_by = async (act) => {
    const before = await mesh_pixels();
    await act();
    assert.notEqual(await mesh_pixels(), before, "the mesh did not turn");
  };
  const box = await (await page.$("#mesh")).boundingBox();
  await turned_by(async () => {
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2 + 60, box.y + box.height / 2 + 20, { steps: 4 });
    await page.mouse.up();
  });
  await page.focus("#mesh");
  for (const key of ["ArrowLeft", "ArrowUp", "+", "-", "Home"]) {
    await turned_by(() => page.keyboard.press(key));
  }

  // Each colouring draws the mesh in another way and has its legend.
  await page.select("#colouring", "texture");
  const drawings = new Set([await mesh_pixels()]);
  for (const [name, legend] of [
    ["confidence", "now 97\u00a0%"],
    ["std", "2 mm and more"],
    ["visibility", "hidden"],
    ["strain", "longer by"],
  ]) {
    await page.select("#colouring", name);
    assert.ok((await live.text("#legend")).includes(legend), await live.text("#legend"));
    drawings.add(await mesh_pixels());
  }
  assert.equal(drawings.size, 5);
  await page.select("#colouring", "std");

  // The strips show what frames come to, and all of it is to be read in light and in dark.
  for (let frame = 4; frame < 24; ++frame) await live.show(frame);
  await live.until_text("[data-strip=kept] output", "of 312");
  await live.shot("light");
  await expect_contrast(page);
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "dark" }]);
  await page.select("#colouring", "texture");
  await live.shot("dark");
  await expect_contrast(page);

  // The state's words change with it, and a warning of the run stays until it is closed.
  const reason = "4 matches of 312 agree";
  const stages = report_of(24).stages.map((stage) =>
    stage.stage === "filters" ? { ...stage, status: "no_result", reason } : stage,
  );
  const warnings = ["setup: the focal length seems to be 0.83 times the one given"];
  const lost = { state: "lost", age: 31, confidence: 0, stages, warnings };
  await live.show(24, { report: report_of(24, lost) });
  assert.equal(await live.text("#state .title"), "Lost");
  const words = `the shape is the one of 31 frames ago; filters: ${reason}`;
  assert.equal(await live.text("#state .text"), words);
  await live.until_text("#announcement", reason);
  await live.until_text("#notices", "0.83 times");
  await live.shot("lost");
  await page.click("#notices button");
  assert.equal(await live.text("#notices"), "");

  // A frame without a shape, and one that cannot be read, are not the end.
  const report = report_of(25, { state: "none" });
  await live.show(25, { vertices_m: null, visible: null, report });
  assert.deepEqual(await page.evaluate(() => window.weft_live.mesh.positions()), []);
  live.run.show_bytes(Buffer.from("nonsense"));
  await live.until_text("#notices", "could not be shown");
  await live.show(26);
  await page.click("#notices button");

  // An image of both views.
  const downloads = await live.downloads();
  await page.click("#screenshot");
  const saved = readFileSync(await downloads.file("weft_000026.png"));
  assert.deepEqual([...saved.subarray(1, 4)], [...Buffer.from("PNG")]);
  downloads.remove();

  // Each thing to use is reached by the tabulator, and is seen to be.
  await page.emulateMediaFeatures([]);
  const usable = await page.$$eval("button, input, select, summary, [tabindex='0']", (all) => {
    const seen = (one) => one.checkVisibility({ visibilityProperty: true });
    return all.filter((one) => seen(one) && !one.matches(":disabled")).length;
  });
  await page.evaluate(() => document.activeElement.blur());
  const reached = new Set();
  for (let i = 0; i < usable + 3; ++i) {
    await page.keyboard.press("Tab");
    const focused = await page.evaluate(() => {
      const one = document.activeElement;
      if (one === document.body) return null;
      one.dataset.reached ??= String(Math.random());
      return { key: one.dataset.reached, outline: getComputedStyle(one).outlineStyle };
    });
    if (!focused) continue;
    reached.add(focused.key);
    assert.notEqual(focused.outline, "none");
  }
  assert.equal(reached.size, usable);

  // As wide as a telephone.
  await page.setViewport({ width: 390, height: 844 });
  await live.show(27);
  assert.ok((await overflow_of(page)) <= 0, `${await overflow_of(page)} px too wide`);
  await live.shot("narrow");
  await page.setViewport({ width: 1400, height: 900 });
  assert.ok((await overflow_of(page)) <= 0);

  // The run has no frames: the page shows only the server's message about it.
  live.run.say({ type: "still", still: true });
  await live.until_text("#connection", "the run waits for its source");
  live.run.pause(true, 28);
  await live.until(() => document.querySelector("#connection").textContent === "Connected");
  live.run.pause(false, 28);
  await live.until_text("#connection", "the run waits for its source");
  live.run.say({ type: "still", still: false });
  await live.until(() => document.querySelector("#connection").textContent === "Connected");
  // It goes on, and nothing arrives here.
  await live.until_text("#connection", "this browser or the network is slow");

  // A pause ends with the browser that requested it.
  live.run.pause(true, 28);
  await live.until_text("#outcome", "Paused in another browser");
  live.run.pause(false, 29, { left: true });
  await live.until_text("#outcome", "the browser that paused it left");
  live.run.pause(true, 29);
  await live.until_text("#outcome", "Paused in another browser");
  live.run.break_connections();
  await live.until_text("#connection", "The connection was lost");
  await live.until_text("#connection", "Connected");
  live.run.pause(false, 29, { left: true });
  await live.until_text("#outcome", "the connection was lost during a pause");
  live.forgive_tries();

  // Single samples at large distances are visible in the strips.
  for (const frame of [40, 41, 42]) await live.show(frame, { taken_s: 8 * (frame - 36) });
  await pause(300); // the strips are drawn some times a second
  await live.show(43, { taken_s: 60 });
  await live.shot("single");
  const blue = (canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let count = 0;
    for (let at = 0; at < data.length; at += 4) {
      if (data[at + 3] > 200 && data[at + 2] > data[at] + 60) ++count;
    }
    return count;
  };
  const count = await page.$eval("[data-strip=kept] canvas", blue);
  assert.ok(count >= 4 * 5, `${count} pixels of four points`);

  // The run ends, and another one begins at the same place.
  const { port } = live.run;
  const usable_commands = () =>
    page.$$eval("#play:enabled, #forward:enabled, #stop:enabled", (all) => all.length);
  assert.equal(await usable_commands(), 3);
  await live.run.end();
  await live.until_text("#connection", "The run has ended.");
  assert.doesNotMatch(await live.text("#connection"), /Trying again/);
  assert.equal(await usable_commands(), 0);
  await live.shot("ended");
  live.run = await live.start(port, { settings: null });
  await live.until_text("#connection", "Connected");
  await live.until_text("#stages", "The run reports no settings.");
  assert.equal(await usable_commands(), 3);

  // After a stop it has ended, however the connection goes.
  await page.click("#stop");
  await page.click("#stopping button[value=stop]");
  await live.until_text("#outcome", "The run stops.");
  live.run.break_connections();
  await live.until_text("#connection", "The run has ended.");
  live.forgive_tries();
});
