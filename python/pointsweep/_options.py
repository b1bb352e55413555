# SPDX-License-Identifier: MIT
"""Options of runs, checked, as the extension module takes them."""

from __future__ import annotations

import inspect
import math
import operator
import os
import re
from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeVar

import numpy as np

from . import _core
from ._errors import UsageError
from ._types import RunOptions
from ._urls import known_place

_Function = TypeVar("_Function", bound=Callable[..., Any])

_POWERS = {"": 0, "K": 1, "M": 2, "G": 3, "T": 4}


def bytes_of(memory: int | str | None) -> int:
    """Converts 800_000_000, "256M", "1.5GB" or "4GiB" to bytes; K, M, G and T are powers of 1024. None becomes 0."""
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
    """Returns `value` as an int. Raises UsageError if it is not a whole number."""
    try:
        if isinstance(value, bool):
            raise TypeError
        return operator.index(value)
    except TypeError:
        raise UsageError(f"{name}: {value!r} is not a whole number.") from None


def count(name: str, value: Any, bits: int = 64) -> int:
    """Returns `value` as an int. Raises UsageError if it is not a whole number from 0 to below 2**bits."""
    result = whole(name, value)
    if result < 0:
        raise UsageError(f"{name}: {result} is negative.")
    if result >= 2**bits:
        raise UsageError(f"{name}: {result} is too large; choose a number below 2**{bits}.")
    return result


def number(name: str, value: Any) -> float:
    """Returns `value` as a float. Raises UsageError if it is not a finite number."""
    try:
        if isinstance(value, (bool, np.bool_)):
            raise TypeError
        result = float(value)
    except (TypeError, ValueError, OverflowError):
        raise UsageError(f"{name}: {value!r} is not a number.") from None
    if not math.isfinite(result):
        raise UsageError(f"{name}: {value!r} is not finite.")
    return result


def flag(name: str, value: Any) -> bool:
    """Returns `value` as a bool. Raises UsageError for a text, such as 'no'."""
    if isinstance(value, (str, bytes)):
        raise UsageError(f"{name}: {value!r} is neither True nor False.")
    return bool(value)


def text(name: str, value: Any) -> str:
    """Returns `value`. Raises UsageError if it is not a text."""
    if not isinstance(value, str):
        raise UsageError(f"{name}: {value!r} is not a text.")
    return value


def choice(name: str, value: Any, choices: tuple[str, ...]) -> str:
    """Returns `value`. Raises UsageError if it is not one of `choices`."""
    if value not in choices:
        raise UsageError(f"{name}: {value!r} is not one of {', '.join(choices)}.")
    return value


def word(name: str, value: Any) -> str:
    """Returns `value` if it is one of the words in the declaration of the option; empty for None."""
    return "" if value is None else choice(name, value, tuple(_core.run_options[name][1]))


def path(option: str, value: Any) -> str:
    """Returns `value`, the path of a file or folder, as a text. Raises UsageError if it is not a path."""
    try:
        named = os.fsdecode(value)
    except TypeError:
        raise UsageError(f"{option}: {value!r} is not a path.") from None
    if not named:
        raise UsageError(f"{option}: the path is empty; name a file or folder, or leave the option out.")
    return known_place(value, named)


def listed(value: Any) -> list[Any]:
    """Returns the elements of a list or another iterable; a list with `value` alone if it is a text, a path or not iterable."""
    return list(value) if isinstance(value, Iterable) and not isinstance(value, (str, os.PathLike)) else [value]


def names(option: str, value: Any) -> list[str]:
    """Returns `value`, one name or several or None, as a list of names. Raises UsageError for anything else."""
    found = [] if value is None else listed(value)
    for name in found:
        if not isinstance(name, str) or not name:
            raise UsageError(f"{option}: {name!r} is not the name of an attribute.")
    return found


def one_name(option: str, value: Any) -> str:
    """Returns the only name in `value`. Raises UsageError if `value` is not one name of an attribute."""
    found = names(option, value)
    if len(found) != 1:
        raise UsageError(f"{option}: name one attribute.")
    return found[0]


def kept_names(keep: Any) -> list[str]:
    """Returns the names in `keep`; an empty list for None, which stands for the default. Raises UsageError if it has no names."""
    found = names("keep", keep)
    if keep is not None and not found:
        raise UsageError("keep: the list is empty; name what to keep, or leave the option out.")
    return found


def way_of_reading(format: str, columns: Sequence[str] | str | None, depth: int | None, resolution: float | None) -> str:
    """Returns a text that tells the library how to read files. At most one argument may be given; the text is empty without one."""
    words = {"format": text("format", format)} if format else {}
    if columns is not None:
        words["columns"] = "text:" + ",".join(names("columns", columns))
    if depth is not None:
        words["depth"] = f"depth:{whole('depth', depth)}"
    if resolution is not None:
        words["resolution"] = f"spacing:{number('resolution', resolution)!r}"
    if len(words) > 1:
        raise UsageError(f"{' and '.join(words)}: each says how files are read; leave all but one out.")
    return next(iter(words.values()), "")


def _threads(_: str, threads: Any) -> str:
    if not 1 <= whole("threads", threads) <= 4096:
        raise UsageError(f"threads: {threads} is not a number of threads from 1 to 4096.")
    return str(whole("threads", threads))


def _numbers(name: str, value: Any, one_for_all: bool = False, count: int = 3) -> str:
    """Returns `count` numbers as text, separated by commas. With `one_for_all`, also accepts a single number."""
    several = [value] if isinstance(value, str) or not np.ndim(value) else list(value)
    if len(several) not in ((1, count) if one_for_all else (count,)):
        raise UsageError(f"{name}: {value!r} is not {'a number or ' if one_for_all else ''}{'two' if count == 2 else 'three'} numbers.")
    return ",".join(repr(number(name, v)) for v in several)


#: Functions that convert the value of a run option to a text, by the placeholder of the value in its declaration.
_TEXTS: dict[str, Callable[[str, Any], str]] = {
    "": lambda name, value: "yes" if flag(name, value) else "",
    "S|X,Y,Z": lambda name, value: _numbers(name, value, one_for_all=True),
    "auto|X,Y,Z": lambda name, value: value if isinstance(value, str) and value == "auto" else _numbers(name, value),
    "X,Y": lambda name, value: _numbers(name, value, count=2),
    "LENGTH": lambda name, value: repr(number(name, value)),
    "WIDTH": lambda name, value: repr(number(name, value)),
    "ATTRIBUTE": one_name,
    "DIGITS": lambda name, value: str(whole(name, value)),
    "A,B,...": lambda name, value: ",".join(names(name, value)),
    "DIR": path,
    "N": _threads,
    "NAME": lambda _, value: str(value),
    "SIZE": lambda _, value: f"{bytes_of(value)}B",
}

#: The defaults that are not None.
_PRESETS = {"order": "input", "overwrite": False, "prefix": "", "provenance": True, "ignore_crs": False}


def _text(name: str, value: Any) -> str:
    """Returns the value of a run option as the extension module takes it: a text, which is empty for the default."""
    placeholder, words, _ = _core.run_options[name]
    if words and isinstance(value, (int, np.integer)):
        value = str(value)  # number of a point format
    return word(name, value) if words else "" if value is None else _TEXTS[placeholder](name, value)


def _suggestion(name: str) -> str:
    """Returns a sentence that names the option nearest to `name`; an empty text if none is near."""
    import difflib

    known = [*RunOptions.__annotations__, "to", "keep", "out", "attributes", "crs", "progress", "client", "scratch", "take_over"]
    near = difflib.get_close_matches(name, known, n=1)
    return f" The nearest one is {near[0]!r}." if near else ""


def run_options(**given: Any) -> dict[str, Any]:
    """Checks the options in `RunOptions` and returns each as a text, which is empty for the default; `ignore_crs` as a bool."""
    for name in given:
        if name not in RunOptions.__annotations__:
            raise TypeError(f"{name!r} is not an option.{_suggestion(name)}")
    values = {name: given.get(name, _PRESETS.get(name)) for name in RunOptions.__annotations__}
    axis, provenance, ignore_crs = values["axis"], values["provenance"], flag("ignore_crs", values.pop("ignore_crs"))
    if isinstance(axis, (int, np.integer)) and not isinstance(axis, bool) and axis in (0, 1, 2):
        values["axis"] = "xyz"[axis]
    if isinstance(provenance, bool):
        values.update(provenance="names", no_provenance=not provenance)
    return {**{name: _text(name, value) for name, value in values.items()}, "ignore_crs": ignore_crs}


#: The run options that only outputs in files have.
OPTIONS_OF_FILES = (
    "prefix", "resume", "provenance", "scale", "offset", "point_format", "las_version", "decimals", "tile", "tile_origin", "tile_buffer", "split"
)  # fmt: skip


def refuse_options(given: dict[str, Any], names: Iterable[str], remark: str) -> None:
    """Raises UsageError for a checked option of these names that is not the default."""
    presets = run_options()
    for name in names:
        also = "no_provenance" if name == "provenance" else name
        if given[name] != presets[name] or given.get(also, "") != presets.get(also, ""):
            raise UsageError(f"{name}: {remark}.")


def refuse_options_of_files(given: dict[str, Any], remedy: str) -> None:
    """Raises UsageError for a checked option that only outputs in files have."""
    refuse_options(given, OPTIONS_OF_FILES, f"is for outputs in files; {remedy}")


def with_run_options(function: _Function) -> _Function:
    """Changes the signature of `function`, so that it names the options in `RunOptions`, with their types and defaults, in place
    of ``**options``. Returns `function`."""
    signature = inspect.signature(function)
    own = [p for p in signature.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
    options = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=_PRESETS.get(name), annotation=getattr(kind, "__forward_arg__", kind))
        for name, kind in RunOptions.__annotations__.items()
    ]
    function.__signature__ = signature.replace(parameters=[*own, *options])  # type: ignore[attr-defined]
    return function
