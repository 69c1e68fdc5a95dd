// SPDX-License-Identifier: Apache-2.0
// Changes of settings by this page, to take back and to make again.
import { requested_value, same_value, shown_value } from "./parameters.js";

const kTogether_ms = 1500; // of a slider's movements, which are one change

export class Edits {
  #change_requests;
  #changed;
  #now_ms;
  #groups = 0;
  #done = []; // {parameter, before, after, group, at_ms}
  #undone = [];

  /** `changed()` is called when there is something else to undo or to redo. */
  constructor(change_requests, changed, now_ms = () => performance.now()) {
    this.#change_requests = change_requests;
    this.#changed = changed;
    this.#now_ms = now_ms;
  }

  get can_undo() {
    return this.#done.length > 0;
  }

  get can_redo() {
    return this.#undone.length > 0;
  }

  pending(setting) {
    return this.#change_requests.pending(setting);
  }

  /** Another run began. */
  forget() {
    this.#done = [];
    this.#undone = [];
    this.#changed();
  }

  /** A number for edits that are undone together. */
  new_group() {
    return ++this.#groups;
  }

  /** Requests the value that a control holds as text. `told` as in ChangeRequests. False if it is no
      value of the parameter's type. */
  request(parameter, text, told, group = this.new_group()) {
    const before = parameter.value;
    return this.#send(parameter, text, (outcome) => {
      if (outcome.outcome === "granted") this.#add({ parameter, before, after: text, group });
      told(outcome);
    });
  }

  undo() {
    this.#move(this.#done, this.#undone, ({ before }) => shown_value(before));
  }

  redo() {
    this.#move(this.#undone, this.#done, ({ after }) => after);
  }

  #send(parameter, text, told) {
    const value = requested_value(parameter, text);
    if (value === null) return false;
    const { setting } = parameter;
    this.#change_requests.want(setting, `set ${setting}=${value}`, told);
    return true;
  }

  #add(edit) {
    const at_ms = this.#now_ms();
    const last = this.#done.at(-1);
    const continues =
      last?.parameter.setting === edit.parameter.setting && at_ms - last.at_ms < kTogether_ms;
    if (continues) Object.assign(last, { after: edit.after, at_ms });
    else if (!same_value(edit.before, null)) this.#done.push({ ...edit, at_ms });
    this.#undone = [];
    this.#changed();
  }

  /** Sends the last group of `from`, and moves it to `to`. */
  #move(from, to, text_of) {
    const group = from.at(-1)?.group;
    while (from.length && from.at(-1).group === group) {
      const edit = from.pop();
      this.#send(edit.parameter, text_of(edit), () => {});
      to.push(edit);
    }
    this.#changed();
  }
}
