// SPDX-License-Identifier: Apache-2.0
// The settings that differ from those with which the run began, and a pipeline file of them.
import { base_of } from "../saving/base.js";
import { same_value } from "./parameters.js";

/** Of the stages of `run_settings` each changed parameter: {stage, parameter, before}; `started` are
    the stages as the run began. */
export function difference_of(stages, started) {
  const before_of = values_of(started);
  return stages.flatMap(({ stage, parameters }) =>
    parameters
      .filter(({ setting, value }) => {
        return before_of.has(setting) && !same_value(value, before_of.get(setting));
      })
      .map((parameter) => ({ stage, parameter, before: before_of.get(parameter.setting) })),
  );
}

export function values_of(stages) {
  const parameters = stages.flatMap((stage) => stage.parameters);
  return new Map(parameters.map(({ setting, value }) => [setting, value]));
}

const quoted = (value) => JSON.stringify(value);

/** `params` of a stage as YAML in one line; nested components have params of their own. */
function flow(node) {
  const entries = Object.entries(node).map(([name, value]) => {
    if (!(value instanceof Nested)) return `${name}: ${quoted(value)}`;
    return `${name}: {use: ${value.use}, params: ${flow(value.params)}}`;
  });
  return `{${entries.join(", ")}}`;
}

class Nested {
  params = {};
  constructor(use) {
    this.use = use;
  }
}

/** A pipeline file that extends that of the run by the changed settings. */
export function pipeline_of({ pipeline, stages }, changes) {
  const component_of = values_of(stages);
  const by_stage = new Map();
  for (const { stage, parameter } of changes) {
    if (!by_stage.has(stage)) by_stage.set(stage, {});
    const names = parameter.setting.slice(stage.length + 1).split(".");
    let node = by_stage.get(stage);
    names.slice(0, -1).forEach((name, depth) => {
      const setting = [stage, ...names.slice(0, depth + 1)].join(".");
      node[name] ??= new Nested(component_of.get(setting));
      node = node[name].params;
    });
    node[names.at(-1)] = parameter.value;
  }
  const { base, folder } = base_of(pipeline);
  const entries = [...by_stage].map(
    ([stage, params]) => `  - {as: ${quoted(stage)}, params: ${flow(params)}}\n`,
  );
  return (
    `# Settings of the live view.${folder ? ` Keep this file in ${folder}.` : ""}\n` +
    `weft: 1\nextends: ${quoted(base)}\n${entries.length ? "stages:\n" : ""}${entries.join("")}`
  );
}
