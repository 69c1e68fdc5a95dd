// SPDX-License-Identifier: Apache-2.0
// keyboard_test.mjs WEB SCREENSHOTS: drives every control of the live page by keyboard alone.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { expect_accessible } from "./accessibility.mjs";
import { eventually, use_live_page } from "./live_page.mjs";
import { unzipped } from "./unzipped.mjs";
import { bent, matches_of, report_of } from "./scene.mjs";

const web = process.argv[2];

await use_live_page(async (live) => {
  const { page, run } = live;
  const shown = () => page.evaluate(() => window.weft_live.frame.frame);
  const until_shown = (frame) => live.until((wanted) => window.weft_live.frame.frame === wanted, frame);
  const pressed = (selector) => page.$eval(selector, (one) => one.getAttribute("aria-pressed"));
  const press = async (...keys) => {
    for (const key of keys) await page.keyboard.press(key);
  };
  const requested = async (...texts) => {
    await eventually(() => run.requests.length >= texts.length, `${texts}`);
    assert.deepEqual(run.requests.splice(0), texts);
  };
  const pixels = (selector) => page.$eval(selector, (canvas) => canvas.toDataURL());
  const changes_pixels = async (selector, act) => {
    const before = await pixels(selector);
    await act();
    const differs = (one, old) => document.querySelector(one).toDataURL() !== old;
    await live.until(differs, selector, before);
  };

  /** Moves the focus to a control by the tabulator, from the one beside it. */
  const reach = async (selector) => {
    await live.until((one) => document.querySelector(one)?.matches(":not(:disabled)"), selector);
    const is_first = await page.evaluate((one) => {
      const usable = "button, input, select, summary, [tabindex='0']";
      const all = [...document.querySelectorAll(usable)].filter(
        (each) => each.checkVisibility({ visibilityProperty: true }) && !each.matches(":disabled"),
      );
      const place = all.indexOf(document.querySelector(one));
      all[place === 0 ? 1 : place - 1].focus();
      return place === 0;
    }, selector);
    if (is_first) await page.keyboard.down("Shift");
    await press("Tab");
    if (is_first) await page.keyboard.up("Shift");
    assert.equal(await page.evaluate((one) => document.activeElement.matches(one), selector), true);
  };
  const leave = () => page.evaluate(() => document.activeElement.blur());

  // Thirty frames: a loss at the tenth, a change at the twentieth.
  for (let frame = 0; frame < 30; ++frame) {
    const state = frame >= 10 && frame < 13 ? { state: "lost", age: frame - 9, confidence: 0 } : {};
    const changes = frame === 20 ? { changes: ["filters.alpha_s=0.2"] } : {};
    await live.show(frame, { report: report_of(frame, { ...state, ...changes }) });
  }
  await expect_accessible(page, web);

  // Time: steps, marks, the slider, and back to the newest frame.
  await press("ArrowLeft", "ArrowLeft");
  await until_shown(27);
  await live.until_text("#moment-words", "frame 27");
  assert.equal(await live.text("#play"), "Play");
  await press(",");
  await until_shown(20);
  await press(",");
  await until_shown(10);
  await live.until_text("#state", "Lost");
  await live.shot("lost");
  await press(".");
  await until_shown(20);
  await reach("#moment");
  await press("Home");
  await until_shown(0);
  await press("ArrowRight");
  await until_shown(1);
  // Frames that come meanwhile do not disturb.
  run.show({ frame: 30, time_s: 1, report: report_of(30), written: 30, taken_s: 1.05 });
  await live.until(() => window.weft_live.history.latest.frame === 30);
  assert.equal(await shown(), 1);
  await reach("#newest");
  await press("Enter");
  await until_shown(30);
  assert.deepEqual(run.requests, []);

  // One key plays and pauses; at the newest frame a step is one of the run.
  await leave();
  await press("Space");
  await requested("pause");
  await live.until_text("#play", "Play");
  await live.shot("paused");
  await press("ArrowRight");
  await requested("step");
  await press("ArrowLeft", "ArrowLeft");
  await until_shown(28);
  await press("ArrowRight", "ArrowRight");
  await until_shown(30);
  await press("Space");
  await requested("resume");
  await live.until_text("#play", "Pause");
  for (const [button, command] of [["#forward", "step"], ["#play", "resume"]]) {
    await reach(button);
    await press("Enter");
    await requested(command);
    // A step pauses the run, and the page learns it from its answer.
    await live.until_text("#play", command === "step" ? "Play" : "Pause");
  }
  await reach("#back");
  await press("Enter");
  await until_shown(29);
  await reach("#mark-before");
  await press("Enter");
  await until_shown(20);
  await reach("#mark-after");
  await press("Enter");
  assert.equal(await shown(), 20);
  await leave();
  await press("l");
  await until_shown(30);

  // A click on a moment of a strip goes there.
  await press("ArrowLeft");
  await until_shown(29);
  const strip = await (await page.$("[data-strip=kept] canvas")).boundingBox();
  await page.mouse.click(strip.x + strip.width * (1 - 0.5 / 30), strip.y + 30);
  // Half a second before the newest frame, as far as the strip's pixels tell.
  await live.until(() => Math.abs(window.weft_live.frame.frame - 15) < 6);

  // The moment is compared with the one before the last change.
  await press("l");
  await live.show(31);
  await reach("#compare");
  await press("Enter");
  assert.equal(await pressed("#compare"), "true");
  await live.until_text("#comparison", "frame 19");
  await live.until_text("#comparison", "frame 31");
  await live.until_text("#legend .beside", "frame 19");
  await live.shot("compared");
  await expect_accessible(page, web);
  await leave();
  await press("c");
  assert.equal(await pressed("#compare"), "false");
  await live.until(() => document.querySelector("#comparison").hidden);

  // The image: opacity, matches, the loupe, and a match from near.
  await reach("#opacity");
  await changes_pixels("#image", () => press("Home"));
  await press("End");
  await reach("#matches");
  for (const name of ["kept", "all", "score"]) {
    await changes_pixels("#image", () => press("ArrowDown"));
    assert.equal(await page.$eval("#matches", (one) => one.value), name);
  }
  await reach("#loupe");
  await press("Space");
  await reach("#image");
  await changes_pixels("#image", () => press("ArrowRight"));
  await press("Enter");
  await live.until_text("#patch figcaption", "a selection of 312");
  await live.shot("match");
  await expect_accessible(page, web);
  await reach("#patch button");
  await press("Enter");
  await live.until(() => document.querySelector("#patch").hidden);

  // The mesh: colour, what is beside it, its views, a vertex with a trail, the grid.
  await reach("#colouring");
  await changes_pixels("#mesh", () => press("ArrowDown"));
  await press("ArrowUp");
  const other_m = bent(40);
  await live.show(32, { truth_m: [0, 0, 0.5, 0.1, 0, 0.5], other_m, ...matches_of(32) });
  await reach("#beside");
  for (const words of ["frame 31", "shape of refined", "ground truth"]) {
    await changes_pixels("#mesh", () => press("ArrowDown"));
    await live.until_text("#legend .beside", words);
    if (words === "shape of refined") await live.shot("other_shape");
  }
  for (const from of ["front", "side", "top", "fit"]) {
    await reach(`[data-view-from=${from}]`);
    await changes_pixels("#mesh", () => press("Enter"));
  }
  await leave();
  for (const key of ["1", "2", "3", "f"]) await changes_pixels("#mesh", () => press(key));
  await reach("#vertex");
  await changes_pixels("#mesh", () => page.keyboard.type("60"));
  await live.until_text("#picked", "vertex 60:");
  // Whatever turns and moves, the mesh comes back into the view.
  await reach("#surroundings");
  await changes_pixels("#mesh", () => press("Space"));
  await reach("#mesh");
  await press("+", "+", "ArrowLeft");
  const far = bent(33).map((value, i) => value + [3, 0, 4][i % 3]);
  await changes_pixels("#mesh", () => live.show(33, { vertices_m: far }));
  const drawn = await page.$eval("#mesh", (canvas) => {
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
    return data.filter((value, i) => i % 4 === 3 && value > 200).length;
  });
  assert.ok(drawn > 2000, `${drawn} pixels of the mesh`);
  await reach("#surroundings");
  await press("Space");
  await live.show(34);

  // The run saves its settings.
  await leave();
  await press("w");
  await requested("save");
  await live.until_text("#saved", "Saved as settings-1.yaml");

  // A template of the frame: a ring moves by arrow keys, and the files make a pipeline.
  const template_files = await live.downloads();
  await leave();
  await press("n");
  await live.until_text("#template-dialog output", "Give the width");
  await press("ArrowRight", "ArrowRight", "ArrowRight");
  await page.keyboard.down("Shift");
  await press("ArrowDown");
  await page.keyboard.up("Shift");
  await expect_accessible(page, web);
  await press("Tab", "Tab", "Tab", "Tab");
  await page.keyboard.type("297");
  await live.until_text("#template-dialog output", "");
  await live.shot("template");
  await press("Tab", "Enter");
  await live.until_text("#template-dialog output", "Saved weft_template.zip");
  const made = unzipped(await template_files.file("weft_template.zip"));
  template_files.remove();
  assert.equal(
    made["object.yaml"].toString().split("\n").slice(1).join("\n"),
    'weft: 1\nextends: "live.yaml"\ntemplate:\n  use: templates/photo\n  params:\n' +
      "    photo: object.jpg\n    camera: object_camera.json\n    width_m: 0.297\n" +
      "    corners: [98.5, 81.5, 543.5, 71.5, 543.5, 407.5, 95.5, 407.5]\n",
  );
  assert.equal(JSON.parse(made["object_camera.json"]).fx, 560);
  assert.equal(made["object.jpg"].subarray(0, 2).toString("hex"), "ffd8");
  await press("Escape");
  await reach("#make-template");
  await press("Enter");
  // Crossed corners are refused in words.
  await page.keyboard.down("Shift");
  for (let i = 0; i < 60; ++i) await press("ArrowRight");
  await page.keyboard.up("Shift");
  await live.until_text("#template-dialog output", "corner");
  assert.equal(await page.$eval("#save-template", (one) => one.disabled), true);
  await press("Escape");

  // The layout: the bar between the views, drawers, one view alone, the theme, the list of keys.
  const width = () => page.$eval("#image", (one) => one.parentElement.clientWidth); // of the pane
  const half = await width();
  await reach("#split");
  await press("ArrowRight", "ArrowRight");
  assert.ok((await width()) > half);
  assert.equal(await page.$eval("#split", (one) => one.getAttribute("aria-valuenow")), "54");
  await press("End");
  await press("Enter");
  const open = (id) => page.$eval(id, (one) => one.checkVisibility());
  for (const [key, drawer] of [["s", "#settings"], ["t", "#strips"]]) {
    await leave();
    await press(key);
    assert.equal(await open(drawer), false);
    await reach(`#toggle-${drawer.slice(1)}`);
    assert.equal(await page.$eval(`#toggle-${drawer.slice(1)}`, (one) => one.ariaExpanded), "false");
    await press("Enter");
    assert.equal(await open(drawer), true);
  }
  await leave();
  for (const [key, view, other] of [["i", "image", "mesh"], ["m", "mesh", "image"]]) {
    await press(key);
    await live.until((one) => !document.querySelector(one).checkVisibility(), `#${other}-view`);
    assert.equal(await pressed(`[data-alone=${view}]`), "true");
    await press(key);
    await live.until((one) => document.querySelector(one).checkVisibility(), `#${other}-view`);
  }
  await reach("#theme");
  await press("Enter", "Enter");
  assert.equal(await page.$eval("html", (one) => one.dataset.theme), "dark");
  await expect_accessible(page, web);
  await press("Enter");
  await leave();
  await press("?");
  await live.until(() => document.querySelector("#help-dialog").open);
  await expect_accessible(page, web);
  await live.shot("keys");
  await press("Escape");
  await reach("#help");
  await press("Enter");
  await live.until(() => document.querySelector("#help-dialog").open);
  for (let i = 0; i < 6 && (await page.evaluate(() => document.activeElement.id)) !== "letters"; ++i) {
    await press("Tab");
  }
  await press("Space", "Escape");
  await leave();
  await press("s");
  assert.equal(await open("#settings"), true, "letters are switched off");

  // Settings: undo, redo, the difference, a preset, and a pipeline file.
  const alpha = '[data-setting="filters.alpha_s"] input[type=number]';
  const value_is = (value) =>
    live.until((one, wanted) => document.querySelector(one).value === wanted, alpha, value);
  await reach(alpha);
  await page.keyboard.type("0.3");
  await press("Enter");
  await requested("set filters.alpha_s=0.3");
  await live.until_text("#difference .count", "1");
  await reach("#undo");
  await press("Enter");
  await requested("set filters.alpha_s=0.15");
  await value_is("0.15");
  await reach("#redo");
  await press("Enter");
  await requested("set filters.alpha_s=0.3");
  await leave();
  await page.keyboard.down("Control");
  await press("z");
  await requested("set filters.alpha_s=0.15");
  await page.keyboard.down("Shift");
  await press("Z");
  await page.keyboard.up("Shift");
  await page.keyboard.up("Control");
  await requested("set filters.alpha_s=0.3");
  await value_is("0.3");
  const robust = '[data-setting="filters.warp.robust"] select';
  await reach(robust);
  await press("ArrowDown");
  await requested('set filters.warp.robust="huber"');
  await live.until_text("#difference .count", "2");
  await reach("#presets summary");
  await press("Enter");
  await reach("#presets input");
  await page.keyboard.type("careful");
  await press("Enter");
  await live.until_text("#presets ul", "careful");
  await reach("#difference summary");
  await press("Enter");
  await live.until_text("#difference ul", "filters.alpha_s: 0.15 → 0.3");
  await live.shot("settings");
  await expect_accessible(page, web);
  const downloads = await live.downloads();
  await reach("#save-yaml");
  await press("Enter");
  const saved = readFileSync(await downloads.file("live_live.yaml"), "utf8");
  downloads.remove();
  assert.equal(
    saved.split("\n").slice(1).join("\n"),
    'weft: 1\nextends: "live.yaml"\nstages:\n  - {as: "filters", params: ' +
      '{alpha_s: 0.3, warp: {use: warps/bbs, params: {robust: "huber"}}}}\n',
  );
  // The run saves them too, and its refusal appears in words.
  await reach("#save-in-run");
  await press("Enter");
  await requested("save");
  await live.until_text("#saved", "Saved as settings-2.yaml in the folder of the run");
  run.judge = () => "nothing was saved in 'runs/live': No space left on device";
  await press("Enter");
  await requested("save");
  await live.until_text("#saved", "refused: nothing was saved in 'runs/live': No space");
  await expect_accessible(page, web);
  run.judge = () => "";
  await reach("#difference li button");
  await press("Enter");
  await requested("set filters.alpha_s=0.15");
  await live.until_text("#difference .count", "1");
  await reach("#back-to-file");
  await press("Enter");
  await requested('set filters.warp.robust="none"');
  await live.until_text("#difference .count", "none");
  await reach("#presets li button");
  await press("Enter");
  await requested("set filters.alpha_s=0.3", 'set filters.warp.robust="huber"');
  await live.until_text("#difference .count", "2");
  await reach("#presets li button + button");
  await press("Enter");
  assert.equal(await live.text("#presets ul"), "");
  // What was applied together is undone together.
  await reach("#undo");
  await press("Enter");
  await eventually(() => run.requests.length === 2, "both requests");
  assert.deepEqual(run.requests.splice(0).sort(), [
    "set filters.alpha_s=0.15",
    'set filters.warp.robust="none"',
  ]);
  await reach("#search");
  await page.keyboard.type("radius");
  await live.until_text("#found", "1 found");

  // Files, and the end of the run.
  const files = await live.downloads();
  await reach("#screenshot");
  await press("Enter");
  await files.file("weft_000034.png");
  files.remove();
  await reach("#record");
  await press("Enter");
  assert.equal(await live.text("#record"), "End recording");
  await press("Enter");
  await live.until_text("#recorded", "Nothing was saved");
  await reach("#stop");
  await press("Enter", "Escape", "Enter", "Enter");
  await requested("stop");

  // As wide as a telephone: a tab for each part, below the view that it changes.
  await page.setViewport({ width: 390, height: 844 });
  for (const [tab, shown, hidden] of [
    ["mesh", "#mesh", "#image"],
    ["settings", "#mesh, #settings", "#image"],
    ["strips", "#strips", "#settings"],
    ["image", "#image", "#strips"],
  ]) {
    await reach(`[data-tab-of=${tab}]`);
    await press("Enter");
    const visible = (all) => page.$$eval(all, (nodes) => nodes.map((one) => one.checkVisibility()));
    assert.ok((await visible(shown)).every(Boolean), `${shown} in ${tab}`);
    assert.ok(!(await visible(hidden)).some(Boolean), `${hidden} in ${tab}`);
    await live.shot(`narrow_${tab}`);
    await expect_accessible(page, web);
  }
});
