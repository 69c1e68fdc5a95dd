#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the curves of trainings: curve.py FOLDER... --out page.html or figure.svg; --markdown prints a table."""

import argparse
import html
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from weft_learning.curves import markdown, read_curve, svg  # noqa: E402
from weft_learning.errors import InputError  # noqa: E402


def main() -> int:
    """0 done, 2 for wrong input."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", type=Path, nargs="+", help="--out of train.py")
    parser.add_argument("--out", type=Path, help="page (.html) or figure (.svg)")
    parser.add_argument("--markdown", action="store_true", help="print the validation metrics as a table")
    options = parser.parse_args()
    if not options.out and not options.markdown:
        parser.error("give --out, --markdown or both")
    if options.out and options.out.suffix not in (".html", ".svg"):
        parser.error(f"--out {options.out}: end the name in .html or .svg")
    try:
        curves = {str(folder): read_curve(folder) for folder in options.folders}
    except InputError as error:
        print(f"curve.py: {error}", file=sys.stderr)
        return 2
    table = markdown(curves)
    if options.markdown:
        print(table, end="")
    if options.out:
        figure = svg(curves)
        if options.out.suffix == ".html":
            figure = figure[figure.index("<svg"):]
            figure = ("<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Training</title>\n"
                      f"<body>{figure}<pre>{html.escape(table)}</pre></body></html>\n")
        options.out.write_text(figure, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
