# SPDX-License-Identifier: Apache-2.0
"""Errors that the programs print without a trace."""


class InputError(Exception):
    """Wrong input: the message has the place and the fix."""


class Stopped(Exception):
    """The training stopped before its end: by a signal or by --minutes."""
