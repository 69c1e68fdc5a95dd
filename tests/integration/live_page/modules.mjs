// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import path from "node:path";
import { pathToFileURL } from "node:url";

/** Loads parts of the live page by their names from the folder `web`. */
export const module_loader = (web) => (name) =>
  import(pathToFileURL(path.resolve(web, "src/live", `${name}.js`)).href);

export const close = (a, b, tolerance) =>
  assert.ok(Math.abs(a - b) <= tolerance, `${a} is not ${b}`);
