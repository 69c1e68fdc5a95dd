# SPDX-License-Identifier: Apache-2.0
"""Records: arrays by name, as docs/records.md lists them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any


class Record:
    """`Record(kept=mask, score=score, diag={"rounds": 3})`.

    Its attributes are NumPy arrays, numbers and texts; `diag` and `model` are dicts of arrays and
    numbers, without `diag.` and `model.` in their names. Of a record of the host the arrays are views
    of its memory: read-only, and valid until the method returns.
    """

    def __init__(self, *, diag: dict[str, Any] | None = None, model: dict[str, Any] | None = None,
                 **arrays: Any) -> None:
        self.diag = dict(diag or {})
        self.model = dict(model or {})
        self.__dict__.update(arrays)
        self.degenerate_reason = ""  # of what another component answered

    if TYPE_CHECKING:
        def __getattr__(self, name: str) -> Any: ...
        def __setattr__(self, name: str, value: Any) -> None: ...

    def __repr__(self) -> str:
        names = sorted(set(vars(self)) - {"diag", "model", "degenerate_reason"})
        return f"Record({', '.join(names)})"
