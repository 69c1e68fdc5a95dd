// SPDX-License-Identifier: Apache-2.0
// Bundles src/ into dist/report.js: one classic script without any import, fit to stand inside a
// page. The licences of all that is bundled go to dist/licences.txt.
import { build } from "esbuild";
import { mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import path from "node:path";

const here = path.dirname(fileURLToPath(import.meta.url));
process.chdir(here);

const bundle = await build({
  entryPoints: ["src/main.js"],
  bundle: true,
  minify: true,
  format: "iife",
  target: ["chrome100", "firefox100", "safari15.4"],
  legalComments: "none",
  charset: "ascii",
  metafile: true,
  write: false,
});

const packages = new Set();
for (const file of Object.keys(bundle.metafile.inputs)) {
  const found = file.match(/^node_modules\/((?:@[^/]+\/)?[^/]+)\//);
  if (found) packages.add(found[1]);
}

function licence_of(name) {
  const folder = path.join("node_modules", name);
  const { version, license } = JSON.parse(readFileSync(path.join(folder, "package.json"), "utf8"));
  const file = readdirSync(folder).find((entry) => /^licen[cs]e/i.test(entry));
  const text = file ? readFileSync(path.join(folder, file), "utf8").trim() : "";
  return { title: `${name} ${version} (${license})`, text };
}

// Packages that share a text, such as the parts of Vega or of D3, share its copy.
const titles_by_text = new Map();
for (const name of [...packages].sort()) {
  const { title, text } = licence_of(name);
  titles_by_text.set(text, [...(titles_by_text.get(text) ?? []), title]);
}
const licences = [...titles_by_text].map(([text, titles]) => `${titles.join("\n")}\n\n${text}\n`);

mkdirSync("dist", { recursive: true });
const script = bundle.outputFiles[0].text;
if (/<\/script|<!--/i.test(script))
  throw new Error("the bundle would end the element it stands in");
writeFileSync("dist/report.js", script);
writeFileSync("dist/licences.txt", licences.join(`\n${"-".repeat(72)}\n\n`));
console.log(`dist/report.js: ${(script.length / 1e6).toFixed(2)} MB, ${packages.size} packages`);
