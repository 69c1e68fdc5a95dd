// SPDX-License-Identifier: Apache-2.0
// Chromium without a network, for tests that open a page.
import { mkdtempSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import path from "node:path";

export const kPatience_ms = 180000; // other tests may have the processor

/** Gives `use` a new page of a browser, and a list that fills with what the browser complains of,
    and with requests of addresses that do not begin as `allowed` says. `web` is the folder with
    puppeteer. */
export async function use_chromium(web, allowed, use) {
  const puppeteer = createRequire(path.join(web, "package.json"))("puppeteer-core");
  const profile = mkdtempSync(path.join(tmpdir(), "weft-chromium-"));
  const browser = await puppeteer.launch({
    executablePath: "/usr/bin/chromium",
    headless: true,
    timeout: kPatience_ms,
    protocolTimeout: kPatience_ms,
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
      // The drivers of WebGL warn of what these tests themselves do when they read pixels.
      if (
        ["error", "warn"].includes(message.type()) &&
        !message.text().includes("GL Driver Message")
      ) {
        complaints.push(message.text());
      }
    });
    page.on("pageerror", (error) => complaints.push(String(error)));
    page.on("request", (request) => {
      if (!allowed.test(request.url())) complaints.push(`asks for ${request.url()}`);
    });
    page.setDefaultTimeout(kPatience_ms);
    await use(page, complaints);
  } finally {
    await browser.close();
    rmSync(profile, { recursive: true, force: true });
  }
}

/** The number of pixels by which the page is wider than its window. */
export const overflow_of = (page) =>
  page.evaluate(() => document.documentElement.scrollWidth - innerWidth);

/** Keeps an image of the page for people in the folder, named after the script. */
export const screenshot_file = (folder, name, type = "png") =>
  path.join(folder, `${path.basename(process.argv[1], ".mjs")}_${name}.${type}`);
