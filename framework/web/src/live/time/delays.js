// SPDX-License-Identifier: Apache-2.0
// Where the time between a camera's exposure and this screen is spent, and which frames are lost.
//
// The clocks of the source, of the run and of this browser differ by unknown constants. In the frame
// that took least, what is left after the measured work is taken for the constant; the excess of the
// other frames is then known. Delays are thus at least as long as stated.

const kRealTime = 0.2; // by which a source in real time may seem to be faster or slower
const kLeastSpan_s = 1; // of frames from which that is judged
const kStart = { source_s: Infinity, link_s: Infinity };

export class Delays {
  #least = { ...kStart };
  #first = null; // sample of the run, or of the part of it since its source was not in real time
  #before = null;

  /** The delays of a frame, ms: `run_ms` from capture to the sink (NaN unless the source is in real
      time), `link_ms` from there to this browser beyond the least; and `lost_run`, `lost_link`: frames
      before it that the run, and that the connection or this browser, skipped. `browser_ms` is added
      when it is shown. */
  of(sample) {
    const before = this.#before;
    this.#before = sample;
    const { source_s, link_s } = this.#least;
    const source_now_s = sample.at_s - sample.time_s - sample.total_ms / 1000;
    const link_now_s = sample.arrived_s - sample.at_s;
    this.#least.link_s = Math.min(link_s, link_now_s);
    if (Number.isFinite(source_now_s)) this.#least.source_s = Math.min(source_s, source_now_s);
    const waits_ms = 1000 * (source_now_s - this.#least.source_s);
    return {
      run_ms: this.#is_real_time(sample) ? waits_ms + sample.total_ms : NaN,
      link_ms: 1000 * (link_now_s - this.#least.link_s),
      browser_ms: NaN,
      ...lost_between(before, sample),
    };
  }

  /** Another run began. */
  begin() {
    this.#least = { ...kStart };
    this.#first = null;
    this.#before = null;
  }

  #is_real_time(sample) {
    this.#first ??= sample;
    const taken_s = sample.at_s - this.#first.at_s;
    const captured_s = sample.time_s - this.#first.time_s;
    if (!(taken_s >= kLeastSpan_s)) return false;
    return Math.abs(captured_s / taken_s - 1) <= kRealTime;
  }
}

function lost_between(before, { frame, written }) {
  const behind = before ? frame - before.frame - 1 : 0;
  if (!(behind > 0)) return { lost_run: 0, lost_link: 0 };
  const lost_link = Number.isFinite(written) ? Math.max(0, written - before.written - 1) : NaN;
  return { lost_run: Math.max(0, behind - lost_link), lost_link };
}
