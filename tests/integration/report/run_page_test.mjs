// SPDX-License-Identifier: Apache-2.0
// run_page_test.mjs WEB PAGE SCREENSHOTS: uses the report of a run of eight frames.
import assert from "node:assert/strict";
import { expect_whole_sheets, marks, shot, use_page } from "./browser.mjs";

await use_page(async (page) => {
  // A point for each frame, one of them without an error; an area for each stage.
  assert.equal(await marks(page, "figure-run", "symbol"), 8);
  assert.equal(await marks(page, "figure-run-times", "area"), 2);

  // Six worst frames, each with its image of the video, its estimate and the truth.
  assert.equal(await page.$$eval(".worst figure > img", (all) => all.length), 6);
  assert.equal(await page.$$eval(".worst .view img", (all) => all.length), 2 * 6);

  await expect_whole_sheets(page);

  // The worst, the median and the best frame against the flat print, two with an unwarped image.
  const prints = await page.$$eval(".print figure", (all) =>
    all.map((figure) => [figure.dataset.frame, figure.querySelectorAll("svg").length]),
  );
  assert.deepEqual(prints, [
    ["6", 2],
    ["3", 2],
    ["0", 1],
  ]);
  // Each figure has the texture, though the page contains it once, and its arrows are on it.
  const sizes = await page.$$eval(".print figure svg:first-of-type > :first-child", (all) =>
    all.map((one) => one.getBoundingClientRect().width),
  );
  assert.equal(sizes.filter((width) => width > 100).length, 5);
  const stroke = await page.$eval(".print .arrow.far:not(.halo)", (one) => getComputedStyle(one).stroke);
  assert.equal(stroke, "rgb(210, 59, 44)");

  // A click on a frame of the figure shows it in 3D.
  const points = await page.$$("#figure-run svg .mark-symbol path");
  await points[5].click();
  const readout = await page.$eval("#viewer .readout", (one) => one.textContent);
  assert.match(readout, /^frame 5 · estimated · mean error 5\.00 mm$/);
  // The seven frames with a shape as glTF: the first at rest, the others as morph targets.
  const names = await page.evaluate(async () => {
    let saved = null;
    URL.createObjectURL = (blob) => ((saved = blob), "#");
    document.querySelector("#viewer .save-gltf").click();
    while (saved === null) await new Promise((done) => setTimeout(done, 20));
    const bytes = await saved.arrayBuffer();
    const length = new DataView(bytes).getUint32(12, true);
    const { meshes } = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 20, length)));
    return meshes[0].extras.targetNames;
  });
  assert.deepEqual(names, ["1", "2", "3", "4", "5", "6"]);

  const scale = await page.$eval("#viewer .error-scale", (one) => one.textContent);
  assert.equal(scale, "010 mm and more");
  await shot(page, "light", true);
});
