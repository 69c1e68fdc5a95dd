// SPDX-License-Identifier: Apache-2.0
// Bundles src/ into dist/: the script of reports, and script, style and page of the live view. Each
// script is a classic one without any import. The licences of what is bundled go to
// dist/licences.txt, and for the live view into its page.
import { build } from "esbuild";
import { mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import path from "node:path";

const here = path.dirname(fileURLToPath(import.meta.url));
process.chdir(here);
mkdirSync("dist", { recursive: true });

/** The text of a bundle, and the names of the packages in it. */
async function bundled(entry) {
  const { metafile, outputFiles } = await build({
    entryPoints: [entry],
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
  for (const file of Object.keys(metafile.inputs)) {
    const found = file.match(/^node_modules\/((?:@[^/]+\/)?[^/]+)\//);
    if (found) packages.add(found[1]);
  }
  return { text: outputFiles[0].text, packages };
}

function licence_of(name) {
  const folder = path.join("node_modules", name);
  const { version, license } = JSON.parse(readFileSync(path.join(folder, "package.json"), "utf8"));
  const file = readdirSync(folder).find((entry) => /^licen[cs]e/i.test(entry));
  const text = file ? readFileSync(path.join(folder, file), "utf8").trim() : "";
  return { title: `${name} ${version} (${license})`, text };
}

/** Packages that share a text, such as the parts of Vega or of D3, share its copy. */
function licences_of(packages) {
  const titles_by_text = new Map();
  for (const name of [...packages].sort()) {
    const { title, text } = licence_of(name);
    titles_by_text.set(text, [...(titles_by_text.get(text) ?? []), title]);
  }
  const parts = [...titles_by_text].map(([text, titles]) => `${titles.join("\n")}\n\n${text}\n`);
  return parts.join(`\n${"-".repeat(72)}\n\n`);
}

function write(file, text, packages) {
  writeFileSync(`dist/${file}`, text);
  const kinds = packages ? `, ${packages.size} packages` : "";
  console.log(`dist/${file}: ${(text.length / 1e6).toFixed(2)} MB${kinds}`);
}

const report = await bundled("src/main.js");
if (/<\/script|<!--/i.test(report.text))
  throw new Error("the bundle would end the element it stands in");
write("report.js", report.text, report.packages);
writeFileSync("dist/licences.txt", licences_of(report.packages));

const live = await bundled("src/live/main.js");
write("live.js", live.text, live.packages);
write("live.css", (await bundled("src/live.css")).text);
const escaped = licences_of(live.packages).replaceAll("&", "&amp;").replaceAll("<", "&lt;");
const place = "<!-- licences -->";
const page = readFileSync("src/live.html", "utf8");
if (!page.includes(place)) throw new Error(`src/live.html has no place for licences: ${place}`);
write("live.html", page.replace(place, () => escaped));
