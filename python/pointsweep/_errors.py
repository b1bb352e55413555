# SPDX-License-Identifier: MIT
"""The exceptions and warnings of the package."""

from __future__ import annotations

import os
import re
import sys
import warnings

from . import _core


class Error(Exception):
    """An error of a file, the machine or a memory budget.

    The text is one sentence: what is wrong, where, and what to do. No half-written output remains.
    """


class UsageError(Error, ValueError):
    """An error of the request: an array of the wrong shape, an option out of range, an unknown operator."""


class PointsweepWarning(UserWarning):
    """Something about the input, the request or the output that is worth knowing but does no harm."""


#: Python texts for flags of the tool, by flag. They take precedence over the names in `_core.run_options`.
_OF_VERBS = {
    "force": "overwrite=True", "ignore-crs": "ignore_crs=True", "recursive": "recursive=True", "no-provenance": "provenance=False",
    "replace-crs": "replace_crs=True", "point-size": "point_size",
    **{name: name for name in ("bins", "by", "columns", "crs", "depth", "format", "histogram", "keep", "resolution")},
    **{name: name for name in ("background", "color", "size", "up", "view")},
}  # fmt: skip


_of_tool = False


def keep_names_of_tool() -> None:
    """Leaves the options in sentences as the command-line tool names them, in a process that the tool has started."""
    global _of_tool
    _of_tool = True


def _following(value: str | None) -> str:
    """Returns the word after the name of an option: a placeholder, such as NAME, as its value; or the next word of the sentence."""
    return "" if not value else f"={value}" if value.isupper() else f" {value}"


def with_names_of_python(sentence: str) -> str:
    """Converts a sentence of the library, which names options like the command-line tool, to the names of this package."""
    if "--" not in sentence or _of_tool:
        return sentence
    of_runs = {flag.removeprefix("--"): (name, words) for name, (_, words, flag) in _core.run_options.items()}
    sentence = sentence.replace("--stats FILE", "report.statistics")

    def replaced(option: re.Match[str]) -> str:
        names = option[1].split(",")
        return f"replace={(names if len(names) > 1 else names[0])!r}"

    sentence = re.sub(r"--replace (\S+)(?=, or )", replaced, sentence)

    def named(option: re.Match[str]) -> str:
        text, flag, value = option[0], option[1], option[2]
        if flag in _OF_VERBS:
            return _OF_VERBS[flag] + _following(value)
        if flag not in of_runs:
            return text
        name, words = of_runs[flag]
        if value and (value in words or re.fullmatch(r"[0-9][0-9.]*[KMGT]B?", value)):
            return f"{name}={value!r}"
        if value and re.fullmatch(r"[0-9.]+", value):
            return f"{name}={value}"
        return name + _following(value)

    return re.sub(r"--([a-z][a-z-]*)(?: ([\w]+(?:\.[0-9]+\w*)?))?", named, sentence)


_PACKAGE = os.path.dirname(os.path.abspath(__file__)) + os.sep


def warn(sentence: str) -> None:
    """Emits a PointsweepWarning. Its location is the line outside of the package that called the package."""
    sentence = with_names_of_python(sentence)
    frame, level = sys._getframe(), 1
    while frame.f_back is not None and os.path.abspath(frame.f_code.co_filename).startswith(_PACKAGE):
        frame, level = frame.f_back, level + 1
    warnings.warn(sentence, PointsweepWarning, stacklevel=level)
