# SPDX-License-Identifier: Apache-2.0
# What framework/python/module compiles.
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

class OpenedPipeline:
    def __init__(self, file: str, camera: tuple[float, float, float, float, int, int], settings: Sequence[str],
                 plugin_path: Sequence[str], worker: str) -> None: ...
    def template(self) -> dict[str, NDArray[Any]]: ...
    def process(self, pixels: NDArray[np.uint8], t_s: float) -> dict[str, Any]: ...
    def close(self) -> None: ...
