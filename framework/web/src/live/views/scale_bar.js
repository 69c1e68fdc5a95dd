// SPDX-License-Identifier: Apache-2.0
// A bar as long as is written at it, at the depth about which the view turns.
import { round_number } from "../../errors.js";

const kLongest = 120; // px of the page

/** Writes the bar for a camera of three.js, its controls and the canvas's height. */
export function write_scale_bar(root, camera, target, height) {
  const distance_m = camera.position.distanceTo(target);
  const view_m = 2 * distance_m * Math.tan((camera.fov * Math.PI) / 360);
  const length_mm = round_number((1000 * kLongest * view_m) / Math.max(1, height), true);
  root.style.width = `${(length_mm / 1000) * (height / view_m)}px`;
  root.textContent = length_mm < 1000 ? `${length_mm} mm` : `${length_mm / 1000} m`;
}
