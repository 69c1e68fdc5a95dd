// SPDX-License-Identifier: Apache-2.0
// page_test.mjs WEB PAGE SCREENSHOTS: moves corners in a browser.
import assert from "node:assert/strict";
import { pathToFileURL } from "node:url";
import * as chromium from "../../support/chromium.mjs";
import { expect_contrast } from "../live_page/contrast.mjs";

const [web, file, screenshots] = process.argv.slice(2);

await chromium.use_chromium(web, /^(file|data):/, async (page, complaints) => {
  const shot = (name) =>
    page.screenshot({ path: chromium.screenshot_file(screenshots, name), fullPage: true });
  const ring = (k) => page.$(`.ring:nth-of-type(${k + 1})`);
  /** The corners that the page reports, as the command reads them. */
  const corners = async () => {
    const text = await page.$eval("#option", (one) => one.value);
    const [, list] = text.match(/^--corners "([^"]*)"$/);
    const numbers = list.split(/[ ,]/).map(Number);
    assert.equal(numbers.length, 8);
    return [0, 1, 2, 3].map((k) => numbers.slice(2 * k, 2 * k + 2));
  };
  const close = (a, b, tolerance) =>
    assert.ok(Math.hypot(a[0] - b[0], a[1] - b[1]) <= tolerance, `${a} is not ${b}`);

  await page.setViewport({ width: 1300, height: 900 });
  await page.goto(pathToFileURL(file).href);
  await page.waitForSelector("html[data-ready=true]");
  const first = await corners();
  const scale = await page.$eval("#image", (image) => image.clientWidth / 1280);

  // Rings stand over their corners.
  const image = await (await page.$("#image")).boundingBox();
  const middle = async (k) => {
    const box = await (await ring(k)).boundingBox();
    return [box.x + box.width / 2, box.y + box.height / 2];
  };
  for (let k = 0; k < 4; ++k) {
    const seen = first[k].map((px, axis) => [image.x, image.y][axis] + scale * (px + 0.5));
    close(await middle(k), seen, 0.6);
  }

  // The keyboard moves one by a pixel, or by ten.
  await (await ring(0)).focus();
  assert.equal(await page.$eval("#loupe", (one) => one.hidden), false);
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowUp");
  await page.keyboard.down("Shift");
  await page.keyboard.press("ArrowDown");
  await page.keyboard.up("Shift");
  close((await corners())[0], [first[0][0] + 1, first[0][1] + 9], 0.01);

  // The mouse drags one, and it does not jump to where it is held.
  const [x, y] = (await middle(2)).map(Math.round);
  await page.mouse.move(x + 5, y - 4);
  await page.mouse.down();
  await page.mouse.move(x - 35, y - 24, { steps: 4 });
  const loupe = await page.$eval("#loupe", (one) => ({ ...one.dataset, hidden: one.hidden }));
  assert.deepEqual(loupe, { column: "left", row: "top", hidden: false });
  await shot("dragged");
  await page.mouse.up();
  close((await corners())[2], [first[2][0] - 40 / scale, first[2][1] - 20 / scale], 0.2);
  await page.mouse.move(x, y);
  close((await corners())[2], [first[2][0] - 40 / scale, first[2][1] - 20 / scale], 0.2);

  // Numbers are typed; beyond the photograph they end at its border.
  const inputs = await page.$$("#places input");
  assert.equal(inputs.length, 8);
  await inputs[2].click({ clickCount: 3 });
  await inputs[2].type("99999");
  await page.keyboard.press("Tab");
  assert.equal((await corners())[1][0], 1279.5);
  assert.equal(await page.$eval("#fault", (one) => one.hidden), true);
  await inputs[2].click({ clickCount: 3 });
  await inputs[2].type("5");
  await page.keyboard.press("Tab");
  assert.ok((await page.$eval("#fault", (one) => one.textContent)).length > 0);
  assert.equal(await page.$eval("#fault", (one) => one.hidden), false);

  // A button copies the text beside it.
  await page.click("[data-copies=option]");
  await page.waitForFunction(() => document.querySelector("#outcome").textContent !== "");

  // All is to be read in light and in dark, and reached by the tabulator.
  await shot("light");
  await expect_contrast(page);
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "dark" }]);
  await shot("dark");
  await expect_contrast(page);
  const usable = await page.$$eval("button, input, textarea", (all) => all.length);
  await page.evaluate(() => document.activeElement.blur());
  const reached = new Set();
  for (let i = 0; i < usable + 3; ++i) {
    await page.keyboard.press("Tab");
    const key = await page.evaluate(() => {
      const one = document.activeElement;
      return one === document.body ? null : (one.dataset.reached ??= String(Math.random()));
    });
    if (key) reached.add(key);
  }
  assert.equal(reached.size, usable);

  // As wide as a telephone, with rings at the borders.
  await page.emulateMediaFeatures([]);
  await page.setViewport({ width: 390, height: 844 });
  for (const [place, value] of ["-9", "-9", "9999", "-9", "9999", "9999", "-9", "9999"].entries()) {
    await inputs[place].click({ clickCount: 3 });
    await inputs[place].type(value);
  }
  await page.keyboard.press("Tab");
  assert.deepEqual(await corners(), [
    [-0.5, -0.5],
    [1279.5, -0.5],
    [1279.5, 959.5],
    [-0.5, 959.5],
  ]);
  const overflow = await chromium.overflow_of(page);
  assert.ok(overflow <= 0, `${overflow} px too wide`);
  await shot("narrow");
  assert.deepEqual(complaints, []);
});
