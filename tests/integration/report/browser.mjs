// SPDX-License-Identifier: Apache-2.0
// Opens a report in Chromium without a network, for tests that use it.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import path from "node:path";
import { pathToFileURL } from "node:url";

const [web, file, screenshots] = process.argv.slice(2);
const PATIENCE_MS = 180000; // other tests may have the processor

/** Opens the page that the command line names, gives it to `use` and complains of what the browser
    complains of, of requests, and of a page too wide for a telephone. */
export async function use_page(use) {
  const puppeteer = createRequire(path.join(web, "package.json"))("puppeteer-core");
  const profile = mkdtempSync(path.join(tmpdir(), "weft-chromium-"));
  const browser = await puppeteer.launch({
    executablePath: "/usr/bin/chromium",
    headless: true,
    timeout: PATIENCE_MS,
    protocolTimeout: PATIENCE_MS,
    userDataDir: profile,
    args: [
      "--no-sandbox",
      "--disable-quic",
      "--no-first-run",
      "--disable-background-networking",
      "--disable-component-update",
      "--disable-sync",
      "--disable-gpu",
      "--enable-unsafe-swiftshader",
    ],
  });
  try {
    const page = await browser.newPage();
    const complaints = [];
    page.on("console", (message) => {
      // The drivers of WebGL warn of what this test itself does when it reads pixels.
      if (
        ["error", "warn"].includes(message.type()) &&
        !message.text().includes("GL Driver Message")
      ) {
        complaints.push(message.text());
      }
    });
    page.on("pageerror", (error) => complaints.push(String(error)));
    page.on("request", (request) => {
      if (!/^(file|data|blob):/.test(request.url())) complaints.push(`asks for ${request.url()}`);
    });
    await page.setViewport({ width: 1200, height: 900 });
    page.setDefaultTimeout(PATIENCE_MS);
    await page.goto(pathToFileURL(file).href);
    await page.waitForSelector("html[data-ready=true]", { timeout: PATIENCE_MS });
    await use(page);
    await page.emulateMediaFeatures([]);
    await page.setViewport({ width: 400, height: 800 });
    const overflow = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    assert.ok(overflow <= 0, `the page is ${overflow} px too wide for a telephone`);
    await shot(page, "narrow", true);
    assert.deepEqual(complaints, []);
  } finally {
    await browser.close();
    rmSync(profile, { recursive: true, force: true });
  }
}

/** Marks of a figure that Vega has drawn: elements of one kind of mark. */
export const marks = (page, figure, kind) =>
  page.$$eval(`#${figure} svg .mark-${kind} path`, (all) => all.length);

/** In each picture of a worst frame the sheet lies within: something is drawn, and nothing at an
    edge. */
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

/** Keeps a picture of the page for people, named after the script. */
export const shot = (page, name, fullPage = false) =>
  page.screenshot({ path: screenshot_file(name), fullPage });
export const screenshot_file = (name, type = "png") =>
  path.join(screenshots, `${path.basename(process.argv[1], ".mjs")}_${name}.${type}`);
