# SPDX-License-Identifier: MIT
"""The exceptions and warnings of the package."""

from __future__ import annotations

import os
import sys
import warnings


class Error(Exception):
    """An error of a file, the machine or a memory budget.

    The text is one sentence: what is wrong, where, and what to do. No half-written output remains.
    """


class UsageError(Error, ValueError):
    """The request itself makes no sense: an array of the wrong shape, an option out of range, an unknown operator."""


class PointsweepWarning(UserWarning):
    """Something about the input, the request or the output that is worth knowing but does no harm."""


_OTHER_NAMES = {"temp-dir": "temp_folder", "force": "overwrite=True", "ignore-crs": "ignore_crs=True", "recursive": "recursive=True"}
_SAME_NAMES = ("axis", "bins", "by", "columns", "depth", "format", "histogram", "keep", "memory", "nonfinite", "order", "positions", "prefix", "replace", "resolution", "resume", "split", "threads", "tile", "tile_origin", "tile_buffer")


_of_tool = False


def keep_names_of_tool() -> None:
    """Leaves the options in sentences as the command-line tool names them, in a process that the tool has started."""
    global _of_tool
    _of_tool = True


def with_names_of_python(sentence: str) -> str:
    """Converts a sentence of the library, which names options like the command-line tool, to the names of this package."""
    if "--" not in sentence or _of_tool:
        return sentence
    import re

    sentence = sentence.replace("--stats FILE", "report.statistics")

    def named(option: re.Match[str]) -> str:
        text, name, value = option[0], option[1], option[2]
        if name in _OTHER_NAMES:
            return _OTHER_NAMES[name] + (f" {value}" if value else "")
        if name.replace("-", "_") not in _SAME_NAMES:
            return text
        return f"{name.replace('-', '_')}={value!r}" if value else name.replace("-", "_")

    return re.sub(r"--([a-z][a-z-]*)(?: (keep|drop|refuse|input|sweep|[0-9][0-9.]*[KMGT]?B?)\b)?", named, sentence)


_PACKAGE = os.path.dirname(os.path.abspath(__file__)) + os.sep


def warn(sentence: str) -> None:
    """Warns at the line outside of the package that called it."""
    sentence = with_names_of_python(sentence)
    frame, level = sys._getframe(), 1
    while frame.f_back is not None and os.path.abspath(frame.f_code.co_filename).startswith(_PACKAGE):
        frame, level = frame.f_back, level + 1
    warnings.warn(sentence, PointsweepWarning, stacklevel=level)
