// SPDX-License-Identifier: Apache-2.0
// Change requests on their way to the run: of each key the last one, and one at most under way.

const kDelay_ms = 120;
const kTimers = {
  start: (work, ms) => setTimeout(work, ms),
  stop: (timer) => clearTimeout(timer),
};

export class ChangeRequests {
  #send;
  #later;
  #number = 0;
  #waiting = new Map(); // key -> {text, told, timer}; no timer once it only waits for an answer
  #under_way = new Map(); // number -> {key, told}

  /** `send(message)` says whether there is a connection. */
  constructor(send, later = kTimers) {
    this.#send = send;
    this.#later = later;
  }

  /** Sends the text after a moment, in place of an earlier one that still waits. `told` is called
      with {outcome: "sent" | "granted" | "refused" | "unsent", frame, refusal}. */
  want(key, text, told) {
    const before = this.#waiting.get(key);
    if (before?.timer) this.#later.stop(before.timer);
    const timer = this.#later.start(() => this.#due(key), kDelay_ms);
    this.#waiting.set(key, { text, told, timer });
  }

  /** Sends the text at once, whatever is under way. */
  now(text, told) {
    this.#go(null, text, told);
  }

  /** Whether something of that key waits or is under way. */
  pending(key) {
    return this.#waiting.has(key) || this.#busy(key);
  }

  answer({ number, frame, refusal }) {
    const request = this.#under_way.get(number);
    if (!request) return;
    this.#under_way.delete(number);
    request.told({ outcome: refusal ? "refused" : "granted", frame, refusal });
    const next = this.#waiting.get(request.key);
    if (next && !next.timer) this.#due(request.key);
  }

  /** The connection is gone, and with it the answers. */
  lose() {
    const gone = [...this.#under_way.values()];
    for (const [key, { told, timer }] of this.#waiting) {
      if (timer) continue;
      this.#waiting.delete(key);
      gone.push({ told });
    }
    this.#under_way.clear();
    for (const { told } of gone) told({ outcome: "unsent" });
  }

  #busy(key) {
    return [...this.#under_way.values()].some((request) => request.key === key);
  }

  #due(key) {
    const request = this.#waiting.get(key);
    if (this.#busy(key)) {
      request.timer = null;
      return;
    }
    this.#waiting.delete(key);
    this.#go(key, request.text, request.told);
  }

  #go(key, text, told) {
    const number = ++this.#number;
    if (!this.#send({ type: "change_request", number, text })) {
      told({ outcome: "unsent" });
      return;
    }
    this.#under_way.set(number, { key, told });
    told({ outcome: "sent" });
  }
}
