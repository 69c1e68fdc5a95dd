// SPDX-License-Identifier: Apache-2.0
// What the live page costs while it is open: memory and processor time of the browser.
//
// usage: live_page_open.mjs WEB ADDRESS [--minutes 10] [--view both|image] [--every 30] [--json FILE]
//
// WEB is the folder with puppeteer, ADDRESS that of a run. Each line has the JavaScript heap after a
// forced garbage collection, the proportional memory (PSS) of the renderer with what it shares, and the
// shares of a core that the browser's processes took since the line before. Chromium has no GPU here:
// SwiftShader draws WebGL in the GPU process.
import { readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import { parseArgs } from "node:util";
import * as chromium from "../support/chromium.mjs";

const { values: options, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    minutes: { type: "string", default: "10" },
    view: { type: "string", default: "both" },
    every: { type: "string", default: "30" },
    json: { type: "string" },
    profile: { type: "string" },
  },
});
const [web, address] = positionals;
if (!address) {
  console.error("usage: live_page_open.mjs WEB ADDRESS [--minutes N] [--view both|image] [--json FILE]");
  process.exit(2);
}

const kMB = 1e6;
const pause = (s) => new Promise((done) => setTimeout(done, 1000 * s));

/** Proportional memory of a process, MB. */
function memory_mb(pid) {
  const found = /^Pss:\s+(\d+) kB/m.exec(readFileSync(`/proc/${pid}/smaps_rollup`, "utf8"));
  return (1024 * Number(found[1])) / kMB;
}

await chromium.use_chromium(path.resolve(web), /./, async (page, complaints) => {
  const browser = await page.browser().target().createCDPSession();
  const devtools = await page.createCDPSession();
  await page.setViewport({ width: 1600, height: 900 });
  await page.goto(address);
  await page.waitForFunction(() => window.weft_live?.frame);
  if (options.view === "image") await page.evaluate(() => (document.body.dataset.onlyView = "image"));

  /** Memory, and processor time since the browser began, by kind of process. */
  const measure = async () => {
    await devtools.send("HeapProfiler.collectGarbage");
    const { processInfo } = await browser.send("SystemInfo.getProcessInfo");
    const { usedSize } = await devtools.send("Runtime.getHeapUsage");
    const cpu_s = {}, mb = {};
    for (const { id, type, cpuTime } of processInfo) {
      cpu_s[type] = (cpu_s[type] ?? 0) + cpuTime;
      mb[type] = (mb[type] ?? 0) + memory_mb(id);
    }
    const page_state = await page.evaluate(() => ({
      frame: window.weft_live.frame.frame,
      kept_mb: window.weft_live.history.bytes / 1e6,
      frames: window.weft_live.history.samples.length,
    }));
    return { at_s: performance.now() / 1000, heap_mb: usedSize / kMB, cpu_s, mb, ...page_state };
  };

  await pause(10);
  if (options.profile) {
    await devtools.send("Profiler.enable");
    await devtools.send("Profiler.start");
  }
  const lines = [];
  let before = await measure();
  const first = before;
  const until_s = before.at_s + 60 * Number(options.minutes);
  while (before.at_s < until_s) {
    await pause(Number(options.every));
    const now = await measure();
    const span_s = now.at_s - before.at_s;
    const share = (type) => (100 * ((now.cpu_s[type] ?? 0) - (before.cpu_s[type] ?? 0))) / span_s;
    const line = {
      minute: (now.at_s - first.at_s) / 60,
      frames_a_second: (now.frame - before.frame) / span_s,
      kept_mb: now.kept_mb,
      kept_frames: now.frames,
      heap_mb: now.heap_mb,
      renderer_mb: now.mb.renderer,
      gpu_mb: now.mb.GPU,
      renderer_percent: share("renderer"),
      gpu_percent: share("GPU"),
      browser_percent: share("browser"),
    };
    lines.push(line);
    const text = Object.entries(line).map(([name, value]) => `${name} ${value.toFixed(1)}`);
    console.log(text.join("  "));
    before = now;
  }
  if (options.profile) {
    const { profile } = await devtools.send("Profiler.stop");
    writeFileSync(options.profile, JSON.stringify(profile));
  }
  if (options.json) writeFileSync(options.json, `${JSON.stringify(lines, null, 1)}\n`);
  if (complaints.length) console.log(`complaints: ${complaints.join("; ")}`);
});
