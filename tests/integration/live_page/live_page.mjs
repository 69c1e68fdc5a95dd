// SPDX-License-Identifier: Apache-2.0
// Opens the live page of a run that the test plays.
import assert from "node:assert/strict";
import { existsSync, mkdtempSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import * as chromium from "../../support/chromium.mjs";
import { hello_message } from "./messages.mjs";
import { draw_picture } from "./picture.mjs";
import { PlayedRun } from "./played_run.mjs";
import { bent, camera, kVertices, matches_of, mesh, report_of, settings } from "./scene.mjs";

const [web, screenshots] = process.argv.slice(2);

export const pause = (ms) => new Promise((done) => setTimeout(done, ms));

/** Waits until `happened()` is true. */
export async function eventually(happened, what) {
  for (const end = Date.now() + chromium.kPatience_ms; !happened(); await pause(20)) {
    assert.ok(Date.now() < end, `waited in vain for ${what}`);
  }
}

/** The folder in which the browser saves files. */
class Downloads {
  folder = mkdtempSync(path.join(tmpdir(), "weft-downloads-"));

  /** The path of a file of that name, once it is there and alone; nothing else may be saved. */
  async file(name) {
    const saved = path.join(this.folder, name);
    const alone = () => readdirSync(this.folder).join() === name;
    await eventually(() => existsSync(saved) && alone(), `${name} in ${this.folder}`);
    return saved;
  }

  remove() {
    rmSync(this.folder, { recursive: true });
  }
}

/** The run, the page, and what tests do with both. */
class LivePage {
  #pictures = [];

  constructor(page, complaints) {
    this.page = page;
    this.complaints = complaints;
  }

  async open() {
    const { page } = this;
    const texture = await draw_picture(page, { mesh, camera, number: null });
    this.hello = hello_message({ camera, mesh, texture: texture.address, settings });
    for (let number = 0; number < 2; ++number) {
      const drawn = await draw_picture(page, { mesh, camera, number, vertices_m: bent(number) });
      this.#pictures.push(drawn.bytes);
    }
    this.run = await this.start();
    await page.setViewport({ width: 1400, height: 900 });
    await page.goto(this.run.address);
    await page.waitForSelector("html[data-ready=true]");
    await this.until_text("#connection", "Connected");
  }

  /** A run, at the given port or a free one. */
  async start(port, changes = {}) {
    const run = new PlayedRun(web, { ...this.hello, ...changes });
    await run.start(port);
    return run;
  }

  /** Makes the run show a frame, and waits until the page has rendered it. */
  async show(frame, changes = {}) {
    this.run.show({
      frame,
      time_s: frame / 30,
      report: report_of(frame),
      image: this.picture(frame),
      vertices_m: bent(frame),
      visible: Array.from({ length: kVertices }, (_, v) => (v % 13 < 3 ? 0 : 1)),
      taken_s: frame / 30 + 0.05,
      written: frame,
      ...matches_of(frame),
      ...changes,
    });
    await this.until((wanted) => window.weft_live.frame?.frame === wanted, frame);
  }

  /** The JPEG of a frame, as a Buffer. */
  picture(frame) {
    return this.#pictures[frame % 2];
  }

  text(selector) {
    return this.page.$eval(selector, (one) => one.textContent.trim());
  }

  until(works, ...given) {
    return this.page.waitForFunction(works, {}, ...given);
  }

  until_text(selector, part) {
    return this.until(
      (one, what) => document.querySelector(one).textContent.includes(what),
      selector,
      part,
    );
  }

  /** Another page that looks at the same run, behind this one. */
  async another() {
    const page = await this.page.browser().newPage();
    page.setDefaultTimeout(chromium.kPatience_ms);
    await page.goto(this.run.address);
    await page.waitForSelector("html[data-ready=true]");
    await this.page.bringToFront();
    return page;
  }

  /** From now on the browser saves without a prompt. */
  async downloads() {
    const downloads = new Downloads();
    const devtools = await this.page.createCDPSession();
    const allowed = { behavior: "allow", downloadPath: downloads.folder };
    await devtools.send("Browser.setDownloadBehavior", allowed);
    return downloads;
  }

  /** While no run is there the browser itself complains of each try. */
  forgive_tries() {
    const { complaints } = this;
    const ours = complaints.filter((each) => !each.includes("WebSocket connection to"));
    complaints.splice(0, complaints.length, ...ours);
  }

  shot(name) {
    const file = chromium.screenshot_file(screenshots, name);
    return this.page.screenshot({ path: file });
  }
}

/** Opens the page and gives it to `use`; the browser may complain of nothing but what `use` takes
    out of `complaints`. */
export async function use_live_page(use) {
  const own = /^(data|blob):|^http:\/\/127\.0\.0\.1:/;
  await chromium.use_chromium(web, own, async (page, complaints) => {
    const live = new LivePage(page, complaints);
    await live.open();
    await use(live);
    assert.deepEqual(complaints, []);
    await live.run.end();
  });
}
