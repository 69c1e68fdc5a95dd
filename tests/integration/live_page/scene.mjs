// SPDX-License-Identifier: Apache-2.0
// The run that the page test plays: a surface that waves, its reports and its settings.
import { sheet } from "./messages.mjs";

export const camera = { fx: 560, fy: 560, cx: 320, cy: 240, width_px: 640, height_px: 480 };
export const mesh = sheet(13, 9, 0.3, 0.2);
export const kVertices = 13 * 9;

/** Vertices [3 V] m of a surface that is rolled a little, half a metre away. */
export function bent(number) {
  const vertices_m = [];
  for (let v = 0; v < mesh.vertices_m.length; v += 3) {
    const [x, y] = mesh.vertices_m.slice(v, v + 2);
    vertices_m.push(x, y, 0.5 + 0.04 * Math.sin(12 * x + 0.3 * number));
  }
  return vertices_m;
}

/** Matches of a frame, which lie on its surface but for each ninth, which no filter keeps. */
export function matches_of(frame) {
  const vertices_m = bent(frame);
  const all = Array.from({ length: 156 }, (_, i) => (i * 7) % kVertices);
  const match_px = all.flatMap((v, i) => {
    const [x, y, z] = vertices_m.slice(3 * v, 3 * v + 3);
    const off = i % 9 === 0 ? 40 + (i % 5) * 12 : 0;
    return [(camera.fx * x) / z + camera.cx + off, (camera.fy * y) / z + camera.cy - off];
  });
  return {
    matches: 312,
    match_px,
    match_uv: all.flatMap((v) => mesh.uv.slice(2 * v, 2 * v + 2)),
    match_kept: all.map((_, i) => (i % 9 === 0 ? 0 : 1)),
    match_score: all.map((_, i) => (i % 9 === 0 ? 0.05 : 0.4 + 0.6 * ((i % 11) / 10))),
  };
}

const kTimes_ms = { sources: 6, detectors: 18, matchers: 9, filters: 3, warps: 2, solvers: 5 };

export function report_of(frame, changes = {}) {
  const kept = 260 + Math.round(30 * Math.sin(frame / 7));
  const stages = Object.entries(kTimes_ms).map(([stage, ms], i) => ({
    stage,
    status: "ok",
    ms: ms * (1 + 0.2 * Math.sin(frame / (3 + i))),
    ...(stage === "matchers" && { matches: 312, kept: 312 }),
    ...(stage === "filters" && { matches: 312, kept }),
  }));
  const std_mm = Array.from({ length: kVertices }, (_, v) => 0.2 + 0.1 * (v % 13));
  const std_median_mm = 0.8;
  const certain = { state: "estimated", age: 0, confidence: 0.97, std_mm, std_median_mm };
  return { frame, ...certain, stages, ...changes };
}

/** A parameter that holds its default. */
const parameter = (setting, type, usual, help, more = {}) => ({
  setting,
  type,
  is_vector: false,
  unit: "",
  help,
  default: usual,
  value: usual,
  ...more,
});

const detectors = {
  stage: "detectors",
  id: "detectors/sift_fast",
  summary: "Keypoints with descriptors that change little with scale and rotation.",
  changeable: true,
  why_not: "",
  parameters: [
    parameter("detectors.keypoints", "i64", 1200, "at most so many, the strongest ones", {
      minimum: 1,
      maximum: 8000,
    }),
    parameter("detectors.upright", "bool", false, "whether keypoints have no direction", {
      value: true,
    }),
  ],
};

const filters = {
  stage: "filters",
  id: "filters/myneighbor",
  summary: "Keeps matches whose neighbours moved alike.",
  changeable: true,
  why_not: "",
  parameters: [
    parameter("filters.alpha_s", "f64", 0.15, "share of neighbours that must agree", {
      minimum: 0,
      maximum: 1,
    }),
    parameter("filters.radius_px", "f64", 60, "radius of the neighbourhood on the template", {
      unit: "px",
      minimum: 0,
    }),
    parameter("filters.scales", "f64", [1, 2], "of the neighbourhood", { is_vector: true }),
    parameter("filters.warp", "component", "warps/bbs", "warp of the matches"),
    parameter("filters.warp.robust", "choice", "none", "weights of matches", {
      choices: ["none", "huber", "tukey"],
    }),
  ],
};

const template = {
  stage: "template",
  id: "templates/rectangular",
  summary: "",
  changeable: false,
  why_not: "It was read before the first frame.",
  parameters: [
    parameter("template.texture", "input_path", null, "image of the flat sheet", {
      value: "sheet.png",
    }),
  ],
};

const source = {
  id: "sources/video",
  parameters: [
    parameter("source.path", "input_path", null, "video file", { value: "" }),
    parameter("source.device", "i64", -1, "camera", { value: 0 }),
    parameter("source.camera", "input_path", null, "camera file", { value: "auto" }),
    parameter("source.width_px", "i64", 0, "width", { value: 640 }),
    parameter("source.height_px", "i64", 0, "height", { value: 480 }),
    parameter("source.format", "text", null, "pixel format", { value: "YUYV" }),
    parameter("source.exposure_ms", "f64", 0, "exposure time", { value: 0 }),
    parameter("source.rotation_deg", "i64", 0, "rotation", { value: 0 }),
    parameter("source.longest_px", "i64", 0, "longest side", { value: 0 }),
  ],
};

export const settings = {
  pipeline: "pipelines/live.yaml",
  source,
  stages: [detectors, filters, template],
  sinks: [{ sink: "live", id: "sinks/live", from: { other_shape: "refined" } }],
};
