// SPDX-License-Identifier: Apache-2.0
// The frames of the last half minute, at the times at which the run had finished them.

export const kSpan_s = 30;
const kRateSpan_s = 1;
const kLeastRateSpan_s = 0.5; // of a run that has just begun

/** Of a frame what is drawn over time; NaN for what its report does not tell. Its time is that of
    the run's clock: when frames arrive here depends on the connection and on this browser. */
export function sample_of({ frame, report, taken_s }, arrived_s) {
  const stages = (report?.stages ?? []).filter(({ ms }) => Number.isFinite(ms));
  const counted = stages.findLast(({ kept }) => Number.isFinite(kept));
  return {
    at_s: taken_s ?? arrived_s,
    frame,
    stages: stages.map(({ stage, ms }) => ({ stage, ms })),
    total_ms: stages.length ? stages.reduce((sum, { ms }) => sum + ms, 0) : NaN,
    kept: counted?.kept ?? NaN,
    matches: counted?.matches ?? NaN,
    confidence: report?.confidence ?? NaN,
    state: report?.state ?? "none",
  };
}

export class History {
  #samples = [];

  push(sample) {
    // A run that was started anew begins with its first frame.
    const { latest } = this;
    if (latest && (sample.frame < latest.frame || sample.at_s < latest.at_s)) this.#samples = [];
    this.#samples.push({ ...sample, rate: this.#rate(sample) });
    while (this.#samples[0].at_s < sample.at_s - kSpan_s) this.#samples.shift();
  }

  get samples() {
    return this.#samples;
  }

  get latest() {
    return this.#samples.at(-1);
  }

  /** Frames a second of the run, those among them that this page was not shown: over the last
      second, or since the frame before where that is longer ago. NaN until there are enough. */
  #rate({ frame, at_s }) {
    const first =
      this.#samples.findLast((each) => each.at_s <= at_s - kRateSpan_s) ?? this.#samples[0];
    const span_s = first ? at_s - first.at_s : 0;
    return span_s >= kLeastRateSpan_s ? (frame - first.frame) / span_s : NaN;
  }
}
