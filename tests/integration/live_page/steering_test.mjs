// SPDX-License-Identifier: Apache-2.0
// steering_test.mjs WEB: what the live page makes of declarations, and how requests go their way.
import assert from "node:assert/strict";
import { test } from "node:test";
import { close, module_loader } from "./modules.mjs";

const load = module_loader(process.argv[2]);
const parameters = await load("settings/parameters");
const { ChangeRequests } = await load("link/change_requests");
const { socket_address } = await load("link/connection");
const { Edits } = await load("settings/edits");
const { difference_of, pipeline_of } = await load("settings/difference");
const source = await load("camera/source");
const { fault_of } = await load("../corners");
const { template_pipeline } = await load("saving/template");

test("a slider gives each value that it shows", () => {
  for (const range of [
    { type: "f64", minimum: 0, maximum: 1, default: 0.15 },
    { type: "f64", minimum: 0, maximum: 1e6, default: 0.5 },
    { type: "f64", minimum: -5, maximum: 5, default: 0 },
    { type: "i64", minimum: 1, maximum: 40, default: 8 },
    { type: "i64", minimum: 0, maximum: 100000, default: 200 },
  ]) {
    const slider = parameters.slider_of(range);
    assert.equal(slider.value_at(0), range.minimum);
    assert.equal(slider.value_at(slider.steps), range.maximum);
    for (let place = 1; place <= slider.steps; ++place) {
      const value = slider.value_at(place);
      assert.ok(value >= slider.value_at(place - 1));
      assert.equal(Number.isInteger(value) || range.type === "f64", true);
      const near = slider.value_at(slider.place_of(value));
      const step = slider.value_at(Math.min(slider.steps, place + 1)) - value;
      close(near, value, step + 1e-12);
    }
  }
  const tiny = parameters.slider_of({ type: "f64", minimum: 0, maximum: 1e6, default: 0.5 });
  assert.equal(tiny.place_of(0.5), tiny.steps / 2);
  const few = parameters.slider_of({ type: "i64", minimum: 1, maximum: 40, default: 8 });
  assert.equal(few.steps, 39);
});

test("what has no two bounds, or is no number, has no slider", () => {
  assert.equal(parameters.slider_of({ type: "f64", minimum: 0, default: 1 }), null);
  assert.equal(parameters.slider_of({ type: "bool", default: true }), null);
  assert.equal(
    parameters.slider_of({ type: "f64", is_vector: true, minimum: 0, maximum: 1, default: [1] }),
    null,
  );
});

test("a change request holds what weft run --set takes", () => {
  const requested = parameters.requested_value;
  assert.equal(requested({ type: "f64" }, " 1e-7 "), "1e-7");
  assert.equal(requested({ type: "i64" }, "9007199254740993"), "9007199254740993");
  assert.equal(requested({ type: "f64" }, ""), null);
  assert.equal(requested({ type: "f64" }, "x"), null);
  assert.equal(requested({ type: "bool" }, "true"), "true");
  assert.equal(requested({ type: "choice" }, "huber"), '"huber"');
  assert.equal(requested({ type: "text" }, 'a "b": #c'), '"a \\"b\\": #c"');
  assert.equal(requested({ type: "f64", is_vector: true }, "[1, 2.5 ,3]"), "[1, 2.5, 3]");
  assert.equal(requested({ type: "f64", is_vector: true }, ""), "[]");
  assert.equal(requested({ type: "f64", is_vector: true }, "1, x"), null);
  assert.equal(requested({ type: "choice", is_vector: true }, "a, b"), '["a", "b"]');
});

test("ranges and defaults have words", () => {
  const words = parameters.range_words;
  const share = { type: "f64", minimum: 0, maximum: 1, default: 0.15 };
  assert.equal(words(share), "0 to 1, default 0.15");
  assert.equal(words({ type: "i64", minimum: 1, default: 8 }), "at least 1, default 8");
  assert.equal(words({ type: "f64", maximum: 5, default: null }), "at most 5");
  assert.equal(words({ type: "bool", default: true }), "default on");
  assert.equal(words({ type: "text", default: "" }), "");
  assert.equal(words({ type: "f64", is_vector: true, default: [1, 2] }), "default 1, 2");
});

test("paths and components are shown, not changed", () => {
  const kinds = (types) => types.map((type) => parameters.kind_of({ type }));
  const shown = kinds(["component", "input_path", "output_path", "labels"]);
  assert.deepEqual(shown, Array(4).fill("shown"));
  const changed = kinds(["bool", "choice", "f64", "i64", "text"]);
  assert.deepEqual(changed, ["flag", "choice", "number", "number", "text"]);
  assert.equal(parameters.kind_of({ type: "f64", is_vector: true }), "list");
});

/** Change requests whose moments the test ends. */
function requests_by_hand() {
  const sent = [],
    timers = new Map();
  let next = 0,
    connected = true;
  const send = (message) => connected && Boolean(sent.push(message));
  const later = {
    start: (work) => {
      timers.set(++next, work);
      return next;
    },
    stop: (timer) => timers.delete(timer),
  };
  const pass = () => {
    const due = [...timers.values()];
    timers.clear();
    for (const work of due) work();
  };
  const requests = new ChangeRequests(send, later);
  return { requests, sent, pass, connect: (value) => (connected = value) };
}

test("of requests in quick succession the last is sent", () => {
  const { requests, sent, pass } = requests_by_hand();
  for (let i = 0; i < 9; ++i) requests.want("a", `set a=${i}`, () => {});
  requests.want("b", "set b=1", () => {});
  assert.deepEqual(sent, []);
  pass();
  assert.deepEqual(sent.map(({ text }) => text), ["set a=8", "set b=1"]);
  assert.notEqual(sent[0].number, sent[1].number);
});

test("one request at most is under way, and the last one follows its answer", () => {
  const { requests, sent, pass } = requests_by_hand();
  const told = [];
  const want = (value) =>
    requests.want("a", `set a=${value}`, ({ outcome }) => told.push(value, outcome));
  want(1);
  pass();
  want(2);
  pass();
  want(3);
  pass();
  assert.equal(sent.length, 1);
  assert.equal(requests.pending("a"), true);
  requests.answer({ number: sent[0].number, frame: 5, refusal: "" });
  assert.deepEqual(sent.map(({ text }) => text), ["set a=1", "set a=3"]);
  requests.answer({ number: sent[1].number, frame: 6, refusal: "too large" });
  assert.deepEqual(told, [1, "sent", 1, "granted", 3, "sent", 3, "refused"]);
  assert.equal(requests.pending("a"), false);
  requests.answer({ number: sent[1].number, frame: 6, refusal: "" }); // told once
  assert.equal(told.length, 8);
});

test("commands do not wait for each other", () => {
  const { requests, sent } = requests_by_hand();
  for (let i = 0; i < 3; ++i) requests.now("step", () => {});
  assert.deepEqual(sent.map(({ text }) => text), ["step", "step", "step"]);
});

test("a change request without a connection says so", () => {
  const { requests, sent, pass, connect } = requests_by_hand();
  const told = [];
  const want = () => requests.want("a", "set a=1", ({ outcome }) => told.push(outcome));
  want();
  pass();
  want();
  pass(); // waits for the first one's answer
  requests.lose();
  assert.deepEqual(told, ["sent", "unsent", "unsent"]);
  connect(false);
  want();
  pass();
  assert.deepEqual(told, ["sent", "unsent", "unsent", "unsent"]);
  assert.equal(sent.length, 1);
  assert.equal(requests.pending("a"), false);
});

/** Edits of a run that grants all, or refuses. */
function edits_by_hand() {
  const sent = [];
  const state = { refusal: "", now_ms: 0 };
  const change_requests = {
    pending: () => false,
    want: (setting, text, told) => {
      sent.push(text);
      told({ outcome: state.refusal ? "refused" : "granted", refusal: state.refusal });
    },
  };
  const edits = new Edits(change_requests, () => {}, () => state.now_ms);
  return { edits, sent, state };
}
const number = (setting, value) => ({ setting, type: "f64", value });

test("an edit is undone and made again", () => {
  const { edits, sent, state } = edits_by_hand();
  edits.request(number("f.a", 1), "2", () => {});
  state.now_ms = 5000;
  edits.request(number("f.b", 0.5), "0.25", () => {});
  edits.undo();
  edits.undo();
  assert.equal(edits.can_undo, false);
  edits.undo();
  edits.redo();
  edits.redo();
  assert.equal(edits.can_redo, false);
  assert.deepEqual(sent.splice(0), [
    ...["set f.a=2", "set f.b=0.25", "set f.b=0.5", "set f.a=1", "set f.a=2", "set f.b=0.25"],
  ]);
  // Another edit, and nothing is left to make again.
  edits.undo();
  edits.request(number("f.a", 2), "3", () => {});
  assert.equal(edits.can_redo, false);
});

test("movements of a slider are one edit, and so is a preset", () => {
  const { edits, sent, state } = edits_by_hand();
  for (const value of [2, 3, 4]) {
    state.now_ms += 100;
    edits.request(number("f.a", value - 1), String(value), () => {});
  }
  const group = edits.new_group();
  edits.request(number("f.b", 1), "2", () => {}, group);
  edits.request(number("f.c", 1), "2", () => {}, group);
  sent.length = 0;
  edits.undo();
  assert.deepEqual(sent.splice(0), ["set f.c=1", "set f.b=1"]);
  edits.undo();
  assert.deepEqual(sent.splice(0), ["set f.a=1"]);
  edits.redo();
  assert.deepEqual(sent.splice(0), ["set f.a=4"]);
});

test("what the run refuses cannot be undone, and what is no value is not sent", () => {
  const { edits, sent, state } = edits_by_hand();
  state.refusal = "too large";
  assert.equal(edits.request(number("f.a", 1), "9", () => {}), true);
  assert.equal(edits.can_undo, false);
  assert.equal(edits.request(number("f.a", 1), "x", () => {}), false);
  assert.deepEqual(sent, ["set f.a=9"]);
});

test("changed settings are a pipeline that extends that of the run", () => {
  const stage = (stage, ...parameters) => ({ stage, changeable: true, parameters });
  const warp = { setting: "filters.warp", type: "component", value: "warps/bbs" };
  const started = [
    stage("filters", number("filters.a", 1), warp, number("filters.warp.r", 1)),
    stage("filters#2", { setting: "filters#2.name", type: "text", value: "x" }),
  ];
  const stages = [
    stage("filters", number("filters.a", 2), warp, number("filters.warp.r", [3, 4])),
    stage("filters#2", { setting: "filters#2.name", type: "text", value: 'say "b": #c' }),
  ];
  const changes = difference_of(stages, started);
  assert.deepEqual(changes.map(({ before }) => before), [1, 1, "x"]);
  const lines = pipeline_of({ pipeline: "a/b.yaml", stages }, changes).split("\n").slice(1);
  assert.deepEqual(lines, [
    "weft: 1",
    'extends: "b.yaml"',
    "stages:",
    '  - {as: "filters", params: {a: 2, warp: {use: warps/bbs, params: {r: [3,4]}}}}',
    '  - {as: "filters#2", params: {name: "say \\"b\\": #c"}}',
    "",
  ]);
  const absolute = pipeline_of({ pipeline: "/a/b.yaml", stages }, []).split("\n").slice(0, 3);
  assert.deepEqual(absolute, ["# Settings of the live view.", "weft: 1", 'extends: "/a/b.yaml"']);
  assert.deepEqual(difference_of(stages, stages), []);
});

test("on top are what the pipeline sets, or the first parameter of each stage", () => {
  const set = (setting, value) => ({ setting, type: "f64", default: 1, value });
  const file = { setting: "a.file", type: "input_path", value: "x" };
  const stage = (name, changeable, ...parameters) => ({ stage: name, changeable, parameters });
  const first = parameters.first_parameters([
    stage("a", true, file, set("a.one", 1), set("a.two", 1)),
    stage("b", true, set("b.one", 1), set("b.two", 2)),
    stage("c", false, set("c.one", 1)),
    stage("d", true, file),
    ...["e", "f", "g", "h"].map((name) => stage(name, true, set(`${name}.one`, 1))),
  ]);
  const names = first.map(({ setting }) => setting);
  assert.deepEqual(names, ["a.one", "b.two", "e.one", "f.one", "g.one"]);
});

test("on top are the prominent parameters, before those of stages without any", () => {
  const stage = (name, changeable, ...parameters) => ({ stage: name, changeable, parameters });
  const one = (setting, is_prominent) => ({
    setting,
    type: "f64",
    default: 1,
    value: 2,
    ...(is_prominent && { is_prominent }),
  });
  const names = (stages) => parameters.first_parameters(stages).map(({ setting }) => setting);
  const a = stage("a", true, one("a.one"));
  const b = stage("b", true, one("b.one"), one("b.two", true), one("b.three", true));
  const fixed = stage("c", false, one("c.one", true));
  const file = { ...one("d.file", true), type: "input_path" };
  const d = stage("d", true, file, one("d.one"));
  assert.deepEqual(names([a, b, fixed, d]), ["b.two", "b.three", "a.one", "d.one"]);
  const many = stage("e", true, ...["1", "2", "3", "4", "5", "6"].map((i) => one(`e.${i}`, true)));
  assert.deepEqual(names([a, many]), ["e.1", "e.2", "e.3", "e.4", "e.5"]);
});

const video = (values) => ({
  id: "sources/video",
  parameters: Object.entries(values).map(([name, value]) => ({ setting: `source.${name}`, value })),
});

test("a choice of a camera replaces what the source takes now", () => {
  const choice = { device: 1, mode: null, exposure_ms: -1, rotation_deg: 90, is_assumed: false };
  const rest = ['source.device=1', 'source.format=""', "source.width_px=0", "source.height_px=0",
    "source.exposure_ms=-1", "source.rotation_deg=90"];
  assert.deepEqual(source.choice_settings(video({ path: "", device: 0 }), choice), rest);
  assert.deepEqual(source.choice_settings(video({ path: "/a.mp4" }), choice), ['source.path=""', ...rest]);
  const mode = { format: "MJPG", width_px: 1280, height_px: 720, fps: 30 };
  const other = source.choice_settings({ id: "sources/synthetic", parameters: [] }, { ...choice, mode });
  assert.equal(other[0], "source.use=sources/video");
  assert.equal(other.at(-1), 'source.camera="auto"');
  assert.ok(other.includes("source.width_px=1280") && other.includes('source.format="MJPG"'));
  assert.equal(source.option_words(["a.b=it's"]), "--set 'a.b=it'\\''s'");
});

test("a calibration needs the images of the sensor, and restores what was set before", () => {
  assert.equal(source.raw_settings(video({ camera: "auto", longest_px: 0 })), null);
  assert.equal(source.raw_settings(video({ camera: "", rotation_deg: 0 })), null);
  const turned = video({ camera: "/c.yaml", longest_px: 640, rotation_deg: 180 });
  assert.deepEqual(source.raw_settings(turned), [
    'source.camera="auto"',
    "source.longest_px=0",
    "source.rotation_deg=0",
  ]);
  assert.deepEqual(source.calibrated_settings("/new.yaml", turned), [
    'source.camera="/new.yaml"',
    "source.longest_px=640",
    "source.rotation_deg=180",
  ]);
  assert.deepEqual(source.calibrated_settings("/new.yaml", null), ['source.camera="/new.yaml"']);
});

test("a template has four corners of a rectangle, clockwise from top left", () => {
  const corners = [[10, 10], [110, 12], [108, 90], [9, 88]];
  assert.equal(fault_of(corners), "");
  assert.match(fault_of([...corners].reverse()), /anticlockwise/);
  assert.match(fault_of([[10, 10], [12, 12], [108, 90], [9, 88]]), /closer than 16 px/);
  assert.match(fault_of([[10, 10], [110, 12], [40, 40], [9, 88]]), /move the bottom right one/);
});

test("the pipeline of a template extends that of the run, by its path if that is absolute", () => {
  const corners = [[0, 0.04], [20, 0], [20, 20], [0, 20]];
  const lines = template_pipeline("/a/b.yaml", corners, 210).split("\n").slice(0, 3);
  assert.deepEqual(lines, ["# A template of the live view.", "weft: 1", 'extends: "/a/b.yaml"']);
  const relative = template_pipeline("a/b.yaml", corners, 210);
  assert.match(relative, /Unpack these files in the folder of b\.yaml\.\nweft: 1\nextends: "b\.yaml"/);
  assert.match(relative, /width_m: 0\.21\n {4}corners: \[0, 0, 20, 0, 20, 20, 0, 20\]/);
});

test("the token goes from the page's address to the socket's", () => {
  const page = (text) => new URL(text);
  assert.equal(socket_address(page("http://a:1/?token=s%26t")), "ws://a:1/ws?token=s%26t");
  assert.equal(socket_address(page("https://a/")), "wss://a/ws");
});
