// SPDX-License-Identifier: Apache-2.0
// The control of one parameter, made from its declaration.
import { element } from "../data.js";
import {
  kind_of,
  range_words,
  same_value,
  shown_value,
  slider_of,
  requested_value,
} from "./parameters.js";
import { outcome_words } from "./words.js";

let count = 0; // of the ids of this page

export class Control {
  #parameter;
  #change_requests;
  #kind;
  #slider = null; // {input, places}
  #written = ""; // the text that the input held last, before somebody types on
  #value;

  /** `name` is what the parameter is called within its stage. */
  constructor(parameter, name, change_requests) {
    this.#parameter = parameter;
    this.#change_requests = change_requests;
    this.#kind = kind_of(parameter);
    this.#value = parameter.value;
    const id = `setting-${++count}`;
    this.input = this.#make_input(id);
    this.outcome = element("p", { className: "outcome" });
    this.outcome.setAttribute("role", "status");
    this.undo = element("button", {
      type: "button",
      className: "undo",
      textContent: "↺",
      title: `Back to ${shown_value(parameter.default)}`,
    });
    this.undo.setAttribute("aria-label", `${name}: back to the default`);
    this.undo.addEventListener("click", () => {
      this.#write(parameter.default);
      this.#want();
    });
    this.element = this.#make_element(id, name);
    this.#write(parameter.value);
    this.#mark();
  }

  get changed() {
    const { default: usual } = this.#parameter;
    return usual !== null && usual !== undefined && !same_value(this.#value, usual);
  }

  /** Whether all words are in what the control says of itself. */
  speaks_of(words) {
    const { setting, help, unit } = this.#parameter;
    const text = `${setting} ${help ?? ""} ${unit ?? ""}`.toLowerCase();
    return words.every((word) => text.includes(word));
  }

  /** The value that holds now; what somebody is about to change stays as it is. */
  update(value) {
    this.#value = value;
    this.#mark();
    const typing = document.activeElement === this.input && this.#text() !== this.#written;
    if (!typing && !this.#change_requests.pending(this.#parameter.setting)) this.#write(value);
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
    const { default: usual } = this.#parameter;
    const fixed = this.#kind === "shown" || usual === null || usual === undefined;
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
    const { setting } = this.#parameter;
    this.#speak();
    this.#written = this.#text();
    const value = requested_value(this.#parameter, this.#text());
    if (value === null) {
      const wanted = this.#kind === "list" ? "numbers, with commas between them" : "a number";
      this.#say(`not sent: this takes ${wanted}`, true);
      return;
    }
    this.#change_requests.want(setting, `set ${setting}=${value}`, (told) => {
      const failed = told.outcome === "refused" || told.outcome === "unsent";
      this.#say(outcome_words(told), failed);
      if (failed && !this.#change_requests.pending(setting)) this.#write(this.#value);
    });
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
