// SPDX-License-Identifier: Apache-2.0
// All settings of the run, stage by stage, the first few of them on top, and the search among them.
import { element } from "../../data.js";
import { ChangesPanel } from "./changes_panel.js";
import { Control } from "./control.js";
import { values_of } from "./difference.js";
import { Edits } from "./edits.js";
import { first_parameters } from "./parameters.js";

const kMostOpen = 30; // controls whose groups are open at the beginning

/** The structure of settings, without their values. */
function shape_of(stages, started) {
  const structure = stages.map(({ stage, id, changeable, why_not, parameters }) => [
    stage,
    id,
    changeable,
    why_not,
    parameters.map(({ setting }) => setting),
  ]);
  return JSON.stringify([structure, started]);
}

/** The stage whose shape the live view receives beside that of the frame, or null. */
export function other_stage_of(settings) {
  const sinks = settings?.sinks ?? [];
  const named = sinks.find(({ id, from }) => id === "sinks/live" && from.other_shape);
  return named?.from.other_shape ?? null;
}

export class Settings {
  #shape = null;
  #pipeline = "";
  #started = []; // stages as the run began
  // {stage, details, changed, controls: [{setting, control}], open: without a search}
  #groups = [];

  constructor(root, change_requests) {
    this.root = root;
    this.list = root.querySelector("#stages");
    this.search = root.querySelector("#search");
    this.search.addEventListener("input", () => this.#find());
    this.edits = new Edits(change_requests, () => this.panel.write_edits());
    this.panel = new ChangesPanel(root, this.edits, change_requests);
    this.panel.write_edits();
    addEventListener("keydown", (event) => this.#press(event));
  }

  /** Ctrl+Z and Ctrl+Shift+Z, but for texts that are being typed. */
  #press(event) {
    if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z") return;
    if (event.target.matches?.("input[type=text], input[type=number], input[type=search]")) return;
    event.preventDefault();
    if (event.shiftKey) this.edits.redo();
    else this.edits.undo();
  }

  /** Path of the run's pipeline file. */
  get pipeline() {
    return this.#pipeline;
  }

  /** A run began, with these settings; each may be null. */
  begin(settings, started) {
    this.#started = (started ?? settings)?.stages ?? [];
    this.edits.forget();
    this.show(settings);
  }

  /** The settings of the run as they are now, or null. */
  show(settings) {
    const stages = settings?.stages?.filter(({ parameters }) => parameters.length) ?? [];
    const shape = shape_of(stages, this.#started);
    if (shape !== this.#shape) {
      this.#shape = shape;
      this.#build(stages);
    } else {
      const parameters = stages.flatMap((stage) => stage.parameters);
      const by_setting = new Map(parameters.map((parameter) => [parameter.setting, parameter]));
      for (const { controls } of this.#groups) {
        for (const { setting, control } of controls) control.update(by_setting.get(setting));
      }
    }
    this.#count_changes();
    this.#pipeline = settings?.pipeline ?? "";
    this.panel.show({ pipeline: this.#pipeline, stages }, this.#started);
  }

  #build(stages) {
    const total = stages.reduce((sum, { parameters }) => sum + parameters.length, 0);
    this.#groups = stages.map((stage) => this.#group(stage, total <= kMostOpen));
    const first = first_parameters(stages);
    if (total > kMostOpen && first.length) {
      const stage = { stage: "", id: "", changeable: true, parameters: first };
      this.#groups.unshift({ ...this.#group(stage, true), is_first: true });
    }
    this.list.replaceChildren(...this.#groups.map(({ details }) => details));
    if (stages.length === 0) this.list.textContent = "The run reports no settings.";
    this.#find();
  }

  #group({ stage, id, summary, changeable, why_not, parameters }, open) {
    const changed = element("span", { className: "changes" });
    const title = element("span", { className: "stage", textContent: stage || "Main settings" });
    const head = element("summary", {}, title, element("code", { textContent: id }), changed);
    const started = values_of(this.#started);
    const controls = parameters.map((parameter) => {
      const { setting } = parameter;
      const name = stage ? setting.slice(stage.length + 1) : setting;
      const control = new Control(parameter, name, started.get(setting), this.edits);
      if (stage) control.element.style.setProperty("--depth", name.split(".").length - 1);
      return { setting, control };
    });
    const fields = element("fieldset", { disabled: !changeable });
    fields.append(element("legend", { className: "unseen", textContent: title.textContent }));
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
        if (fits && !group.is_first) ++found;
      }
      group.details.hidden = !any || (group.is_first && words.length > 0);
      group.details.open = words.length ? any : group.open;
    }
    const told = words.length === 0 ? "" : found ? `${found} found` : "No setting has this name.";
    this.root.querySelector("#found").textContent = told;
  }
}
