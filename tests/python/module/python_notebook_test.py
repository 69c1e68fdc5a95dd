#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Executes the notebook of docs/examples: python_notebook_test.py WEFT ROOT [--write]

Compares the kinds of its outputs with those that are stored, as times differ; --write stores new ones.
"""

import os
import pathlib
import sys
import tempfile

import nbclient
import nbformat

WEFT, ROOT = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
NOTEBOOK = ROOT / "docs/examples/python_module/runs_and_shapes.ipynb"
MOST_BYTES = 100_000


def kinds_of(notebook):
    """The media types of each cell's outputs."""
    return [[sorted(output.get("data", {output.output_type: None})) for output in cell.outputs]
            for cell in notebook.cells if cell.cell_type == "code"]


def main():
    stored = nbformat.read(NOTEBOOK, as_version=4)
    executed = nbformat.read(NOTEBOOK, as_version=4)
    os.environ["PATH"] = f"{WEFT.parent}{os.pathsep}{os.environ['PATH']}"
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(folder) / NOTEBOOK.parent.relative_to(ROOT)
        place.mkdir(parents=True)
        (pathlib.Path(folder) / "pipelines").symlink_to(ROOT / "pipelines")
        nbclient.NotebookClient(executed, timeout=600, kernel_name="python3",
                                resources={"metadata": {"path": str(place)}}).execute()
    for cell in executed.cells:
        cell.metadata.pop("execution", None)  # its times
    if "--write" in sys.argv:
        nbformat.write(executed, NOTEBOOK)
        return 0
    assert kinds_of(executed) == kinds_of(stored), f"run it with --write: {kinds_of(executed)}"
    assert NOTEBOOK.stat().st_size < MOST_BYTES, f"the notebook has {NOTEBOOK.stat().st_size} bytes"
    tables = [output.data["text/html"] for cell in executed.cells if cell.cell_type == "code"
              for output in cell.outputs if "text/html" in output.get("data", {})]
    for expected in ("4 estimated", "stage", "4 done"):
        assert any(expected in table for table in tables), f"no output has '{expected}'"
    return 0


if __name__ == "__main__":
    sys.exit(main())
