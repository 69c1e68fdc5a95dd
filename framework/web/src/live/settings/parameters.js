// SPDX-License-Identifier: Apache-2.0
// What a parameter's declaration requires of its control: kind, range, slider, and the text of a
// change request.

const kSliderSteps = 1000;
const kDigits = 3;
const kSmallShare = 0.02; // of its range, below which a default would hide at the slider's end
const kShown = new Set(["component", "input_path", "output_path", "labels"]);

/** "shown" (not changed here), "flag", "choice", "number", "list" or "text". */
export function kind_of({ type, is_vector }) {
  if (kShown.has(type)) return "shown";
  if (is_vector) return "list";
  if (type === "bool") return "flag";
  if (type === "choice") return "choice";
  return type === "text" ? "text" : "number";
}

/** A value as a person writes it. */
export function shown_value(value) {
  if (value === null || value === undefined) return "";
  return Array.isArray(value) ? value.map(String).join(", ") : String(value);
}

export const same_value = (a, b) => JSON.stringify(a) === JSON.stringify(b);

/** Range and default in words. */
export function range_words({ type, minimum, maximum, default: usual }) {
  const low = Number.isFinite(minimum);
  const high = Number.isFinite(maximum);
  const bounds = [low && `at least ${minimum}`, high && `at most ${maximum}`];
  const range = low && high ? [`${minimum} to ${maximum}`] : bounds;
  const what = type === "bool" ? (usual ? "on" : "off") : shown_value(usual);
  return [...range, what && `default ${what}`].filter(Boolean).join(", ");
}

/** A slider for a number with both bounds, else null: {steps, value_at(place), place_of(value)}
    with places 0 to `steps`. Where the default is tiny beside the range, it lies in the middle. */
export function slider_of(parameter) {
  const { type, minimum, maximum, default: usual } = parameter;
  if (kind_of(parameter) !== "number") return null;
  if (!Number.isFinite(minimum) || !Number.isFinite(maximum) || minimum >= maximum) return null;
  const span = maximum - minimum;
  const whole = type === "i64";
  const share = (usual - minimum) / span;
  const curved = share > 0 && share < kSmallShare;
  const power = curved ? Math.log(share) / Math.log(0.5) : 1;
  const steps = whole && !curved && span <= kSliderSteps ? span : kSliderSteps;
  const value_at = (place) => {
    const exact = minimum + span * (place / steps) ** power;
    const rounded = whole ? Math.round(exact) : Number(exact.toPrecision(kDigits));
    return Math.min(maximum, Math.max(minimum, rounded));
  };
  const place_of = (value) => {
    const part = Math.min(1, Math.max(0, (value - minimum) / span));
    return Math.round(steps * part ** (1 / power));
  };
  return { steps, value_at, place_of };
}

function element_text(type, text) {
  if (type === "choice" || type === "text") return JSON.stringify(text);
  if (type === "bool") return text === "true" || text === "false" ? text : null;
  return text !== "" && Number.isFinite(Number(text)) ? text : null;
}

/** The value of a change request, as `weft run --set` takes it, of what a control holds; null where
    that is no value of the parameter's type. */
export function requested_value({ type, is_vector }, text) {
  if (!is_vector) return element_text(type, type === "text" ? text : text.trim());
  const inner = text.trim().replace(/^\[|\]$/g, "").trim();
  const parts = inner === "" ? [] : inner.split(",").map((part) => element_text(type, part.trim()));
  return parts.includes(null) ? null : `[${parts.join(", ")}]`;
}

const kFirst = 5;

/** The parameters to show on top: of the stages that can change, those that their components declare
    as prominent, else the first of each stage that the pipeline sets, or that is declared. */
export function first_parameters(stages) {
  const of_stages = stages
    .filter(({ changeable }) => changeable)
    .map(({ parameters }) => parameters.filter((each) => kind_of(each) !== "shown"));
  const is_set = ({ value, default: usual }) => !same_value(value, usual);
  const others = of_stages
    .filter((parameters) => !parameters.some((each) => each.is_prominent))
    .map((parameters) => parameters.find(is_set) ?? parameters[0])
    .filter(Boolean);
  const prominent = of_stages.flatMap((each) => each.filter(({ is_prominent }) => is_prominent));
  return [...prominent, ...others].slice(0, kFirst);
}
