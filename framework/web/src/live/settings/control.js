// SPDX-License-Identifier: Apache-2.0
// The control of one parameter, made from its declaration.
import { element } from "../../data.js";
import { kind_of, range_words, same_value, shown_value, slider_of } from "./parameters.js";
import { outcome_words } from "../words.js";

let count = 0; // of the ids on this page

export class Control {
  #parameter;
  #started; // the value with which the run began
  #edits;
  #kind;
  #slider = null; // {input, places}
  #requests = false; // whether it has requested a value itself
  #written = ""; // the text that the input held last, before a person types on

  /** `name` is what the parameter is called within its stage; `started` its value as the run began. */
  constructor(parameter, name, started, edits) {
    this.#parameter = parameter;
    this.#started = started;
    this.#edits = edits;
    this.#kind = kind_of(parameter);
    const id = `setting-${++count}`;
    this.input = this.#make_input(id);
    this.outcome = element("p", { className: "outcome" });
    this.outcome.setAttribute("role", "status");
    this.undo = element("button", {
      type: "button",
      className: "undo",
      textContent: "↺",
      title: `Back to ${shown_value(started)}, as the run began`,
    });
    this.undo.setAttribute("aria-label", `${name}: back to ${shown_value(started)}`);
    this.undo.addEventListener("click", () => {
      this.#write(started);
      this.#want();
    });
    this.element = this.#make_element(id, name);
    this.#write(parameter.value);
    this.#mark();
  }

  get changed() {
    return !same_value(this.#parameter.value, this.#started);
  }

  /** Whether all words are in what the control says of itself. */
  speaks_of(words) {
    const { setting, help, unit } = this.#parameter;
    const text = `${setting} ${help ?? ""} ${unit ?? ""}`.toLowerCase();
    return words.every((word) => text.includes(word));
  }

  /** The parameter as it is now; a value that a person is about to change stays. */
  update(parameter) {
    this.#parameter = parameter;
    this.#mark();
    const typing = document.activeElement === this.input && this.#text() !== this.#written;
    const waits = this.#requests && this.#edits.pending(parameter.setting);
    if (!typing && !waits) this.#write(parameter.value);
  }

  #make_input(id) {
    const { type, choices, minimum, maximum } = this.#parameter;
    switch (this.#kind) {
      case "shown":
        return element("output", { id });
      case "flag":
        return element("input", { id, type: "checkbox" });
      case "choice":
        return element("select", { id }, ...choices.map((choice) => new Option(choice, choice)));
      case "number": {
        const input = element("input", { id, type: "number", step: type === "i64" ? 1 : "any" });
        if (Number.isFinite(minimum)) input.min = minimum;
        if (Number.isFinite(maximum)) input.max = maximum;
        return input;
      }
      default:
        return element("input", { id, type: "text", autocomplete: "off", spellcheck: false });
    }
  }

  #make_slider(name) {
    const places = slider_of(this.#parameter);
    if (!places) return [];
    const input = element("input", { type: "range", min: 0, max: places.steps, step: 1 });
    input.setAttribute("aria-label", name);
    input.addEventListener("input", () => {
      this.input.value = String(places.value_at(Number(input.value)));
      this.#want();
    });
    this.#slider = { input, places };
    return [input];
  }

  #make_element(id, name) {
    const { setting, unit, help } = this.#parameter;
    const label = element("label", { htmlFor: id }, element("span", { textContent: name }));
    // Most names end with their unit.
    if (unit && !name.endsWith(`_${unit}`)) {
      label.append(element("span", { className: "unit", textContent: ` ${unit}` }));
    }
    const about = [help, range_words(this.#parameter)].filter(Boolean).join("; ");
    const words = element("p", { className: "help", id: `${id}-help`, textContent: about });
    this.input.setAttribute("aria-describedby", words.id);
    this.input.addEventListener("change", () => this.#want());
    const fixed = this.#kind === "shown" || this.#started === null || this.#started === undefined;
    const row = element("div", { className: "row" }, ...this.#make_slider(name), this.input);
    if (!fixed) row.append(this.undo);
    const node = element("div", { className: `parameter ${this.#kind}` });
    node.append(label, row, words, this.outcome);
    node.dataset.setting = setting;
    return node;
  }

  #text() {
    return this.#kind === "flag" ? String(this.input.checked) : this.input.value;
  }

  #write(value) {
    if (this.#kind === "flag") this.input.checked = value === true;
    else this.input.value = shown_value(value);
    this.#written = this.#text();
    this.#speak();
  }

  /** The slider stands where the number is, and says it. One that already means the number stays,
      so that keys can move it over places of the same number. */
  #speak() {
    if (!this.#slider) return;
    const { input, places } = this.#slider;
    const number = Number(this.input.value);
    if (places.value_at(Number(input.value)) !== number) input.value = places.place_of(number);
    const { unit } = this.#parameter;
    input.setAttribute("aria-valuetext", unit ? `${this.input.value} ${unit}` : this.input.value);
  }

  #want() {
    this.#speak();
    this.#written = this.#text();
    const is_value = this.#edits.request(this.#parameter, this.#text(), (told) => {
      const failed = told.outcome === "refused" || told.outcome === "unsent";
      this.#say(outcome_words(told), failed);
      const { setting, value } = this.#parameter;
      if (this.#edits.pending(setting)) return;
      this.#requests = false;
      if (failed) this.#write(value);
    });
    this.#requests = is_value;
    if (is_value) return;
    const wanted = this.#kind === "list" ? "numbers, with commas between them" : "a number";
    this.#say(`not sent: this takes ${wanted}`, true);
  }

  #say(words, bad) {
    this.outcome.textContent = words;
    this.outcome.classList.toggle("bad", bad);
  }

  #mark() {
    this.element.classList.toggle("changed", this.changed);
    this.undo.disabled = !this.changed;
  }
}
