#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the links of a site: check_links.py FOLDER

Each href and src that stays in the site must lead to a file in it, and to an element with that id.
Links to other servers are not followed.
"""

import functools
import html.parser
import pathlib
import sys
import urllib.parse

# Anchors that mkdocs-material and Doxygen link to and sometimes omit.
KNOWN = {"__skip", "nested-classes"}


class Page(html.parser.HTMLParser):
    """The ids and links of a page."""

    def __init__(self, file):
        super().__init__()
        self.ids, self.links = set(), set()
        self.feed(file.read_text(encoding="utf-8", errors="replace"))

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id" or (name == "name" and tag == "a"):
                self.ids.add(value)
            elif name in ("href", "src") and value and tag != "base":
                self.links.add(value)


page_of = functools.lru_cache(maxsize=None)(Page)


def problems(root):
    for file in sorted(root.rglob("*.html")):
        for link in sorted(page_of(file).links):
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            path, anchor = urllib.parse.unquote(parts.path), urllib.parse.unquote(parts.fragment)
            base = root if path.startswith("/") else file.parent
            target = (base / path.lstrip("/")).resolve() if path else file
            if target.is_dir():
                target /= "index.html"
            name = f"{file.relative_to(root)}: {link}"
            if not target.is_relative_to(root) or not target.is_file():
                yield f"{name}: there is no such file"
            elif anchor and target.suffix == ".html" and anchor not in page_of(target).ids | KNOWN:
                yield f"{name}: the page has no such anchor"


def main():
    if len(sys.argv) != 2:
        print(__doc__)
        return 2
    root = pathlib.Path(sys.argv[1]).resolve()
    found = list(problems(root))
    links = sum(len(page_of(file).links) for file in root.rglob("*.html"))
    print("\n".join(found) if found else f"{links} links hold")
    return 1 if found or links == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
