// SPDX-License-Identifier: Apache-2.0
// The frames of the last half minute, as they came in.

export const kSpan_s = 30;
const kRateSpan_s = 1;

/** Of a frame what is drawn over time; NaN for what its report does not tell. */
export function sample_of({ frame, report }, at_s) {
  const stages = (report?.stages ?? []).filter(({ ms }) => Number.isFinite(ms));
  const counted = stages.findLast(({ kept }) => Number.isFinite(kept));
  return {
    at_s,
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
    if (sample.frame < (this.latest?.frame ?? 0)) this.#samples = [];
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
      second, or since the frame before where that is longer ago. */
  #rate({ frame, at_s }) {
    const first =
      this.#samples.find((each) => each.at_s >= at_s - kRateSpan_s) ?? this.#samples.at(-1);
    return first && at_s > first.at_s ? (frame - first.frame) / (at_s - first.at_s) : NaN;
  }
}
