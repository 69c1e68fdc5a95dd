# SPDX-License-Identifier: Apache-2.0
"""A filter that says when it is called, and goes on when it may."""

import pathlib
import threading
import time

import numpy as np
import weft


class Waiting(weft.Filter):
    """Makes a file when it is called, and waits for another one."""

    id = "filters/test.waiting"
    version = "1.0.0"
    called = weft.text("", "the file that it makes")
    go = weft.text("", "the file that it waits for")

    def filter(self, given):
        pathlib.Path(self.called).write_text(threading.current_thread().name, encoding="utf-8")
        while not pathlib.Path(self.go).exists():
            given.call.go_on()
            time.sleep(0.001)
        kept = np.asarray(given.correspondences.kept)
        return weft.Record(kept=kept.copy(), score=np.ones(len(kept)))
