# SPDX-License-Identifier: MIT
"""What the package raises, and its warnings."""

from __future__ import annotations

import os
import sys
import warnings


class Error(Exception):
    """A file, the machine or a budget of memory is at fault.

    The text is one sentence: what is wrong, where, and what to do. No output is left half-written.
    """


class UsageError(Error, ValueError):
    """The request itself makes no sense: an array of the wrong shape, an option out of range, an unknown operator."""


class PointsweepWarning(UserWarning):
    """Something about the input, the request or the output that is worth knowing but does no harm."""


_PACKAGE = os.path.dirname(os.path.abspath(__file__)) + os.sep


def warn(sentence: str) -> None:
    """Warns at the line outside of the package that called it."""
    frame, level = sys._getframe(), 1
    while frame.f_back is not None and os.path.abspath(frame.f_code.co_filename).startswith(_PACKAGE):
        frame, level = frame.f_back, level + 1
    warnings.warn(sentence, PointsweepWarning, stacklevel=level)
