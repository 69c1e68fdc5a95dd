// SPDX-License-Identifier: Apache-2.0
// Sorting and filtering of the tables, which the program has written whole.
import { element } from "./data.js";

/** What a cell sorts by: its data-value, else its text. */
function key_of(row, column) {
  const cell = row.cells[column];
  const text = cell?.dataset.value ?? cell?.textContent.trim() ?? "";
  const number = Number(text);
  return text !== "" && !Number.isNaN(number) ? number : text;
}

/** Numbers before texts, texts in natural order, nothing last whatever the direction. */
function compare(a, b, direction) {
  if (a === "" || b === "") return (a === "") - (b === "");
  if (typeof a === "number" && typeof b === "number") return direction * (a - b);
  if (typeof a !== typeof b) return typeof a === "number" ? -1 : 1;
  return direction * String(a).localeCompare(String(b), "en", { numeric: true });
}

function sort_by(table, heading) {
  const column = heading.cellIndex;
  const ascending = heading.getAttribute("aria-sort") !== "ascending";
  for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
  heading.setAttribute("aria-sort", ascending ? "ascending" : "descending");
  const body = table.tBodies[0];
  const rows = [...body.rows].map((row) => ({ row, key: key_of(row, column) }));
  rows.sort((a, b) => compare(a.key, b.key, ascending ? 1 : -1));
  body.append(...rows.map(({ row }) => row));
}

export function sort_tables() {
  for (const table of document.querySelectorAll("table.sortable")) {
    for (const heading of table.tHead.rows[0].cells) {
      if (heading.textContent.trim() === "") continue;
      const button = element("button", { type: "button", className: "sort" });
      button.append(...heading.childNodes);
      button.addEventListener("click", () => sort_by(table, heading));
      heading.append(button);
    }
  }
}

/** A field above each long table that shows only the rows that hold all of its words. */
export function filter_tables() {
  const kLongRows = 12;
  for (const table of document.querySelectorAll("table.sortable")) {
    const rows = [...table.tBodies[0].rows];
    if (rows.length <= kLongRows) continue;
    const field = element("input", {
      type: "search",
      className: "filter",
      placeholder: `Filter ${rows.length} rows`,
      ariaLabel: "Show only rows with these words",
    });
    field.addEventListener("input", () => {
      const words = field.value.toLowerCase().split(/\s+/);
      for (const row of rows) {
        const text = row.textContent.toLowerCase();
        row.hidden = !words.every((word) => text.includes(word));
      }
    });
    table.closest(".scroll").before(field);
  }
}

/** A click on a command copies it, where the browser lets a page do so. */
export function copy_commands() {
  document.addEventListener("click", async ({ target }) => {
    const code = target.closest("code.command");
    if (!code) return;
    try {
      await navigator.clipboard.writeText(code.textContent);
      code.title = "Copied";
    } catch {
      getSelection().selectAllChildren(code);
    }
  });
}
