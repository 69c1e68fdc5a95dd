// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";

const kLeast = 4.5; // WCAG 2, AA, for texts

/** Every text that is seen stands out from what is behind it. */
export async function expect_contrast(page) {
  const weak = await page.evaluate((least) => {
    const numbers = (colour) => colour.match(/[\d.]+/g).map(Number);
    const luminance = ([r, g, b]) => {
      const [x, y, z] = [r, g, b].map((value) => {
        const share = value / 255;
        return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
      });
      return 0.2126 * x + 0.7152 * y + 0.0722 * z;
    };
    const ground = (node) => {
      for (let one = node; one; one = one.parentElement) {
        const colour = numbers(getComputedStyle(one).backgroundColor);
        if (colour.length === 3 || colour[3] === 1) return colour;
      }
      return [255, 255, 255];
    };
    const found = [];
    for (const node of document.querySelectorAll("body *")) {
      const own = [...node.childNodes].some((child) => child.nodeType === 3 && child.data.trim());
      const worded = own || node.matches("input:not([type=range]):not([type=checkbox])");
      if (!worded || !node.checkVisibility({ visibilityProperty: true })) continue;
      if (node.matches(":disabled, :disabled *, noscript")) continue;
      const [a, b] = [numbers(getComputedStyle(node).color), ground(node)].map(luminance);
      const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
      const name = `${node.tagName} '${node.textContent.trim()}'`;
      if (ratio < least) found.push(`${name}: ${ratio.toFixed(2)}`);
    }
    return found;
  }, kLeast);
  assert.deepEqual(weak, []);
}
