// SPDX-License-Identifier: Apache-2.0
// What is said of a frame and of the connection.

const kTitles = {
  estimated: "Estimated",
  weak: "Weak",
  predicted: "Predicted",
  lost: "Lost",
  none: "No shape",
};
// What a source says of each frame, whatever becomes of it.
const kStanding = /^not calibrated/;
// What the rule for states says of a shape by itself; other reasons are about the set-up.
const is_of_set_up = (reason) => Boolean(reason) && !reason.startsWith("weak: ");
const kStatuses = { error: "an error", no_result: "no result", degenerate: "degenerate" };

/** A probability for people; never a rounded 100 %. */
export function percent(share) {
  if (share > 0.999 && share < 1) return "more than 99.9\u00a0%";
  return `${(100 * share).toFixed(share > 0.99 && share < 1 ? 1 : 0)}\u00a0%`;
}

export const frames_ago = (age) => (age === 1 ? "of the frame before" : `of ${age} frames ago`);

/** The stage that is to blame for a frame without a shape of its own: the first one without a
    result that others had to do without, else the first without one. Null where all went well. */
export function cause_of(stages) {
  const stopped = stages.filter(({ status }) => status === "error" || status === "no_result");
  const missed = ({ stage }) =>
    stages.some(({ status, reason }) => status === "skipped" && reason?.startsWith(`${stage}: `));
  return (
    stopped.find(missed) ??
    stopped[0] ??
    stages.find(({ status, reason }) => status === "degenerate" && !kStanding.test(reason)) ??
    null
  );
}

function about_the_shape({ state, age = 0, confidence }) {
  const sure = Number.isFinite(confidence) ? `${percent(confidence)} sure` : "";
  switch (state) {
    case "estimated":
      return sure;
    case "weak":
      return `it may well be wrong${sure && `, ${sure}`}`;
    case "predicted":
      return `the shape ${frames_ago(age)}`;
    case "lost":
      return `the shape is the one ${frames_ago(age)}`;
    default:
      return "there has been none yet";
  }
}

/** The state of a frame by its report: {state, title, text, topic}. The topic changes only when
    there is news, not with each number. */
export function state_words(report) {
  if (!report) {
    return { state: "none", title: "Unknown", text: "the run tells no state", topic: "unknown" };
  }
  const { state, failed, stages = [] } = report;
  const title = kTitles[state] ?? state;
  const cause = state !== "estimated" || failed ? cause_of(stages) : null;
  const why = cause ? `${cause.stage}: ${cause.reason || kStatuses[cause.status]}` : "";
  const text = [about_the_shape(report), report.reason, why].filter(Boolean).join("; ");
  const topic = [title, cause?.stage, is_of_set_up(report.reason) && "set-up"];
  return { state, title, text, topic: topic.filter(Boolean).join(" ") };
}

/** What somebody must see besides: warnings of the run, and that the camera is not calibrated. */
export function notices_of(report) {
  const standing = (report?.stages ?? []).filter(({ reason }) => kStanding.test(reason));
  const sentences = standing.map(({ reason }) => reason[0].toUpperCase() + reason.slice(1));
  return [...(report?.warnings ?? []), ...sentences];
}

/** Whether the run said goodbye, or this page has stopped it. */
export const has_ended = (was) => was?.code === 1000 || was?.code === 1001;

/** What is said while there is no connection. `was` tells of the one before: null, or {code,
    reason}. */
export function offline_words(was, host) {
  if (!was) {
    return (
      `No run answers at ${host}. Start one with this sink; where it asks for a token, the ` +
      "address of this page ends with ?token=…"
    );
  }
  if (has_ended(was)) {
    return "The run has ended. When it is started again, this page goes on by itself.";
  }
  if (was.reason) return `The run closed the connection: ${was.reason}`;
  return "The connection was lost: the run has ended, or the network is down.";
}

/** What is said while the run has finished no frame, although it is not paused. */
export const silent_words = (silent_s) =>
  `Connected; no frame for ${silent_s} s: the run waits for its source, or a stage takes long`;

/** What is said while the run goes on, but this page has not shown a frame. */
export const behind_words = (behind_s) =>
  `Connected; behind by ${behind_s} s: this browser or the network is slow`;

/** The moment that is shown, in the history. */
export function moment_words({ frame, time_s, at_s }, latest, is_live) {
  const time = Number.isFinite(time_s) ? ` · ${time_s.toFixed(2)} s` : "";
  const ago_s = latest.at_s - at_s;
  const ago = is_live ? "" : ` · ${ago_s.toFixed(ago_s < 10 ? 2 : 1)} s ago`;
  return `frame ${frame}${time}${ago}`;
}

/** How much of the run can be looked at again. */
export function kept_words(span_s, bytes) {
  const whole_s = Math.round(span_s);
  const seconds = String(whole_s % 60).padStart(2, "0");
  return `${Math.floor(whole_s / 60)}:${seconds} min kept, ${(bytes / 1e6).toFixed(0)} MB`;
}

/** What the delays lack, and the frames that were skipped in half a minute. */
export function delay_words({ run_ms }, lost_run, lost_link) {
  const unknown = Number.isFinite(run_ms) ? "" : "capture time unknown; ";
  return `${unknown}skipped: ${lost_run} by the run, ${lost_link} behind it`;
}

/** Where a vertex is in the camera's frame, and how sure that is. */
export function vertex_words(vertex, vertices_m, std_mm) {
  const place_mm = [0, 1, 2].map((axis) => (1000 * vertices_m[3 * vertex + axis]).toFixed(1));
  const std = Number.isFinite(std_mm?.[vertex]) ? ` ± ${std_mm[vertex].toPrecision(2)}` : "";
  return `vertex ${vertex}: ${place_mm.join(", ")}${std} mm`;
}

/** A match of a frame. */
export function match_words({ match_px, match_kept, match_score, matches }, index) {
  const [x_px, y_px] = match_px.subarray(2 * index, 2 * index + 2);
  const verdict = match_kept[index] ? "kept" : "rejected";
  const of_all = matches > match_kept.length ? ` (a selection of ${matches})` : "";
  const place = `at ${x_px.toFixed(1)}, ${y_px.toFixed(1)} px`;
  const score = match_score[index].toPrecision(3);
  return `Match ${index + 1} of ${match_kept.length}${of_all}: ${verdict}, score ${score}, ${place}`;
}

/** The second mesh of a frame, by the stage that made it, which may be unknown (null). */
export const other_shape_words = (stage) => (stage ? `shape of ${stage}` : "other shape");

export const size_words = (bytes) => `${(bytes / 1e6).toFixed(1)} MB`;

/** What became of a recording {first, last, frames, bytes}. Frames are missing in it that the run
    left out, or that this page was not shown. */
export function recorded_words({ first, last, frames, bytes }) {
  if (frames === 0) return "Nothing was saved: no frame came.";
  if (frames === 1) return `Saved frame ${first}, ${size_words(bytes)}.`;
  const gapless = frames === last - first + 1;
  const which = gapless ? `${frames} frames,` : `${frames} of the frames`;
  return `Saved ${which} ${first} to ${last}, ${size_words(bytes)}.`;
}

/** The answer to a request that saves the settings: its `frame` is the number of the file. */
export function saved_words({ outcome, frame, refusal }) {
  if (outcome === "granted") return `Saved as settings-${frame}.yaml in the folder of the run`;
  return outcome_words({ outcome, frame, refusal });
}

/** What became of a request, beside its control. */
export function outcome_words({ outcome, frame, refusal }) {
  switch (outcome) {
    case "sent":
      return "…";
    case "granted":
      return `from frame ${frame} on`;
    case "refused":
      return `refused: ${refusal}`;
    default:
      return "no answer: there is no connection";
  }
}
