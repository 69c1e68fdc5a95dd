#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Builds the site of the documentation: build.py ROOT OUT

Copies the Markdown pages to OUT-source, with the same folders, and adds a page for each source file and
folder that a page links to. mkdocs makes OUT of them, Doxygen the reference of the SDK in OUT/api.
The navigation follows the tables of docs/README.md.
"""

import html
import json
import logging
import os
import pathlib
import re
import shutil
import subprocess
import sys

import mkdocs.commands.build
import mkdocs.config
import pygments
import pygments.formatters
import pygments.lexers
import pymdownx.slugs

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "tests/architecture"))
from documentation import FENCE, tracked  # noqa: E402

LINK = re.compile(r"(\]\(|(?:src|href)=\")([^)#\s\"]+)((?:#[^)\s\"]*)?[)\"])")
ENTRY = re.compile(r"\[([^\]]+)\]\(([^)#\s]+)\)")
QUESTIONS, QUESTION = "docs/README.md", re.compile(r"^\| (.+\?) \| (.+) \|$")
IMAGES = {".png", ".jpg", ".webp", ".svg", ".gif"}
LISTING = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>{path}</title><link rel="stylesheet" href="{home}site/listing.css"></head>
<body><p><a href="{home}index.html">Weft</a> / {path}</p>
{body}</body></html>
"""
MATHJAX = pathlib.Path("/usr/share/javascript/mathjax")
MATHJAX_PARTS = ["MathJax.js", "config/TeX-AMS_SVG.js", "extensions", "jax/element", "jax/input/TeX", "jax/output/SVG"]


class Stage:
    """The pages that mkdocs reads, under the paths of the repository."""

    def __init__(self, root, folder):
        self.root, self.folder = root, folder
        self.files = set(tracked(root, "*"))
        self.folders = {str(up) for file in self.files for up in pathlib.Path(file).parents}
        self.pages = {f for f in self.files if f.endswith(".md") and "/scaffold/" not in f}
        self.listings = {}  # file or folder -> page that shows it
        self.waiting = []
        self.questions = []  # frequent questions with their answers

    def write(self, page, text):
        file = self.folder / page
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")

    def target(self, path):
        """The file of the stage that a link to a path of the repository leads to, or None."""
        if path in self.pages:
            return path
        if path in self.folders:
            if f"{path}/README.md" in self.pages:
                return f"{path}/README.md"
            page = f"{path}/index.{'md' if self.is_role(path) else 'html'}"
        elif path not in self.files:
            return None
        elif pathlib.Path(path).suffix in IMAGES:
            if not (self.folder / path).exists():
                (self.folder / path).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(self.root / path, self.folder / path)
            return path
        else:
            page = re.sub(r"(^|/)\.", r"\1dot-", path) + ".html"  # mkdocs omits names with a dot
        if path not in self.listings:
            self.listings[path] = page
            self.waiting.append(path)
        return page

    def rewrite_links(self, page, line):
        """A line with its links to files and folders as links to pages; code spans stay."""
        folder = os.path.dirname(page)

        def replace(match):
            path = os.path.normpath(os.path.join(folder, match[2]))
            target = None if re.match(r"[a-z]+:", match[2]) else self.target(path)
            return match[0] if target is None else match[1] + os.path.relpath(target, folder or ".") + match[3]

        parts = re.split(r"(`+[^`]*`+)", line)
        return "".join(p if p.startswith("`") else LINK.sub(replace, p) for p in parts)

    def add_page(self, page):
        """Copies a page. Differences between GitHub's Markdown and that of mkdocs are settled here:
        blocks of math, lists in lists, which need four spaces, and tables below a paragraph."""
        out, fence, math, before = [], False, False, ""
        for line in (self.root / page).read_text(encoding="utf-8").splitlines():
            if FENCE.match(line):
                if line.strip() == "```math" or math:
                    math = not math
                    out.append("$$")
                    continue
                fence = not fence
            elif not fence and not math:
                line = self.rewrite_links(page, line)
                if page == QUESTIONS and (row := QUESTION.match(line)):
                    self.questions.append((row[1], re.sub(r"\]\([^)]*\)|[\[`]", "", row[2])))
                    line = f'| <a id="question-{len(self.questions)}"></a>{line[2:]}'
                line = re.sub(r"^ {2,3}(?=([-*]|\d+\.) )", "    ", line)
                if line.startswith("|") and before.strip() and not before.startswith("|"):
                    out.append("")
            out.append(line)
            before = line
        self.write(page, "\n".join(out) + "\n")

    def is_role(self, path):
        return re.fullmatch(r"plugins/\w+", path) is not None

    def add_listing(self, path):
        """A page with the text of a source file, or with the contents of a folder."""
        page = self.listings[path]
        if self.is_role(path):
            lines = [f"# {path}", ""]
            for plugin in sorted(p for p in self.pages if re.fullmatch(rf"{path}/\w+/README\.md", p)):
                name = plugin.split("/")[2]
                lines.append(f"- [{name}]({name}/README.md)")
            self.write(page, "\n".join(lines) + "\n")
            return
        if path in self.files:
            text = (self.root / path).read_text(encoding="utf-8", errors="replace")
            try:
                lexer = pygments.lexers.get_lexer_for_filename(path)
            except pygments.util.ClassNotFound:
                lexer = pygments.lexers.TextLexer()
            body = pygments.highlight(text, lexer, pygments.formatters.HtmlFormatter())
        else:
            names = sorted({f[len(path) + 1:].split("/")[0] for f in self.files if f.startswith(f"{path}/")})
            body = "<ul>" + "".join(f"<li>{html.escape(name)}</li>" for name in names) + "</ul>"
        home = "../" * page.count("/")
        self.write(page, LISTING.format(path=html.escape(path), home=home, body=body))

    def build(self):
        for page in sorted(self.pages):
            self.add_page(page)
        while self.waiting:
            self.add_listing(self.waiting.pop())
        (self.folder / "site").mkdir(parents=True)
        for name in ("style.css", "offline.js"):
            shutil.copy(HERE / name, self.folder / "site" / name)
        colours = [pygments.formatters.HtmlFormatter(style=style).get_style_defs(".highlight")
                   for style in ("default", "monokai")]
        self.write("site/listing.css", (HERE / "listing.css").read_text() + colours[0] +
                   "\n@media (prefers-color-scheme: dark) {\n" + colours[1] + "\n}\n")

    def sections(self, page):
        """The links in the tables of a page, by the heading above them."""
        found, heading = {}, ""
        for line in (self.root / page).read_text(encoding="utf-8").splitlines():
            if line.startswith("## "):
                heading = line[3:].strip()
            elif line.startswith("| ") and (entry := ENTRY.search(line.split("|")[1])):
                title = re.sub(r"`", "", entry[1])
                if re.fullmatch(r"\d{4}", title):  # a decision: its sentence is the title
                    title += " " + re.sub(r"[`\[\]]|\([^)]*\)", "", line.split("|")[2]).strip()
                path = os.path.normpath(os.path.join(os.path.dirname(page), entry[2]))
                if target := self.target(path):
                    found.setdefault(heading, []).append({title: target})
        return found

    def plugin_pages(self):
        for role in sorted(f.split("/")[1] for f in self.folders if re.fullmatch(r"plugins/\w+", f)):
            own = sorted(p for p in self.pages if re.fullmatch(rf"plugins/{role}/\w+/README\.md", p))
            if own and role != "common":
                index = self.target(f"plugins/{role}")
                yield {role: [index] + [{p.split("/")[2]: p} for p in own]}

    def navigation(self, with_api):
        kinds = self.sections("docs/README.md")
        taken = {path for entries in kinds.values() for entry in entries for path in entry.values()}
        decisions = self.sections("docs/decisions/README.md")
        evidence = self.sections("docs/evidence/README.md")
        rooms = sorted(p for p in self.pages if p.startswith(("framework/", "plugins/common", "tests/", "pipelines/"))
                       and p not in taken)
        apart = {"plugins/README.md", "docs/decisions/README.md", "docs/evidence/README.md"}
        kept = lambda kind: [e for e in kinds.get(kind, []) if not apart & set(e.values())]
        guides = kept("How-to guides")
        nav = [{"Home": ["README.md", {"Frequent questions": "docs/README.md"}]},
               {"Tutorials": kept("Tutorials")},
               {"How-to guides": [e for e in guides if "/examples/" not in str(e)] +
                [{"Examples": [e for e in guides if "/examples/" in str(e)]}]},
               {"Reference": kept("Reference") + ([{"C++ SDK": "sdk.md"}] if with_api else [])},
               {"Explanation": kept("Explanation") + [{"Folders of the source code": [
                   {os.path.dirname(p): p} for p in rooms]}]},
               {"Plugins": ["plugins/README.md", *self.plugin_pages()]},
               {"Decisions": ["docs/decisions/README.md"] + [e for s in decisions.values() for e in s]},
               {"Evidence": ["docs/evidence/README.md"] + [e for s in evidence.values() for e in s]}]
        return nav


def build_pages(stage, out, nav, with_api):
    if with_api:
        stage.write("sdk.md", "# C++ SDK\n\nReference of the headers in `framework/include/weft`, for "
                    "plugins and for programs that embed pipelines, by Doxygen.\n\n"
                    '<a href="api/annotated.html">Classes</a>, <a href="api/namespaceweft.html">functions and types of the namespace weft</a>, '
                    '<a href="api/namespaces.html">namespaces</a>.\n')
    logging.getLogger("mkdocs").setLevel(logging.WARNING)
    config = mkdocs.config.load_config(
        str(HERE / "mkdocs.yml"), docs_dir=str(stage.folder), site_dir=str(out), nav=nav)
    config["theme"].dirs.insert(0, str(HERE / "theme"))
    config["markdown_extensions"].append("toc")
    config["mdx_configs"]["toc"] = {"slugify": pymdownx.slugs.gfm, "permalink": True}
    mkdocs.commands.build.build(config)


def prune_search(stage, out):
    """Removes listings and empty sections from the search index, and adds the frequent questions.
    A script with the index serves pages from file://."""
    file = out / "search/search_index.json"
    index = json.loads(file.read_text(encoding="utf-8"))
    listed = {re.sub(r"\.md$", ".html", page) for page in stage.listings.values()}
    index["docs"] = [d for d in index["docs"] if d["location"].split("#")[0] not in listed and d["text"]]
    index["docs"] += [{"location": f"docs/index.html#question-{n}", "title": question.replace("`", ""), "text": answer}
                      for n, (question, answer) in enumerate(stage.questions, 1)]
    text = json.dumps(index, ensure_ascii=False, separators=(",", ":"))
    file.write_text(text, encoding="utf-8")
    (out / "search/search_index.js").write_text(f"__search={{index:Promise.resolve({text})}}", encoding="utf-8")


def copy_mathjax(out):
    if not MATHJAX.is_dir():
        print("no libjs-mathjax: formulas are shown as TeX")
        return
    for part in MATHJAX_PARTS:
        source, target = MATHJAX / part, out / "mathjax" / part
        target.parent.mkdir(parents=True, exist_ok=True)
        if source.is_dir():
            shutil.copytree(source, target, dirs_exist_ok=True)
        elif source.is_file():
            shutil.copy(source, target)


def build_api(root, out, log):
    settings = (HERE / "Doxyfile").read_text() + f"\nOUTPUT_DIRECTORY={out}\nWARN_LOGFILE={log}\n"
    subprocess.run(["doxygen", "-"], input=settings, text=True, cwd=root, check=True)
    warnings = [line for line in log.read_text().splitlines() if ": warning: " in line]
    parameters = sum("parameter" in line for line in warnings)
    print(f"SDK: {len(warnings)} warnings of Doxygen, {parameters} about parameters: {log}")


def main():
    if len(sys.argv) != 3:
        print(__doc__)
        return 2
    root, out = (pathlib.Path(a).resolve() for a in sys.argv[1:])
    if out.exists() and any(out.iterdir()) and not (out / "search").is_dir():
        print(f"{out} exists and is no site; choose another folder", file=sys.stderr)
        return 1
    stage = Stage(root, out.with_name(out.name + "-source"))
    with_api = shutil.which("doxygen") is not None
    shutil.rmtree(stage.folder, ignore_errors=True)
    navigation = stage.navigation(with_api)
    stage.build()
    build_pages(stage, out, navigation, with_api)
    prune_search(stage, out)
    copy_mathjax(out)
    if with_api:
        build_api(root, out, stage.folder / "doxygen.log")
    else:
        print("no doxygen: the site has no reference of the SDK")
    print(f"{len(stage.pages)} pages, {len(stage.listings)} listings of files and folders")
    return 0


if __name__ == "__main__":
    sys.exit(main())
