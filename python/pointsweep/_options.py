# SPDX-License-Identifier: MIT
"""Options of runs, checked, as the extension module takes them."""

from __future__ import annotations

import inspect
import math
import operator
import os
import re
from collections.abc import Callable
from typing import Any, TypeVar

from . import _core
from ._errors import UsageError
from ._types import RunOptions

_Function = TypeVar("_Function", bound=Callable[..., Any])

_POWERS = {"": 0, "K": 1, "M": 2, "G": 3, "T": 4}


def bytes_of(memory: int | str | None) -> int:
    """800_000_000, "256M", "1.5GB" or "4GiB" in bytes; K, M, G and T are powers of 1024. None: 0."""
    if memory is None:
        return 0
    if isinstance(memory, str):
        size = re.fullmatch(r"\s*([0-9]*\.?[0-9]+)\s*(?:([KMGT])(?:iB|B)?|B)\s*", memory, re.IGNORECASE)
        if size is None:
            raise UsageError(f"memory: '{memory}' is not a size with a unit, such as '256M', '1.5G' or '4GiB'.")
        value = int(float(size[1]) * 1024 ** _POWERS[(size[2] or "").upper()])
    else:
        value = whole("memory", memory)
    if value <= 0:
        raise UsageError(f"memory: {memory!r} is no memory; leave the option out for half of what is available.")
    return value


def whole(name: str, value: Any) -> int:
    """`value` as an int."""
    try:
        if isinstance(value, bool):
            raise TypeError
        return operator.index(value)
    except TypeError:
        raise UsageError(f"{name}: {value!r} is not a whole number.") from None


def number(name: str, value: Any) -> float:
    """`value` as a finite float."""
    try:
        result = float(value)
    except (TypeError, ValueError):
        raise UsageError(f"{name}: {value!r} is not a number.") from None
    if not math.isfinite(result):
        raise UsageError(f"{name}: {value!r} is not finite.")
    return result


def choice(name: str, value: Any, choices: tuple[str, ...]) -> str:
    """`value` if it is one of `choices`."""
    if value not in choices:
        raise UsageError(f"{name}: {value!r} is not one of {', '.join(choices)}.")
    return value


def word(name: str, value: Any) -> str:
    """`value` if it is one of the words that the option of this name has in the declarations; empty for None."""
    return "" if value is None else choice(name, value, tuple(_core.run_words[name]))


def _axis(axis: int | str | None) -> str:
    is_number = isinstance(axis, int) and not isinstance(axis, bool) and axis in (0, 1, 2)
    return word("axis", "xyz"[axis] if is_number else axis)  # type: ignore[index]


def _provenance(provenance: str | bool) -> str:
    """What the processing record names inputs by; empty: outputs get no record."""
    if isinstance(provenance, bool):
        return "names" if provenance else ""
    return word("provenance", provenance)


def path(option: str, value: Any) -> str:
    """`value` as the path of a file or folder."""
    try:
        text = os.fsdecode(value)
    except TypeError:
        raise UsageError(f"{option}: {value!r} is not a path.") from None
    if not text:
        raise UsageError(f"{option}: the path is empty; name a file or folder, or leave the option out.")
    return text


def names(option: str, value: Any) -> list[str]:
    """`value`, one name or several, as a list."""
    if value is None:
        return []
    listed = [value] if isinstance(value, str) else list(value)
    for name in listed:
        if not isinstance(name, str) or not name:
            raise UsageError(f"{option}: {name!r} is not the name of an attribute.")
    return listed


def run_options(
    *,
    order: Any = "input",
    axis: Any = None,
    memory: Any = None,
    threads: Any = None,
    temp_folder: Any = None,
    resume: Any = None,
    nonfinite: Any = None,
    overwrite: Any = False,
    replace: Any = None,
    prefix: Any = "",
    positions: Any = None,
    provenance: Any = True,
    ignore_crs: Any = False,
) -> dict[str, Any]:
    """The options in `RunOptions`, with their defaults, checked."""
    count = 0 if threads is None else whole("threads", threads)
    if threads is not None and not 1 <= count <= 4096:
        raise UsageError(f"threads: {threads} is not a number of threads from 1 to 4096.")
    return {
        "order": word("order", order),
        "axis": _axis(axis),
        "memory": bytes_of(memory),
        "threads": count,
        "temp_folder": "" if temp_folder is None else path("temp_folder", temp_folder),
        "resume": "" if resume is None else path("resume", resume),
        "nonfinite": word("nonfinite", nonfinite),
        "overwrite": bool(overwrite),
        "replace": names("replace", replace),
        "prefix": str(prefix),
        "positions": word("positions", positions),
        "provenance": _provenance(provenance),
        "ignore_crs": bool(ignore_crs),
    }


def refuse_options_of_files(given: dict[str, Any], remedy: str) -> None:
    """Raises UsageError for a checked option that only outputs in files have."""
    for option, plain in (("prefix", ""), ("resume", ""), ("provenance", "names")):
        if given[option] != plain:
            raise UsageError(f"{option}: is for outputs in files; {remedy}.")


def with_run_options(function: _Function) -> _Function:
    """The function, whose signature names the options of `run_options` in place of ``**options``, with the types that they
    have in `RunOptions`."""
    signature = inspect.signature(function)
    own = [p for p in signature.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
    types = {name: getattr(kind, "__forward_arg__", kind) for name, kind in RunOptions.__annotations__.items()}
    options = [p.replace(annotation=types[p.name]) for p in inspect.signature(run_options).parameters.values()]
    function.__signature__ = signature.replace(parameters=[*own, *options])  # type: ignore[attr-defined]
    return function
