// SPDX-License-Identifier: Apache-2.0
// All settings of the run, stage by stage, and the search among them.
import { element } from "../data.js";
import { Control } from "./control.js";

const kMostOpen = 30; // controls that stand open at the beginning

/** What a set of settings is made of, whatever its values are. */
function shape_of({ stages }) {
  return JSON.stringify(
    stages.map(({ stage, id, changeable, why_not, parameters }) => [
      stage,
      id,
      changeable,
      why_not,
      parameters.map(({ setting }) => setting),
    ]),
  );
}

export class Settings {
  #shape = null;
  // {stage, details, changed, controls: [{setting, control}], open: without a search}
  #groups = [];

  constructor(root, change_requests) {
    this.root = root;
    this.change_requests = change_requests;
    this.list = root.querySelector("#stages");
    this.search = root.querySelector("#search");
    this.search.addEventListener("input", () => this.#find());
  }

  /** The settings of a run as they hold now, or null. */
  show(settings) {
    const stages = settings?.stages?.filter(({ parameters }) => parameters.length) ?? [];
    const shape = shape_of({ stages });
    if (shape !== this.#shape) {
      this.#shape = shape;
      this.#build(stages);
    } else {
      const parameters = stages.flatMap((stage) => stage.parameters);
      const values = new Map(parameters.map(({ setting, value }) => [setting, value]));
      for (const { controls } of this.#groups) {
        for (const { setting, control } of controls) control.update(values.get(setting));
      }
    }
    this.#count_changes();
  }

  #build(stages) {
    const total = stages.reduce((sum, { parameters }) => sum + parameters.length, 0);
    this.#groups = stages.map((stage) => this.#group(stage, total <= kMostOpen));
    this.list.replaceChildren(...this.#groups.map(({ details }) => details));
    if (stages.length === 0) this.list.textContent = "The run tells none.";
    this.#find();
  }

  #group({ stage, id, summary, changeable, why_not, parameters }, open) {
    const changed = element("span", { className: "changes" });
    const head = element(
      "summary",
      {},
      element("span", { className: "stage", textContent: stage }),
      element("code", { textContent: id }),
      changed,
    );
    const controls = parameters.map((parameter) => {
      const name = parameter.setting.slice(stage.length + 1);
      const control = new Control(parameter, name, this.change_requests);
      control.element.style.setProperty("--depth", name.split(".").length - 1);
      return { setting: parameter.setting, control };
    });
    const fields = element("fieldset", { disabled: !changeable });
    fields.append(element("legend", { className: "unseen", textContent: stage }));
    if (summary) fields.append(element("p", { className: "about", textContent: summary }));
    if (!changeable) fields.append(element("p", { className: "why-not", textContent: why_not }));
    fields.append(...controls.map(({ control }) => control.element));
    const details = element("details", { open }, head, fields);
    const group = { stage: `${stage} ${id}`.toLowerCase(), details, changed, controls, open };
    details.addEventListener("toggle", () => {
      if (this.search.value.trim() === "") group.open = details.open;
    });
    return group;
  }

  #count_changes() {
    for (const { changed, controls } of this.#groups) {
      const count = controls.filter(({ control }) => control.changed).length;
      changed.textContent = count ? `${count} changed` : "";
    }
  }

  /** Shows what has all words of the search in its own name and help, or in its stage's name. */
  #find() {
    const words = this.search.value.toLowerCase().split(/\s+/).filter(Boolean);
    let found = 0;
    for (const group of this.#groups) {
      const rest = words.filter((word) => !group.stage.includes(word));
      let any = false;
      for (const { control } of group.controls) {
        const fits = control.speaks_of(rest);
        control.element.hidden = !fits;
        any ||= fits;
        if (fits) ++found;
      }
      group.details.hidden = !any;
      group.details.open = words.length ? any : group.open;
    }
    const told = words.length === 0 ? "" : found ? `${found} found` : "Nothing is called so.";
    this.root.querySelector("#found").textContent = told;
  }
}
