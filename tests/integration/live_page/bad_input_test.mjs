// SPDX-License-Identifier: Apache-2.0
// bad_input_test.mjs WEB SCREENSHOTS: the live page without WebGL, with a huge mesh, in an old browser.
import assert from "node:assert/strict";
import { expect_accessible } from "./accessibility.mjs";
import { use_live_page } from "./live_page.mjs";
import { hello_message, sheet } from "./messages.mjs";
import { camera } from "./scene.mjs";

const web = process.argv[2];

await use_live_page(async (live) => {
  const { page } = live;
  const { port } = live.run;

  // A mesh of more faces than edges are drawn for is drawn without them.
  const huge = sheet(389, 389, 0.3, 0.2);
  await live.run.end();
  const hello = hello_message({ camera, mesh: huge, texture: "", settings: null });
  live.run = await live.start(port, hello);
  await live.until_text("#notices", "The mesh has 301,088 faces: the page shows it without edges");
  const vertices_m = huge.vertices_m.map((value, i) => value + [0, 0, 0.5][i % 3]);
  const parts = { image: null, visible: null, match_px: null, report: { state: "estimated" } };
  await live.show(0, { vertices_m, ...parts });
  assert.equal(await page.evaluate(() => window.weft_live.mesh.positions().length), 3 * 389 * 389);
  await page.select("#colouring", "strain");
  await live.until_text("#legend", "too many faces");

  // Without WebGL the page names what is missing, and all else works.
  await page.evaluateOnNewDocument(() => {
    const { getContext } = HTMLCanvasElement.prototype;
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
      return kind.startsWith("webgl") ? null : getContext.call(this, kind, ...rest);
    };
  });
  await live.run.end();
  live.run = await live.start(port);
  await page.goto(live.run.address);
  await live.until_text("#no-mesh", "This browser shows no 3D view");
  await live.until_text("#no-mesh", "Switch on WebGL");
  await live.until_text("#connection", "Connected");
  await live.show(1);
  await live.until_text("#state", "Estimated");
  await page.keyboard.press("f");
  await live.shot("no_webgl");
  await expect_accessible(page, web);
  live.forgive_tries();
  const expected = live.complaints.filter((each) => /WebGL/.test(each));
  live.complaints.splice(0, live.complaints.length, ...live.complaints.filter((each) => !expected.includes(each)));

  // A script that an old browser cannot read leaves a sentence behind.
  await page.setJavaScriptEnabled(false);
  await page.goto(live.run.address);
  await page.waitForSelector("#too-old", { visible: true });
  assert.match(await live.text("#too-old"), /It needs Chrome 100, Firefox 104, Safari 15.4/);
  await page.setJavaScriptEnabled(true);
});
