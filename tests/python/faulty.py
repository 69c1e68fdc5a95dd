# SPDX-License-Identifier: Apache-2.0
"""A filter that does wrong what it is told to, for tests of the host."""

import ctypes
import os

import numpy as np
import weft

FAULTS = ("none", "raise", "deep", "failure", "no_record", "unknown_array", "wrong_type", "wrong_length",
          "keep_view", "write_input", "misspell", "leave", "crash", "loop", "no_reason")


def told_to(what):
    raise ValueError(what)


class Faulty(weft.Filter):
    """Does what it is told to."""

    id = "filters/test.faulty"
    version = "1.0.0"
    random = True
    fault = weft.choice("none", FAULTS, "what it does wrong")
    frame = weft.whole(1, "", (-1, 1000000), "in which it does, -1 for all")

    def filter(self, given):
        matches = given.correspondences
        fault = self.fault if self.frame in (-1, given.call.frame) else "none"
        count = len(matches.kept)
        score = given.call.rng().random(count)
        if fault == "raise":
            raise ValueError("told to")
        if fault == "deep":
            np.vectorize(told_to, otypes=[float])(["deep inside"])
        if fault == "failure":
            raise weft.Failure("the matches are not as they should be; change them")
        if fault == "no_record":
            return None
        if fault == "unknown_array":
            return weft.Record(kept=np.ones(count, np.uint8), scores=score)
        if fault == "wrong_type":
            return weft.Record(kept=np.ones(count), score=score)
        if fault == "wrong_length":
            return weft.Record(kept=np.ones(count + 1, np.uint8), score=np.ones(count + 1))
        if fault == "keep_view":
            self.kept_view = matches.image_px[3:]
        if fault == "write_input":
            matches.image_px[0, 0] = 1.0
        if fault == "misspell":
            return matches.imagepx
        if fault == "leave":
            os._exit(7)
        if fault == "crash":
            ctypes.string_at(0)
        while fault == "loop":
            pass
        if fault == "no_reason":
            raise weft.NoResult
        return weft.Record(kept=matches.kept.copy(), score=score)


class Nesting(weft.Filter):
    """Keeps matches that lie where the warp that it holds puts them."""

    id = "filters/test.nesting"
    version = "1.0.0"
    needs = "template"
    warp = weft.component("warps", "warps/bbs", "the warp that is fitted")
    tolerance_px = weft.number(20.0, "px", (0, 1000), "kept if so near")

    def filter(self, given):
        matches = given.correspondences
        warp = self.warp.fit(given, correspondences=matches, template=given.template)
        samples = given.evaluate(warp, matches.template_px)
        off_px = np.hypot(*(samples.xy_px - matches.image_px).T)
        kept = (off_px <= self.tolerance_px) & (samples.valid != 0) & (matches.kept != 0)
        return weft.Record(kept=kept, score=1.0 / (1.0 + off_px))
