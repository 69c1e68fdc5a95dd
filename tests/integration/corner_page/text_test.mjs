// SPDX-License-Identifier: Apache-2.0
// text_test.mjs WEB PAGE: what the page makes of corners, without a browser. Writes the texts that it
// shows at first to PAGE.json.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { test } from "node:test";

const file = process.argv[3];
const page = readFileSync(file, "utf8");

/** The text between a start tag of this kind and its end. */
const inside = (start) => {
  const from = page.indexOf(start) + start.length;
  assert.ok(from >= start.length, `the page has no ${start}`);
  return page.slice(from, page.indexOf("</script>", from));
};
const photograph = JSON.parse(inside('<script type="application/json" id="photograph">'));
const script = inside('<script type="module">');
const corners = await import(`data:text/javascript,${encodeURIComponent(script)}`);

const { width_px, height_px, corners_px } = photograph;
const first = corners.first_corners(photograph);
const sheet = [
  [12, 30.5],
  [610, 28],
  [640.25, 470],
  [3, 480],
];

test("the page has all that it needs", () => {
  assert.ok(!page.includes("WEFT_"));
  assert.ok(!/(?:src|href)="(?!data:)/.test(page));
  const picture = photograph.picture.replace("data:image/jpeg;base64,", "");
  const bytes = Buffer.from(picture, "base64");
  assert.deepEqual([...bytes.subarray(0, 3)], [0xff, 0xd8, 0xff]);
  assert.deepEqual([...bytes.subarray(-2)], [0xff, 0xd9]);
});

test("rings stand at the corners that are known, else beside the borders", () => {
  for (let k = 0; k < 4; ++k) {
    for (const [axis, size_px] of [width_px, height_px].entries()) {
      const far = axis === 0 ? k === 1 || k === 2 : k > 1;
      const expected = corners_px ? corners_px[k][axis] : (far ? 0.85 : 0.15) * size_px - 0.5;
      assert.ok(Math.abs(first[k][axis] - expected) <= 0.05 + 1e-9, `corner ${k}, axis ${axis}`);
    }
  }
  assert.equal(corners.fault_of(first), "");
});

test("the photograph ends half a pixel beyond the centres of its outer pixels", () => {
  assert.equal(corners.to_px(0, 320), -0.5);
  assert.equal(corners.to_px(1, 320), 319.5);
  assert.equal(corners.to_px(0.5 / 320, 320), 0); // the middle of the first pixel
  for (const px of [-0.5, 0, 100.25, 319.5]) {
    assert.ok(Math.abs(corners.to_px(corners.to_share(px, 320), 320) - px) < 1e-9);
  }
  assert.deepEqual(corners.within([-7, 500], [320, 240]), [-0.5, 239.5]);
  assert.deepEqual(corners.within([12.3456, 0.04], [320, 240]), [12.3, 0]);
});

test("texts have x and y of the top left corner first, then clockwise", () => {
  const text = "12,30.5 610,28 640.25,470 3,480";
  assert.equal(corners.corners_text(sheet), text);
  assert.equal(corners.option_text(sheet), `--corners "${text}"`);
  const list = "[12, 30.5, 610, 28, 640.25, 470, 3, 480]";
  assert.equal(corners.parameter_text(sheet), `corners: ${list}`);
});

test("corners of no sheet are told", () => {
  const [a, b, c, d] = sheet;
  assert.equal(corners.fault_of([c, d, a, b]), "");
  assert.match(corners.fault_of([a, d, c, b]), /anticlockwise/);
  assert.match(corners.fault_of([a, b, d, c]), /no corners of a rectangle/);
  assert.match(corners.fault_of([a, b, [50, 60], d]), /bottom right/);
  assert.match(corners.fault_of([a, b, b, d]), /closer than 16 px/);
});

const texts = {
  corners: corners.option_text(first).match(/^--corners "(.*)"$/)[1],
  setting: corners.parameter_text(first).replace(": ", "="),
};
writeFileSync(`${file}.json`, JSON.stringify(texts));
