// SPDX-License-Identifier: Apache-2.0
// Opens a report in Chromium without a network, for tests that use it.
import assert from "node:assert/strict";
import { pathToFileURL } from "node:url";
import * as chromium from "../../support/chromium.mjs";

const [web, file, screenshots] = process.argv.slice(2);

/** Opens the page that the command line names, gives it to `use` and complains of what the browser
    complains of, of requests, and of a page too wide for a telephone. */
export async function use_page(use) {
  await chromium.use_chromium(web, /^(file|data|blob):/, async (page, complaints) => {
    await page.setViewport({ width: 1200, height: 900 });
    await page.goto(pathToFileURL(file).href);
    await page.waitForSelector("html[data-ready=true]");
    await use(page);
    await page.emulateMediaFeatures([]);
    await page.setViewport({ width: 400, height: 800 });
    const overflow = await chromium.overflow_of(page);
    assert.ok(overflow <= 0, `the page is ${overflow} px too wide for a telephone`);
    await shot(page, "narrow", true);
    assert.deepEqual(complaints, []);
  });
}

/** Marks of a figure that Vega has rendered: elements of one kind of mark. */
export const marks = (page, figure, kind) =>
  page.$$eval(`#${figure} svg .mark-${kind} path`, (all) => all.length);

/** The surface is completely inside each image of a worst frame: the image has marks, and none at
    an edge. */
export async function expect_whole_sheets(page) {
  const seen = await page.$$eval(".worst .view img", async (all) => {
    const inked = async (image) => {
      await image.decode();
      const [width, height] = [image.naturalWidth, image.naturalHeight];
      const canvas = Object.assign(document.createElement("canvas"), { width, height });
      const pen = canvas.getContext("2d", { willReadFrequently: true });
      pen.drawImage(image, 0, 0);
      const any = (...box) => pen.getImageData(...box).data.some((v, i) => i % 4 === 3 && v > 0);
      return {
        all: any(0, 0, width, height),
        left: any(0, 0, 4, height),
        right: any(width - 4, 0, 4, height),
        top: any(0, 0, width, 4),
        bottom: any(0, height - 4, width, 4),
      };
    };
    return Promise.all(all.map(inked));
  });
  for (const each of seen) {
    assert.deepEqual(each, { all: true, left: false, right: false, top: false, bottom: false });
  }
}

/** Keeps an image of the page for people, named after the script. */
export const shot = (page, name, fullPage = false) =>
  page.screenshot({ path: screenshot_file(name), fullPage });
export const screenshot_file = (name, type) => chromium.screenshot_file(screenshots, name, type);
