// SPDX-License-Identifier: Apache-2.0
// Undo and redo, the difference to the file, presets, and saving as a pipeline file.
import { element } from "../../data.js";
import { save_file } from "../../files.js";
import { recall, remember } from "../layout/memory.js";
import { saved_words } from "../words.js";
import { difference_of, pipeline_of, values_of } from "./difference.js";
import { same_value, shown_value } from "./parameters.js";

function button(words, label, act) {
  const node = element("button", { type: "button", textContent: words });
  node.setAttribute("aria-label", label);
  node.addEventListener("click", act);
  return node;
}

export class ChangesPanel {
  #edits;
  #change_requests;
  #settings = { pipeline: "", stages: [] };
  #started = []; // stages as the run began
  #shown = null; // text of the shown difference

  constructor(root, edits, change_requests) {
    this.#edits = edits;
    this.#change_requests = change_requests;
    const part = (name) => root.querySelector(name);
    this.undo = part("#undo");
    this.redo = part("#redo");
    this.save = part("#save-yaml");
    this.saved = part("#saved");
    this.count = part("#difference .count");
    this.list = part("#difference ul");
    this.back = part("#back-to-file");
    this.presets = part("#presets ul");
    this.undo.addEventListener("click", () => edits.undo());
    this.redo.addEventListener("click", () => edits.redo());
    this.save.addEventListener("click", () => this.#save());
    part("#save-in-run").addEventListener("click", () => this.save_in_run());
    this.back.addEventListener("click", () => this.#apply({}));
    part("#presets form").addEventListener("submit", (event) => {
      event.preventDefault();
      this.#keep(new FormData(event.target).get("name").trim());
      event.target.reset();
    });
  }

  /** The settings as they are, and the stages as the run began. */
  show(settings, started) {
    this.#settings = settings;
    this.#started = started;
    this.#write_difference();
    this.#write_presets();
  }

  write_edits() {
    this.undo.disabled = !this.#edits.can_undo;
    this.redo.disabled = !this.#edits.can_redo;
  }

  get #changes() {
    return difference_of(this.#settings.stages, this.#started);
  }

  #write_difference() {
    const changes = this.#changes;
    const text = JSON.stringify(changes.map(({ parameter, before }) => [parameter, before]));
    if (text === this.#shown) return; // its buttons keep the focus
    this.#shown = text;
    this.count.textContent = changes.length || "none";
    this.save.disabled = changes.length === 0;
    this.back.disabled = changes.length === 0;
    this.list.replaceChildren(
      ...changes.map(({ parameter, before }) => {
        const { setting, value } = parameter;
        const words = `${setting}: ${shown_value(before)} → ${shown_value(value)} `;
        const text = shown_value(before);
        const back = () => this.#edits.request(parameter, text, () => {});
        return element("li", {}, words, button("Back", `${setting}: back to ${text}`, back));
      }),
    );
  }

  #save() {
    const text = pipeline_of(this.#settings, this.#changes);
    const name = this.#settings.pipeline.split("/").at(-1).replace(/\.ya?ml$/, "");
    save_file(new Blob([text], { type: "application/yaml" }), `${name}_live.yaml`);
  }

  /** The run writes its pipeline, with all settings as they are, into its folder. */
  save_in_run() {
    this.#change_requests.now("save", (told) => {
      this.saved.value = saved_words(told);
      this.saved.classList.toggle("bad", told.outcome === "refused" || told.outcome === "unsent");
    });
  }

  get #place() {
    return `presets.${this.#settings.pipeline}`;
  }

  #keep(name) {
    if (!name) return;
    const values = this.#changes.map(({ parameter: { setting, value } }) => [setting, value]);
    remember(this.#place, { ...recall(this.#place, {}), [name]: Object.fromEntries(values) });
    this.#write_presets();
  }

  #write_presets() {
    const presets = recall(this.#place, {});
    this.presets.replaceChildren(
      ...Object.entries(presets).map(([name, values]) => {
        const apply = button("Apply", `Apply ${name}`, () => this.#apply(values));
        const remove = button("Delete", `Delete ${name}`, () => {
          const { [name]: _, ...rest } = recall(this.#place, {});
          remember(this.#place, rest);
          this.#write_presets();
        });
        return element("li", {}, `${name} `, apply, remove);
      }),
    );
  }

  /** Requests these values, and those of the file for all other settings. */
  #apply(values) {
    const group = this.#edits.new_group();
    const before_of = values_of(this.#started);
    for (const { changeable, parameters } of this.#settings.stages) {
      if (!changeable) continue;
      for (const parameter of parameters) {
        const { setting } = parameter;
        const wanted = setting in values ? values[setting] : before_of.get(setting);
        if (wanted === undefined || same_value(wanted, parameter.value)) continue;
        this.#edits.request(parameter, shown_value(wanted), () => {}, group);
      }
    }
  }
}
