// SPDX-License-Identifier: Apache-2.0
// The matches of a frame over its image.
import { kStops } from "../../errors.js";

export const kMatchModes = [
  { name: "none", title: "no matches" },
  { name: "kept", title: "kept matches" },
  { name: "all", title: "all matches" },
  { name: "score", title: "matches by score" },
];
const kKept = "#3df2a0";
const kRejected = "#ff6a5c";
const kRadius = 2.5;
const kArm = 3;

/** Groups {colour, indices, is_cross} of what a mode shows. */
export function match_groups({ match_kept, match_score }, mode) {
  const indices = [...match_kept.keys()];
  const kept = indices.filter((i) => match_kept[i]);
  const rejected = indices.filter((i) => !match_kept[i]);
  if (mode === "kept") return [{ colour: kKept, indices: kept }];
  if (mode === "all") {
    return [
      { colour: kRejected, indices: rejected, is_cross: true },
      { colour: kKept, indices: kept },
    ];
  }
  // The ramp's first colour is for the best ones, as in the colours of the mesh.
  const highest = match_score.reduce((high, score) => Math.max(high, score), 1e-9);
  return kStops.map((colour, stop) => {
    const is_here = (i) => {
      const share = 1 - Math.max(0, match_score[i]) / highest;
      return Math.min(kStops.length - 1, Math.floor(share * kStops.length)) === stop;
    };
    return { colour, indices: indices.filter(is_here) };
  });
}

/** `place_of(x_px, y_px)` are canvas coordinates of an image point. */
export function draw_matches(pen, frame, mode, place_of) {
  for (const { colour, indices, is_cross } of match_groups(frame, mode)) {
    const path = new Path2D();
    for (const i of indices) {
      const [x, y] = place_of(frame.match_px[2 * i], frame.match_px[2 * i + 1]);
      if (is_cross) {
        path.moveTo(x - kArm, y - kArm);
        path.lineTo(x + kArm, y + kArm);
        path.moveTo(x - kArm, y + kArm);
        path.lineTo(x + kArm, y - kArm);
      } else {
        path.moveTo(x + kRadius, y);
        path.arc(x, y, kRadius, 0, 2 * Math.PI);
      }
    }
    pen.strokeStyle = "#000a";
    pen.lineWidth = is_cross ? 3 : 1.5;
    pen.stroke(path);
    pen.strokeStyle = colour;
    pen.fillStyle = colour;
    pen.lineWidth = 1.3;
    if (is_cross) pen.stroke(path);
    else pen.fill(path);
  }
}

/** The index of the match that is shown nearest to an image point, within `most_px`; or -1. */
export function nearest_match({ match_px, match_kept }, mode, [x_px, y_px], most_px) {
  let found = -1;
  let least = most_px;
  for (let i = 0; i < match_kept.length; ++i) {
    if (mode === "kept" && !match_kept[i]) continue;
    const distance = Math.hypot(match_px[2 * i] - x_px, match_px[2 * i + 1] - y_px);
    if (distance > least) continue;
    least = distance;
    found = i;
  }
  return found;
}
