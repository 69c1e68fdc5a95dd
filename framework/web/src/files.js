// SPDX-License-Identifier: Apache-2.0
// Files that the browser saves.
import { element } from "./data.js";

const kKept_ms = 60000; // until the browser has surely begun to save

/** Saves a Blob as a file of that name, where the browser keeps such. */
export function save_file(content, name) {
  const address = URL.createObjectURL(content);
  element("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), kKept_ms);
}
