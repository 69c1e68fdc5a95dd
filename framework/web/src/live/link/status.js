// SPDX-License-Identifier: Apache-2.0
// The sentence on the connection: whether there is one, and why no frames come.
import { behind_words, has_ended, offline_words, silent_words } from "../words.js";

const kStill_s = 3; // without a frame of the run, when the server reports it
const kBehind_s = 5; // without one here although the run goes on, from which the page reports it

const now_s = () => performance.now() / 1000;

export class Status {
  #frame_at_s = null; // when the last one arrived; null without a connection
  #still_since_s = null; // when the run's last frame came, where the server reports it
  #ended = false; // by a request of this page

  constructor(root, announcer, commands) {
    this.root = root;
    this.announcer = announcer;
    this.commands = commands;
  }

  connected() {
    this.#frame_at_s = now_s();
    this.#still_since_s = null;
    this.#ended = false;
    this.#show("Connected", "on");
  }

  /** `was` and `pause_ms` as Connection reports them. */
  disconnected({ was, pause_ms }, by_this_page) {
    this.#frame_at_s = null;
    this.#ended ||= by_this_page;
    const how = this.#ended ? { code: 1001 } : was;
    const again = `Trying again in ${pause_ms < 1000 ? "a moment" : `${pause_ms / 1000} s`}.`;
    const words = offline_words(how, location.host);
    this.#show(has_ended(how) ? words : `${words} ${again}`, "off");
    this.announcer.say("offline", words);
  }

  frame_came() {
    this.#frame_at_s = now_s();
  }

  /** The server reports that the run has no frames, or has them again. */
  still_told(is_still) {
    this.#still_since_s = is_still ? now_s() - kStill_s : null;
    this.write();
  }

  /** Writes whether frames come; to be called every second. */
  write() {
    if (this.#frame_at_s === null || document.hidden) return;
    const since = (at_s) => Math.floor(now_s() - at_s);
    let words = "Connected";
    if (this.commands.paused) {
      // No frame is due.
    } else if (this.#still_since_s !== null) {
      words = silent_words(since(this.#still_since_s));
    } else if (since(this.#frame_at_s) >= kBehind_s) {
      words = behind_words(since(this.#frame_at_s));
    }
    this.#show(words, "on");
  }

  #show(words, kind) {
    if (this.root.textContent !== words) this.root.textContent = words;
    this.root.dataset.kind = kind;
  }
}
