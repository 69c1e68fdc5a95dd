// SPDX-License-Identifier: Apache-2.0
// frames_test.mjs WEB: what the live page makes of frames, before it draws.
import assert from "node:assert/strict";
import { test } from "node:test";
import { frame_message, hello_message, sheet } from "./messages.mjs";
import { close, module_loader } from "./modules.mjs";

const load = module_loader(process.argv[2]);
const { decode_frame, template_of } = await load("link/messages");
const { edges_of, edge_lengths, project, vertex_strain } = await load("views/mesh");
const { behind_words, cause_of, has_ended, notices_of, offline_words, percent, silent_words, state_words } =
  await load("words");
const { History, sample_of } = await load("time/history");
const { Colouring } = await load("views/colouring");
const { runs_of } = await load("time/plot");
const { Playback } = await load("time/playback");
const { Delays } = await load("time/delays");
const { contrasting_colour } = await load("views/contrast");
const { match_groups, nearest_match } = await load("views/matches");
const { measured_of } = await load("views/hatch");

const as_buffer = (bytes) => Uint8Array.from(bytes).buffer;

test("a frame is read as it was written", () => {
  for (const word of ["", "x", "xx", "xxx"]) {
    const message = frame_message({
      frame: 312,
      time_s: 12.5,
      report: { word },
      image: Buffer.from([1, 2, 3, 4, 5]),
      vertices_m: [0.5, -1, 2],
      visible: [1],
    });
    const frame = decode_frame(as_buffer(message));
    assert.equal(frame.frame, 312);
    assert.equal(frame.time_s, 12.5);
    assert.deepEqual(frame.report, { word });
    assert.deepEqual([...frame.image], [1, 2, 3, 4, 5]);
    assert.deepEqual([...frame.vertices_m], [0.5, -1, 2]);
    assert.deepEqual([...frame.visible], [1]);
  }
});

test("a frame without parts has none", () => {
  const frame = decode_frame(as_buffer(frame_message({ frame: 0 })));
  assert.deepEqual(frame, { frame: 0, time_s: null, report: null });
});

test("a frame that is cut off anywhere is refused with words", () => {
  const message = frame_message({ frame: 1, vertices_m: [1, 2, 3], visible: [1, 1, 0, 1] });
  for (let length = 0; length < message.length; ++length) {
    assert.throws(() => decode_frame(as_buffer(message.subarray(0, length))), /begin|cut off/);
  }
  message.writeUInt32LE(7, 0);
  assert.throws(() => decode_frame(as_buffer(message)), /does not begin like a frame/);
});

test("a template has each edge once, with its length at rest", () => {
  const mesh = sheet(5, 4, 0.4, 0.3);
  const template = template_of(hello_message({ camera: null, mesh, texture: "", settings: null }));
  assert.equal(template.faces.length, mesh.faces.length);
  assert.equal(template.edges.length / 2, 5 * 4 + mesh.faces.length / 3 - 1); // Euler
  const lengths = new Set([...template.rest_m].map((length) => length.toFixed(4)));
  assert.deepEqual([...lengths].sort(), ["0.1000", "0.1414"]);
  assert.equal(template.texture, null);
  assert.equal(template_of({ template: null }), null);
});

test("strain is the share by which edges are longer", () => {
  const mesh = sheet(5, 4, 0.4, 0.3);
  const edges = edges_of(mesh.faces);
  const rest_m = edge_lengths(mesh.vertices_m, edges);
  for (const factor of [0.9, 1, 1.1]) {
    const larger = mesh.vertices_m.map((value) => factor * value);
    for (const strain of vertex_strain(larger, edges, rest_m)) close(strain, factor - 1, 1e-6);
  }
  // A vertex without an edge, and an edge without a length, have none.
  assert.deepEqual([...vertex_strain([0, 0, 0], edges_of([]), [])], [0]);
  assert.deepEqual([...vertex_strain([0, 0, 0, 1, 0, 0], [0, 1], [0])], [0, 0]);
});

test("the camera sees a point at fx X / Z + cx", () => {
  const camera = { fx: 500, fy: 400, cx: 320, cy: 240 };
  const at_px = project([0.1, -0.05, 0.5, 0, 0, 0, 0, 0, -1], camera);
  assert.deepEqual([...at_px.subarray(0, 2)], [420, 200]);
  assert.ok(at_px.subarray(2).every(Number.isNaN));
});

test("words name the state and the stage that is to blame", () => {
  const agree = { stage: "filters", status: "no_result", reason: "4 matches of 312 agree" };
  const stages = [{ stage: "detectors", status: "ok" }, agree];
  const lost = state_words({ state: "lost", age: 31, confidence: 0, stages });
  assert.equal(lost.title, "Lost");
  assert.equal(lost.text, "the shape is the one of 31 frames ago; filters: 4 matches of 312 agree");
  const predicted = state_words({ state: "predicted", age: 1, stages: [] });
  assert.equal(predicted.text, "the shape of the frame before");
  const weak = state_words({ state: "weak", confidence: 0.42, stages: [] });
  assert.equal(weak.text, "it may well be wrong, 42\u00a0% sure");
  const reason = "the focal length seems to be 0.77 (+- 0.02) times the one given";
  const doubted = state_words({ state: "weak", confidence: 0.01, reason, stages: [] });
  assert.equal(doubted.text, `it may well be wrong, 1\u00a0% sure; ${reason}`);
  assert.equal(state_words({ state: "none", stages }).text.startsWith("there has been none"), true);
  assert.equal(state_words(null).title, "Unknown");
  // An estimated shape needs no excuse, but an error is reported all the same.
  const estimated = state_words({ state: "estimated", confidence: 0.98, stages });
  assert.equal(estimated.text, "98\u00a0% sure");
  const error = { stage: "sight", status: "error", reason: "no memory" };
  const failed = { state: "estimated", confidence: 0.98, failed: true, stages: [error] };
  assert.equal(state_words(failed).text, "98\u00a0% sure; sight: no memory");
  const silent = state_words({ state: "lost", age: 2, stages: [{ stage: "a", status: "error" }] });
  assert.equal(silent.text, "the shape is the one of 2 frames ago; a: an error");
});

test("a stage whose place another took is not to blame", () => {
  const tracked = { stage: "tracked", status: "no_result", reason: "there is no earlier shape" };
  const filters = { stage: "filters", status: "no_result", reason: "4 matches of 312 agree" };
  const skipped = { stage: "warps", status: "skipped", reason: "filters: 4 matches of 312 agree" };
  const waits = { stage: "x", status: "skipped", reason: "not called: it is every 30 frames" };
  assert.equal(cause_of([tracked, waits, filters, skipped]), filters);
  assert.equal(cause_of([tracked, waits]), tracked);
  assert.equal(cause_of([waits, { stage: "w", status: "degenerate" }]).stage, "w");
  assert.equal(cause_of([waits]), null);
});

test("a camera that is not calibrated is told, and not blamed", () => {
  const source = { stage: "sources", status: "degenerate", reason: "not calibrated: a guess" };
  const report = { state: "weak", stages: [source], warnings: ["setup: a second print"] };
  assert.deepEqual(notices_of(report), ["setup: a second print", "Not calibrated: a guess"]);
  assert.equal(cause_of(report.stages), null);
  assert.deepEqual(notices_of({ stages: [{ stage: "filters", status: "ok" }] }), []);
  assert.deepEqual(notices_of(null), []);
});

test("news has another topic, numbers alone have not", () => {
  const topic = (state, confidence) => state_words({ state, confidence, stages: [] }).topic;
  assert.equal(topic("estimated", 0.9), topic("estimated", 0.8));
  assert.notEqual(topic("estimated", 0.9), topic("lost", 0.9));
  const because = (reason) => state_words({ state: "weak", reason, stages: [] }).topic;
  assert.equal(because("weak: confidence 0.04 is below 0.5"), topic("weak", 0.04));
  assert.notEqual(because("the focal length seems to be 0.77"), topic("weak", 0.04));
});

test("a probability is never rounded to certainty", () => {
  assert.equal(percent(0.9996), "more than 99.9\u00a0%");
  assert.equal(percent(0.995), "99.5\u00a0%");
  assert.equal(percent(0.5), "50\u00a0%");
  assert.equal(percent(1), "100\u00a0%");
});

test("words tell a run that ended from a network that is down", () => {
  assert.match(offline_words(null, "host:8090"), /host:8090.*token=/);
  assert.match(offline_words({ code: 1001, reason: "" }, ""), /^The run has ended/);
  assert.match(offline_words({ code: 1006, reason: "" }, ""), /lost/);
  assert.match(offline_words({ code: 1008, reason: "too many requests" }, ""), /too many requests/);
  assert.match(silent_words(8), /^Connected; no frame for 8 s: .*source/);
  assert.match(behind_words(8), /^Connected; behind by 8 s: .*browser/);
  assert.deepEqual([1000, 1001, 1006].map((code) => has_ended({ code })), [true, true, false]);
  assert.equal(has_ended(null), false);
});

const report_of = (kept) => ({
  state: "estimated",
  confidence: 0.9,
  stages: [
    { stage: "matchers", ms: 3, matches: 300, kept: 300 },
    { stage: "filters", ms: 2, matches: 300, kept },
    { stage: "solvers", ms: 4 },
  ],
});

test("a sample has the sum of times and the matches that the last filter kept", () => {
  const sample = sample_of({ frame: 7, report: report_of(250) }, 1);
  assert.equal(sample.total_ms, 9);
  assert.equal(sample.kept, 250);
  assert.equal(sample.matches, 300);
  const bare = sample_of({ frame: 7, report: null }, 1);
  assert.ok([bare.total_ms, bare.kept, bare.confidence].every(Number.isNaN));
});

test("the history is bounded in bytes, and its places stay the same", () => {
  const history = new History(1000);
  // The run does 20 frames a second, the page is shown each second one.
  for (let i = 0; i <= 300; ++i) {
    history.push(sample_of({ frame: 2 * i, report: null }, i / 10), new ArrayBuffer(10));
  }
  assert.equal(history.samples.length, 100);
  assert.equal(history.bytes, 1000);
  assert.equal(history.at(250).frame, 500);
  assert.equal(history.at(0).frame, 402);
  assert.equal(history.at(9999), history.latest);
  close(history.latest.rate, 20, 1e-9);
  assert.deepEqual(history.between(25, 25.2).map(({ frame }) => frame), [500, 502, 504]);
  assert.equal(history.nearest(25.06).frame, 502);
  assert.equal(history.nearest(-1).frame, 402);
  assert.equal(history.nearest(99).frame, 600);
  history.push(sample_of({ frame: 0, report: null }, 31));
  assert.equal(history.samples.length, 1);
  assert.equal(history.bytes, 0);
});

test("a loss and a change of a parameter are marked, and playback goes there", () => {
  const history = new History();
  const states = ["none", "estimated", "weak", "lost", "lost", "estimated", "predicted"];
  states.forEach((state, frame) => {
    const changes = frame === 5 ? ["filters.alpha_s=0.2"] : undefined;
    history.push(sample_of({ frame, report: { state, changes } }, frame));
  });
  const marks = history.samples.flatMap(({ frame, mark }) => (mark ? [[frame, mark.kind]] : []));
  assert.deepEqual(marks, [[3, "loss"], [5, "change"], [6, "loss"]]);
  let moves = 0;
  const playback = new Playback(history, () => ++moves);
  assert.equal(playback.sample.frame, 6);
  assert.equal(playback.place_to_compare(), 4);
  playback.go_to_mark(-1);
  assert.equal(playback.sample.frame, 5);
  playback.go_to_mark(-1);
  assert.equal(playback.sample.frame, 3);
  playback.go_to_mark(-1);
  assert.equal(playback.sample.frame, 3);
  assert.equal(playback.place_to_compare(), 3);
  assert.equal(playback.step(-1), true);
  assert.equal(playback.sample.frame, 2);
  history.push(sample_of({ frame: 7, report: null }, 7));
  assert.equal(playback.sample.frame, 2);
  assert.equal(playback.is_live, false);
  assert.equal(playback.step(100), true);
  assert.equal(playback.step(1), false);
  playback.go_live();
  assert.equal(playback.is_live, true);
  assert.equal(moves, 5);
});

test("delays are counted from the frame that took least, whatever the clocks are", () => {
  const delays = new Delays();
  const stages = [{ stage: "all", ms: 20 }];
  const of = (frame, written, run_s, link_s) => {
    const [time_s, taken_s] = [frame / 30, 100 + frame / 30 + run_s];
    const arrived_s = 5000 + taken_s + link_s;
    return delays.of(sample_of({ frame, written, time_s, taken_s, report: { stages } }, arrived_s));
  };
  for (let frame = 0; frame < 60; ++frame) of(frame, frame, 0.02, 0.004);
  const late = of(70, 63, 0.05, 0.034);
  close(late.run_ms, 50, 1e-6);
  close(late.link_ms, 30, 1e-6);
  assert.equal(late.lost_link, 3);
  assert.equal(late.lost_run, 7);
  // A file that is read faster than it was filmed has no delay from its capture.
  delays.begin();
  const film = (frame) =>
    delays.of(sample_of({ frame, written: frame, time_s: frame / 30, taken_s: frame / 300, report: { stages } }, frame));
  for (let frame = 0; frame < 600; ++frame) film(frame);
  assert.ok(Number.isNaN(film(600).run_ms));
});

test("a line over a texture has the colour that the texture lacks", () => {
  const of = (...pixels) => contrasting_colour(Uint8ClampedArray.from(pixels.flat()));
  const [white, black] = [[255, 255, 255, 255], [0, 0, 0, 255]];
  assert.equal(of(white, white), "#10151a");
  assert.equal(of(black, black), "#f2f9ff");
  // Neither is seen on both.
  assert.ok(!["#f2f9ff", "#10151a"].includes(of(white, black)));
});

test("matches are grouped by the filters' verdict, or by score", () => {
  const frame = {
    match_px: Float32Array.from([10, 10, 20, 20, 30, 30]),
    match_kept: Uint8Array.from([1, 0, 1]),
    match_score: Float32Array.from([1, 0, 0.5]),
  };
  const shown = (mode) => match_groups(frame, mode).map(({ indices }) => indices);
  assert.deepEqual(shown("kept"), [[0, 2]]);
  assert.deepEqual(shown("all"), [[1], [0, 2]]);
  assert.deepEqual(shown("score"), [[0], [], [2], [], [1]]);
  assert.equal(nearest_match(frame, "all", [21, 21], 5), 1);
  assert.equal(nearest_match(frame, "kept", [21, 21], 5), -1);
  assert.equal(nearest_match(frame, "kept", [21, 21], Infinity), 2);
});

test("what was not measured is hatched", () => {
  const of = (report, visible) => [...measured_of({ report, visible }, 3)];
  assert.deepEqual(of({ state: "estimated" }, Uint8Array.from([1, 0, 1])), [1, 0, 1]);
  assert.deepEqual(of({ state: "weak" }, undefined), [1, 1, 1]);
  assert.deepEqual(of({ state: "lost" }, Uint8Array.from([1, 1, 1])), [0, 0, 0]);
});

test("the rate is the run's, however frames arrive", () => {
  // 30 frames a second, which the network delivers in bursts of 15.
  const history = new History();
  const rates = [];
  for (let frame = 0; frame < 300; ++frame) {
    const arrived_s = Math.ceil((frame + 1) / 15) / 2 + (frame % 15) * 0.001;
    history.push(sample_of({ frame, report: null, taken_s: frame / 30 }, arrived_s));
    rates.push(history.latest.rate);
  }
  assert.ok(rates.slice(0, 15).every(Number.isNaN)); // too early to tell
  for (const rate of rates.slice(15)) close(rate, 30, 1e-6);
  // A page that is shown single frames after a pause detects it as well.
  history.push(sample_of({ frame: 450, report: null, taken_s: 15 }, 16));
  history.push(sample_of({ frame: 451, report: null, taken_s: 15 + 1 / 30 }, 16.001));
  close(history.latest.rate, 30, 1e-6);
});

test("a line breaks at gaps, and a sample on its own is a line of its own", () => {
  const samples = [0, 1, 2, 9, 20, 21, 22, 30].map((at_s) => ({ at_s, value: at_s === 21 ? NaN : 1 }));
  const runs = runs_of(samples, ({ value }) => value);
  const times = runs.map((run) => run.map(([at_s]) => at_s));
  assert.deepEqual(times, [[0, 1, 2], [9], [20], [22], [30]]);
  assert.deepEqual(runs_of([], () => 1), []);
});

test("colours lie on the ramp, and their scale is that of the last frames", () => {
  const mesh = sheet(5, 4, 0.4, 0.3);
  const template = template_of(hello_message({ camera: null, mesh, texture: "", settings: null }));
  const colouring = new Colouring();
  const frame = (std_mm, factor) => ({
    vertices_m: Float32Array.from(mesh.vertices_m, (value) => factor * value),
    visible: Uint8Array.from({ length: 20 }, (_, v) => v % 2),
    report: { confidence: 0.75, std_mm: Array(20).fill(std_mm) },
  });
  const of = (name, ...rest) => colouring.of(name, frame(...rest), template);
  assert.equal(of("std", 4, 1).legend.high, "5 mm and more");
  assert.equal(of("std", 1, 1).legend.high, "5 mm and more");
  close(of("std", 1, 1).shares[0], 0.2, 1e-6);
  assert.deepEqual([...new Set(of("confidence", 1, 1).shares)], [0.25]);
  assert.deepEqual([...of("visibility", 1, 1).shares.slice(0, 4)], [1, 0, 1, 0]);
  close(of("strain", 1, 1).shares[0], 0.5, 1e-3);
  assert.equal(of("strain", 1, 1.1).legend.high, "longer by 10\u00a0%");
  close(of("strain", 1, 1.1).shares[0], 1, 1e-3);
  close(of("strain", 1, 0.95).shares[0], 0.25, 1e-3);
  for (let frame = 0; frame < 150; ++frame) of("std", 1, 1);
  assert.equal(of("std", 1, 1).legend.high, "1 mm and more");
  // The page reports the information that a pipeline lacks.
  const bare = { vertices_m: frame(1, 1).vertices_m, report: null };
  for (const name of ["confidence", "std", "visibility", "texture"]) {
    const { shares, legend } = colouring.of(name, bare, template);
    assert.equal(shares, undefined);
    assert.match(legend.text, /\.$/);
  }
  assert.match(colouring.of("strain", { report: null }, template).legend.text, /no shape/);
});
