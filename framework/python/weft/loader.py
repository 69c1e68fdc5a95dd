# SPDX-License-Identifier: Apache-2.0
"""Imports the modules that travel in a library; run by it once, with nothing else of `weft` there."""

import importlib
import importlib.machinery
import sys
import traceback


class Travelling:
    """Finds modules among sources (name, file, text, is a package, is the author's)."""

    def __init__(self, sources):
        self.sources = {source[0]: source for source in sources}

    def find_spec(self, name, path=None, target=None):
        source = self.sources.get(name)
        if source is None:
            return None
        return importlib.machinery.ModuleSpec(name, self, origin=source[1], is_package=bool(source[3]))

    def create_module(self, spec):
        return None

    def exec_module(self, module):
        source = self.sources[module.__name__]
        exec(compile(source[2], source[1], "exec"), module.__dict__)


def imported(source):
    """An author's module, or an error with the position of its failure."""
    try:
        return importlib.import_module(source[0])
    except BaseException as thrown:
        lines = [line for frame, line in traceback.walk_tb(thrown.__traceback__)
                 if frame.f_code.co_filename == source[1]]
        place = f" ({source[1]}:{lines[-1]})" if lines else ""
        raise ImportError(f"{type(thrown).__name__}: {thrown}{place}") from None


def load(sources, host):
    """The module weft.bridge of these sources, with the author's modules imported. Libraries in one
    process may bring modules of the same name: each sees its own."""
    finder = Travelling(sources)
    names = [*finder.sources, "weft.host"]
    others = {name: sys.modules.pop(name) for name in names if name in sys.modules}
    sys.meta_path.insert(0, finder)
    sys.modules["weft.host"] = host
    try:
        try:
            import numpy  # noqa: F401
        except ImportError as missing:
            raise ImportError(f"components in Python need NumPy (Debian: python3-numpy): {missing}") from None
        bridge = importlib.import_module("weft.bridge")
        for source in sources:
            if source[4]:
                bridge.adopt(source[0], source[1], imported(source))
        return bridge
    finally:
        if others:
            sys.meta_path.remove(finder)
            for name in names:
                sys.modules.pop(name, None)
            sys.modules.update(others)
