// SPDX-License-Identifier: Apache-2.0
// settings_test.mjs WEB SCREENSHOTS: steers a run that this test plays from its live page.
import assert from "node:assert/strict";
import { eventually, pause, use_live_page } from "./live_page.mjs";

await use_live_page(async (live) => {
  const { page, run } = live;

  // A slider by keyboard: its request is sent, and the answer appears beside it.
  const control = (setting, part) => `[data-setting="${setting}"] ${part}`;
  const value_of = (setting, part) => page.$eval(control(setting, part), (one) => one.value);
  await page.focus(control("filters.alpha_s", "input[type=range]"));
  await page.keyboard.press("ArrowRight");
  await live.until_text(control("filters.alpha_s", ".outcome"), "from frame 313 on");
  assert.deepEqual(run.requests.splice(0), ["set filters.alpha_s=0.151"]);
  assert.equal(await value_of("filters.alpha_s", "input[type=number]"), "0.151");

  // The last of many movements takes effect, and at most one request is pending.
  run.answers_at_once = false;
  for (let i = 0; i < 40; ++i) {
    await page.keyboard.press("ArrowRight");
    if (i === 20) await pause(400);
  }
  const alpha = control("filters.alpha_s", "input[type=number]");
  await live.until((one) => document.querySelector(one).value === "0.191", alpha);
  const waits = (count) => eventually(() => run.requests.length >= count, `${count} requests`);
  await waits(1);
  run.answer();
  await waits(2);
  run.answer();
  assert.equal(run.requests.at(-1), "set filters.alpha_s=0.191");
  assert.equal(run.most_requests_under_way, 1);
  run.answers_at_once = true;
  run.requests.length = 0;

  // A refusal appears beside the control, which returns to the current value.
  run.judge = () => "radius_px is 1 to 1000 px; this is -5";
  const type = async (setting, value) => {
    await page.click(control(setting, "input"), { count: 3 });
    await page.keyboard.type(value);
    await page.keyboard.press("Enter");
  };
  await type("filters.radius_px", "-5");
  await live.until_text(control("filters.radius_px", ".outcome"), "refused: radius_px is 1 to");
  assert.equal(await value_of("filters.radius_px", "input"), "60");
  run.judge = () => "";
  run.requests.length = 0;

  // Every kind of control requests in its way, and goes back to its default.
  await page.select(control("filters.warp.robust", "select"), "tukey");
  await type("filters.scales", "1, 2, 4");
  await page.click(control("detectors.upright", "input"));
  await waits(3);
  assert.deepEqual(run.requests.toSorted(), [
    "set detectors.upright=false",
    "set filters.scales=[1, 2, 4]",
    'set filters.warp.robust="tukey"',
  ]);
  await live.until_text("details:nth-of-type(2) .changes", "3 changed");
  run.requests.length = 0;
  await page.click(control("filters.scales", ".undo"));
  await waits(1);
  assert.deepEqual(run.requests.splice(0), ["set filters.scales=[1, 2]"]);
  assert.equal(await value_of("filters.warp", "output"), "warps/bbs");

  // Changes by another client appear here; a control that cannot change shows the reason.
  run.change("detectors.keypoints", 2000);
  const keypoints = control("detectors.keypoints", "input[type=number]");
  await live.until((one) => document.querySelector(one).value === "2000", keypoints);
  assert.ok((await live.text("#stages")).includes("It was read before the first frame."));
  assert.equal(await page.$$eval("fieldset:disabled", (all) => all.length), 1);

  // Two browsers see what is changed in either.
  const other = await live.another();
  const robust = control("filters.warp.robust", "select");
  const shows = (one, value) => document.querySelector(one)?.value === value;
  const polling = { polling: 100 }; // a page behind another one draws nothing
  const other_shows = (value) => other.waitForFunction(shows, polling, robust, value);
  await other_shows("tukey");
  await page.select(robust, "huber");
  await other_shows("huber");
  await other.select(robust, "none");
  await live.until(shows, robust, "none");
  await other.close();
  run.requests.length = 0;

  // The search finds settings by name, help and stage.
  await page.type("#search", "neighbour");
  await live.until_text("#found", "3 found");
  const found = await page.$$eval(".parameter", (all) =>
    all.filter((one) => one.checkVisibility()).map((one) => one.dataset.setting),
  );
  assert.deepEqual(found, ["filters.alpha_s", "filters.radius_px", "filters.scales"]);
  await page.$eval("#search", (one) => {
    one.value = "";
    one.dispatchEvent(new Event("input"));
  });

  // Commands; to stop needs a confirmation.
  await live.show(0);
  for (const [button, command] of [
    ["#play", "pause"],
    ["#forward", "step"],
    ["#play", "resume"],
  ]) {
    await page.click(button);
    await waits(1);
    assert.deepEqual(run.requests.splice(0), [command]);
  }
  await live.until_text("#outcome", "Running from frame 313 on");
  run.pause(true, 320);
  await live.until_text("#outcome", "Paused in another browser");
  run.pause(false, 330);
  await live.until_text("#outcome", "Going on, by another browser");
  await page.click("#stop");
  await page.keyboard.press("Escape");
  await page.click("#stop");
  await page.click("#stopping button[value=stop]");
  await waits(1);
  assert.deepEqual(run.requests.splice(0), ["stop"]);
});
