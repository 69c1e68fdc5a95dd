// SPDX-License-Identifier: Apache-2.0
// The last frames as they came from the run, and of each what is drawn over time.

export const kMostBytes = 256e6; // of the messages; JavaScript adds about 2 kB a frame
const kMostFrames = 20000;
const kRateSpan_s = 1;
const kLeastRateSpan_s = 0.5; // of a run that has just begun
const kMeasured = new Set(["estimated", "weak"]);

/** Of a frame what is drawn over time; NaN for what its report lacks. Its time is that of the run's
    clock: when frames arrive here depends on the connection and on this browser. */
export function sample_of({ frame, report, taken_s, time_s, written }, arrived_s) {
  const stages = (report?.stages ?? []).filter(({ ms }) => Number.isFinite(ms));
  const counted = stages.findLast(({ kept }) => Number.isFinite(kept));
  return {
    at_s: taken_s ?? arrived_s,
    arrived_s,
    time_s: time_s ?? NaN,
    frame,
    written: written ?? NaN,
    stages: stages.map(({ stage, ms }) => ({ stage, ms })),
    total_ms: stages.length ? stages.reduce((sum, { ms }) => sum + ms, 0) : NaN,
    kept: counted?.kept ?? NaN,
    matches: counted?.matches ?? NaN,
    confidence: report?.confidence ?? NaN,
    std_median_mm: report?.std_median_mm ?? NaN,
    state: report?.state ?? "none",
    changes: report?.changes ?? [],
  };
}

/** Why people look for a moment: {kind: "loss" | "change", text}; null for most. */
function mark_of(sample, before) {
  if (sample.changes.length) return { kind: "change", text: sample.changes.join(", ") };
  const is_loss = before && kMeasured.has(before.state) && !kMeasured.has(sample.state);
  return is_loss ? { kind: "loss", text: sample.state } : null;
}

export class History {
  #samples = [];
  #bytes = 0;
  #places = 0;
  #most_bytes;

  constructor(most_bytes = kMostBytes) {
    this.#most_bytes = most_bytes;
  }

  /** Adds a frame; its `message` is what the run sent. Each sample gets a `place`, a number that
      stays the same while older ones leave, the `rate` of the run and perhaps a `mark`. */
  push(sample, message = new ArrayBuffer(0)) {
    // A run that was started anew begins with its first frame.
    const before = this.latest;
    if (before && (sample.frame < before.frame || sample.at_s < before.at_s)) this.clear();
    const mark = mark_of(sample, this.latest);
    const rate = this.#rate(sample);
    this.#samples.push({ ...sample, rate, mark, message, place: this.#places++ });
    this.#bytes += message.byteLength;
    while (this.#bytes > this.#most_bytes || this.#samples.length > kMostFrames) {
      this.#bytes -= this.#samples.shift().message.byteLength;
    }
  }

  clear() {
    this.#samples = [];
    this.#bytes = 0;
  }

  get samples() {
    return this.#samples;
  }

  get latest() {
    return this.#samples.at(-1);
  }

  /** Bytes of all messages. */
  get bytes() {
    return this.#bytes;
  }

  /** The sample of that place, or the nearest one there is. */
  at(place) {
    const index = place - (this.#samples[0]?.place ?? 0);
    return this.#samples[Math.min(this.#samples.length - 1, Math.max(0, index))];
  }

  /** The last `count` of them, up to that of a place. */
  up_to(place, count) {
    const end = place - (this.#samples[0]?.place ?? 0) + 1;
    return this.#samples.slice(Math.max(0, end - count), Math.max(0, end));
  }

  /** Those whose time is from `first_s` to `last_s`. */
  between(first_s, last_s) {
    const first = this.#first_from(first_s);
    let end = first;
    while (end < this.#samples.length && this.#samples[end].at_s <= last_s) ++end;
    return this.#samples.slice(first, end);
  }

  /** The sample nearest to a time. */
  nearest(at_s) {
    const index = this.#first_from(at_s);
    const [before, after] = [this.#samples[index - 1], this.#samples[index]];
    if (!before || !after) return before ?? after;
    return at_s - before.at_s < after.at_s - at_s ? before : after;
  }

  #first_from(at_s) {
    let [low, high] = [0, this.#samples.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.#samples[middle].at_s < at_s) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /** Frames a second of the run, those among them that this page was not shown: over the last
      second, or since the frame before where that is longer ago. NaN until there are enough. */
  #rate({ frame, at_s }) {
    const first = this.#samples[this.#first_from(at_s - kRateSpan_s + 1e-9) - 1] ?? this.#samples[0];
    const span_s = first ? at_s - first.at_s : 0;
    return span_s >= kLeastRateSpan_s ? (frame - first.frame) / span_s : NaN;
  }
}
