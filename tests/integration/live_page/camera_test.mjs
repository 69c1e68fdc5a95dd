// SPDX-License-Identifier: Apache-2.0
// camera_test.mjs WEB SCREENSHOTS: the camera is chosen and calibrated from the page.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import * as chromium from "../../support/chromium.mjs";
import { expect_accessible } from "./accessibility.mjs";
import { expect_contrast } from "./contrast.mjs";
import { eventually, use_live_page } from "./live_page.mjs";

const [web] = process.argv.slice(2);
const kCameras = [
  {
    device: 0,
    name: "HD Webcam",
    modes: [
      { format: "MJPG", width_px: 1280, height_px: 720, fps: 30 },
      { format: "YUYV", width_px: 640, height_px: 480, fps: 30 },
    ],
    exposure_ms: [0.3, 204.7],
  },
  { device: 2, name: "Microscope", modes: [{ format: "YUYV", width_px: 800, height_px: 600, fps: 0 }] },
  { device: 4, name: "/dev/video4", modes: [], fault: "not readable: add yourself to the group video" },
];
const kCollecting = {
  state: "collecting",
  views: 7,
  enough: 20,
  cells: Array.from({ length: 36 }, (_, cell) => (cell % 6 > 3 ? 0 : cell)),
  missing: ["top right of the image: no corner yet"],
  frame: 3,
  kept: true,
  corners_px: Array.from({ length: 24 }, (_, i) => [150 + 45 * (i % 6), 120 + 60 * Math.floor(i / 6)]).flat(),
};
const kDone = {
  ...kCollecting,
  state: "done",
  used: 19,
  odd: ["frame 31"],
  rms_px: 0.183,
  fx: 611.48,
  fx_deviation: 0.44,
  camera_file: "fx: 611.48\n",
  path: "/runs/live/camera.yaml",
};

await use_live_page(async (live) => {
  const { page, complaints } = live;
  live.run.cameras = kCameras;
  await live.show(1);
  const last = () => live.run.requests.at(-1);
  const requested = (text) => eventually(() => last() === text, `${text}, not ${last()}`);
  const value = (name) => page.$eval(`#camera-dialog [name=${name}]`, (one) => one.value);
  const choose = (name, choice) => page.select(`#camera-dialog [name=${name}]`, choice);
  const press = (name) => page.click(`#camera-dialog [data-does=${name}]`);
  /** The run ends and another one begins at its port, with these values of its source. */
  const start_again = async (values, warnings = []) => {
    const settings = structuredClone(live.hello.settings);
    settings.warnings = warnings;
    for (const parameter of settings.source.parameters) {
      const name = parameter.setting.replace("source.", "");
      if (name in values) parameter.value = values[name];
    }
    const { port } = live.run;
    await live.run.end();
    await live.until_text("#connection", "The run has ended");
    live.run = await live.start(port, { settings });
    live.run.cameras = kCameras;
    await live.until_text("#connection", "Connected");
    live.forgive_tries();
  };

  // The dialog shows what the source is set to, and what else there is.
  await page.keyboard.press("v");
  await live.until(() => document.querySelector("#camera-dialog [name=device]").options.length === 3);
  assert.equal(await value("device"), "0");
  assert.equal(await value("mode"), "1");
  assert.equal(await value("exposure"), "same");
  await live.until_text("#camera-dialog [name=device]", "group video");
  await expect_accessible(page, web);

  // A camera that lacks a size and an exposure in its list; then the first one, changed.
  await choose("device", "2");
  assert.equal(await value("mode"), "");
  await choose("device", "0");
  await choose("mode", "0");
  await choose("exposure", "manual");
  await choose("rotation", "180");
  await live.until_text("#camera-dialog code", "--set 'source.width_px=1280'");
  live.run.judge = () => "the camera file describes images of 640 x 480 px";
  await page.click("#camera-start");
  await live.until_text("#camera-words", "refused: the camera file describes");
  live.run.judge = () => "";
  await page.click("#camera-start");
  await requested(
    "restart " +
      JSON.stringify([
        "source.device=0",
        'source.format="MJPG"',
        "source.width_px=1280",
        "source.height_px=720",
        "source.exposure_ms=8",
        "source.rotation_deg=180",
      ]),
  );
  await live.until_text("#camera-words", "starts again");
  await start_again({ camera: "/old.yaml", rotation_deg: 180 }, ["the run could not start with x"]);
  await live.until_text("#camera-words", "has started again");
  await live.until_text("#notices", "could not start with x");
  await live.show(2);

  // Calibration needs images with their distortion: the run starts again without the camera file.
  await press("begin");
  await requested('restart ["source.camera=\\"auto\\"","source.rotation_deg=0"]');
  await start_again({ camera: "auto", rotation_deg: 0 });
  await requested('calibrate begin {"squares":"7x5","pattern":"charuco"}');
  live.run.say({ type: "calibration", calibration: kCollecting });
  await live.until_text("#calibration output", "7 of 20 views. Next: top right of the image");
  for (const [width, height] of [[1600, 900], [1280, 800], [390, 844]]) {
    await page.setViewport({ width, height });
    for (const scheme of ["light", "dark"]) {
      await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: scheme }]);
      await live.show(width + (scheme === "dark" ? 1 : 0));
      await live.shot(`calibrating_${width}_${scheme}`);
      await expect_contrast(page);
    }
    const overflow = await chromium.overflow_of(page);
    assert.ok(overflow <= 0, `${overflow} px too wide`);
  }
  await expect_accessible(page, web);
  await page.emulateMediaFeatures([]);
  await page.setViewport({ width: 1400, height: 900 });
  const green = await page.$eval("#calibration canvas", (canvas) => {
    const { data } = canvas.getContext("2d").getImageData(150, 120, 1, 1);
    return [...data.slice(0, 3)];
  });
  assert.deepEqual(green, [64, 222, 97]);
  const { corners_px, ...without } = kCollecting;
  live.run.say({ type: "calibration", calibration: { ...without, reason: "3 of 24 corners" } });
  await live.until_text("#calibration output", "Not in this frame: 3 of 24 corners");

  // The estimate, the file in the browser, and the run with it.
  await press("end");
  await requested("calibrate end 4");
  live.run.say({ type: "calibration", calibration: kDone });
  await live.until_text("#calibration output", "19 views, error 0.183 px, focal length 611.5 ± 0.44 px");
  await live.shot("calibrated");
  await expect_accessible(page, web);
  const downloads = await live.downloads();
  await press("save");
  assert.equal(readFileSync(await downloads.file("camera.yaml"), "utf8"), kDone.camera_file);
  downloads.remove();
  await press("use");
  await requested('restart ["source.camera=\\"/runs/live/camera.yaml\\"","source.rotation_deg=180"]');
  await start_again({ camera: kDone.path, rotation_deg: 180 });

  // A calibration that is left by closing the dialog ends.
  live.run.say({ type: "calibration", calibration: kCollecting });
  await live.until_text("#calibration output", "7 of 20 views");
  await page.keyboard.press("Escape");
  await requested("calibrate stop");
  live.run.say({ type: "calibration", calibration: { state: "failed", reason: "too few views" } });
  live.run.cameras = [];
  await page.keyboard.press("v");
  await live.until_text("#calibration output", "No camera: too few views");
  await live.until_text("#camera-words", "No camera is connected");
  assert.equal(await page.$eval("#camera-start", (one) => one.disabled), true);
  await page.keyboard.press("Escape");
  assert.deepEqual(complaints, []);
});
