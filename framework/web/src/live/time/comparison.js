// SPDX-License-Identifier: Apache-2.0
// Two moments in numbers, one beside the other.
import { element } from "../../data.js";
import { percent } from "../words.js";

const known = (shown) => (value) => (Number.isFinite(value) ? shown(value) : "–");
const number = (digits, unit) => known((value) => `${value.toFixed(digits)}${unit}`);
const kRows = [
  { name: "state", of: ({ state }) => state, shown: String },
  { name: "confidence", of: ({ confidence }) => confidence, shown: known(percent) },
  { name: "kept matches", of: ({ kept }) => kept, shown: number(0, "") },
  { name: "median standard deviation", of: ({ std_median_mm }) => std_median_mm, shown: number(2, " mm") },
  { name: "stages", of: ({ total_ms }) => total_ms, shown: number(1, " ms") },
];

/** Writes a table of two samples of the history; without `other` it is hidden. */
export function write_comparison(table, other, sample) {
  table.hidden = !other || !sample;
  if (table.hidden) return;
  const cell = (name, textContent, more = {}) => element(name, { textContent, ...more });
  const heads = ["moment", ...kRows.map(({ name }) => name)].map((name) => cell("th", name, { scope: "col" }));
  table.tHead.replaceChildren(element("tr", {}, ...heads));
  const row = (words, each) =>
    element(
      "tr",
      {},
      cell("th", words, { scope: "row" }),
      ...kRows.map(({ of, shown }) => cell("td", shown(of(each)))),
    );
  table.tBodies[0].replaceChildren(
    row(`frame ${other.frame}`, other),
    row(`frame ${sample.frame}`, sample),
  );
}
