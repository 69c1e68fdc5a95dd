// SPDX-License-Identifier: Apache-2.0
// page_test.mjs WEB PAGE SCREENSHOTS: uses the report of an ablation.
import assert from "node:assert/strict";
import { expect_whole_sheets, marks, screenshot_file, shot, use_page } from "./browser.mjs";

const positions = (page) => page.evaluate(() => window.weft_report.viewer.positions());

await use_page(async (page) => {
  // The threshold changes no error: of the eight combinations with one, four share a curve each.
  // Both have a panel of the distribution, with the line itself and both in grey.
  const texts = (figure) =>
    page.$$eval(`#${figure} svg text`, (all) => all.map((one) => one.textContent));
  assert.equal(await marks(page, "figure-distribution", "line"), 2 * (1 + 2));
  assert.ok((await texts("figure-distribution")).includes("steady · 0.05 and 3 more"));
  // Over the frames two lines have their names at their ends, and bands.
  assert.equal(await marks(page, "figure-by-frame", "line"), 2);
  assert.equal(await marks(page, "figure-by-frame", "area"), 2);
  assert.ok((await texts("figure-by-frame")).includes("shaky · 0.05 and 3 more"));
  assert.equal(await page.$$eval("#figure-by-frame .legend", (all) => all.length), 0);
  // As differences, only values that differ from the reference have a separate curve.
  await page.select("#figure-by-frame select", "difference from steady · 0.05");
  await page.waitForFunction(() =>
    document.querySelector("#figure-by-frame svg").textContent.includes("Difference of the error"),
  );
  assert.equal(await marks(page, "figure-by-frame", "line"), 2);
  await page.select("#figure-by-frame select", "error");
  // The ranking is beside the verdict: the best is filled, what is not shown to be worse is hollow.
  const fills = await page.$$eval("#figure-ranking-filter-steady circle", (all) =>
    all.map((one) => one.getAttribute("fill")),
  );
  assert.deepEqual(fills, ["var(--series-1)", "var(--paper)"]);
  // A row for each sequence, in the panel of the one pair that has values.
  assert.equal(await page.$$eval("#figure-scenes-filter-steady circle", (all) => all.length), 8);
  assert.ok((await texts("figure-scenes-filter-steady")).includes("Difference, mm"));
  // The contents stay in sight and mark the section that is read.
  await page.$eval("#times", (section) => section.scrollIntoView());
  await page.waitForSelector('nav a[href="#times"][aria-current]');
  assert.ok((await page.$eval("nav", (nav) => nav.getBoundingClientRect().top)) >= 0);
  assert.equal(await marks(page, "figure-times", "rect"), 3 * 8);
  // Frames a second over the error: a point and a name for each.
  assert.equal(await marks(page, "figure-speed", "symbol"), 8);
  assert.equal(await page.$$eval("#figure-speed .mark-text.role-mark text", (all) => all.length), 8);
  // Promised and observed values, in two panels: the diagonal, the line and both in grey.
  assert.equal(await marks(page, "figure-reliability", "line"), 2 * (1 + 1 + 2));
  assert.equal(await marks(page, "figure-reliability", "symbol"), 2 * 2);
  // Figures that the script draws are saved as SVG and PGF.
  assert.deepEqual(
    await page.$$eval("#figure-speed .save button", (all) => all.map((one) => one.textContent)),
    ["SVG", "PGF"],
  );
  const pgf = await page.evaluate(() =>
    window.weft_report.pgf_of(document.getElementById("figure-by-frame")),
  );
  assert.match(pgf, /^% figure-by-frame.*\n\\begin\{pgfpicture\}/);
  assert.match(pgf, /shaky \$\\cdot\$ 0\.05 and 3 more/);
  assert.equal(pgf.match(/usepath\{stroke\}/g).length >= 2, true);
  assert.doesNotMatch(pgf, /NaN|undefined|null/);
  const sweeps = await page.$$eval("figure.sweep h3", (all) => all.map((one) => one.textContent));
  assert.deepEqual(sweeps, ["ROC of filters over alpha", "Along alpha"]);
  // Both filters reject the same: one curve, and the diagonal.
  assert.equal(await marks(page, "figure-sweep-0", "line"), 2);

  // Scores of outliers and of inliers, for the values that are chosen.
  assert.equal(await marks(page, "figure-scores-0", "line"), 2);
  await page.select('#figure-scores-0 select[aria-label="filter"]', "shaky");
  assert.equal(await marks(page, "figure-scores-0", "line"), 2);

  // The worst frames: the image that was kept, the estimate by its error, and the truth.
  const worst = await page.$$eval(".worst figure", (all) => all.length);
  assert.ok(worst > 0);
  assert.equal(await page.$$eval(".worst figure > img", (all) => all.length), worst);
  assert.equal(await page.$$eval(".worst .view img", (all) => all.length), 2 * worst);
  await expect_whole_sheets(page);

  // A square of the main table takes its combination out of the figures.
  await page.click('button.swatch[data-treatment="0"]');
  await page.waitForFunction(() =>
    document.querySelector("#figure-distribution svg").textContent.includes("steady · 0.1 and 2 more"),
  );

  // Sorting: ascending, then descending; what has no mean stays last.
  const column = (n) =>
    page.$$eval(`#table-combinations tbody tr td:nth-child(${n})`, (all) =>
      all.map((one) => one.textContent),
    );
  const mean =
    (await page.$$eval("#table-combinations th", (all) =>
      all.findIndex((one) => one.textContent.startsWith("mean")),
    )) + 1;
  await page.click(`#table-combinations th:nth-child(${mean}) button`);
  await page.click(`#table-combinations th:nth-child(${mean}) button`);
  const sorted = await column(mean);
  assert.equal(sorted.at(-1), "–");
  const numbers = sorted.map(Number).filter((value) => !Number.isNaN(value));
  assert.deepEqual(
    numbers,
    [...numbers].sort((a, b) => b - a),
  );

  // The slider moves the mesh: the estimate waves, so its vertices change and their number does not.
  const before = await positions(page);
  assert.equal(before.length, 3 * 9 * 7);
  assert.ok(before.every(Number.isFinite));
  const slide = (value) =>
    page.$eval(
      "#viewer input[type=range]",
      (slider, to) => {
        slider.value = to;
        slider.dispatchEvent(new Event("input"));
      },
      value,
    );
  const pixels = () => page.$eval("#viewer canvas", (canvas) => canvas.toDataURL());
  const drawn = await pixels();
  await slide(5);
  const after = await positions(page);
  assert.equal(after.length, before.length);
  assert.ok(
    after.some((value, i) => Math.abs(value - before[i]) > 0.01),
    "the mesh did not move",
  );
  assert.notEqual(await pixels(), drawn, "the drawing did not change");
  assert.match(
    await page.$eval("#viewer .readout", (one) => one.textContent),
    /frame 5 · estimated/,
  );

  await shot(page, "light", true);
  await (await page.$("#figure-reliability")).screenshot({
    path: screenshot_file("reliability"),
  });
  await page.$eval("#viewer", (viewer) => viewer.scrollIntoView());
  await shot(page, "viewer");

  // Dark: the paper gets darker than the ink, and the figures follow without being rendered again.
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "dark" }]);
  const brightness = (selector, property) =>
    page.$eval(
      selector,
      (one, name) =>
        getComputedStyle(one)
          [name].match(/\d+/g)
          .slice(0, 3)
          .reduce((sum, part) => sum + Number(part), 0),
      property,
    );
  assert.ok((await brightness("body", "backgroundColor")) < (await brightness("body", "color")));
  assert.ok((await brightness("#figure-distribution svg .mark-text text", "fill")) > 384);
  await shot(page, "dark", true);
  await page.emulateMediaFeatures([]);
  await page.pdf({ path: screenshot_file("print", "pdf") });
});
