# SPDX-License-Identifier: Apache-2.0
"""How a method answers otherwise than by a result."""


class NoResult(Exception):
    """The data do not determine an answer; recorded for the frame, and no failure."""


class NoMoreFrames(Exception):
    """Raised by a source: the sequence has ended, because ..."""


class Failure(Exception):
    """Something is wrong with what was given: a sentence that says what to change. Any other
    exception counts as a fault of the component."""


class Cancelled(Exception):
    """The host cancelled the call."""


class Degenerate:
    """A result that is usable but doubtful, and why."""

    def __init__(self, value: object, reason: object) -> None:
        self.value = value
        self.reason = str(reason)


def degenerate(value: object, reason: object) -> Degenerate:
    """To be returned in the place of a result that is usable but doubtful."""
    return Degenerate(value, reason)
