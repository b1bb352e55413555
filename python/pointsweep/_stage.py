# SPDX-License-Identifier: MIT
"""Built-in operators with their options, as stages of pipelines."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Any

from ._errors import UsageError
from ._joinable import Joinable
from ._options import number, path, whole


class Stage(Joinable):
    """A built-in operator with its options: ``ps.knn(16)``, ``ps.normals(orient="up")``.

    Stages, operators of your own and texts are joined by ``|``. `str` gives the stage in the language of
    docs/pipelines.md. Stages are equal if they are the same with all defaults written out, and can be pickled.
    """

    def __init__(self, name: str, options: Sequence[tuple[str, str]]) -> None:
        self.name = name
        self.options = dict(options)  #: as text, by name; those that are not given have their defaults

    def __str__(self) -> str:
        if not self.options:
            return self.name
        return f"{self.name}({', '.join(f'{name}={text}' for name, text in self.options.items())})"

    def __repr__(self) -> str:
        return f"<pointsweep.Stage: {self}>"


def made_stage(name: str, options: Iterable[tuple[str, str, Any, Any]]) -> Stage:
    """Of (name, kind, value, default) of each option; kinds are those of the declarations."""
    given = [
        (option, kind, value)
        for option, kind, value, default in options
        if value is not None and (default is None or value != default)
    ]
    return Stage(name, [(option, _text_of(f"{name}: {option}", kind, value)) for option, kind, value in given])


def _path_of(where: str, value: Any) -> str:
    files = getattr(value, "files", None)  # of a Cloud
    if files is not None and len(files) != 1:
        raise UsageError(f"{where}: is a cloud of {len(files)} files; give their folder or a pattern instead.")
    return path(where, files[0] if files else value)


def _text_of(where: str, kind: str, value: Any) -> str:
    if kind == "whole":
        return str(whole(where, value))
    if kind == "number":
        return repr(number(where, value))
    if "|" in kind:
        if not isinstance(value, bool):
            raise UsageError(f"{where}: {value!r} is neither True nor False.")
        return kind.split("|")[value]
    if kind in ("point", "numbers"):
        if isinstance(value, str) or (kind == "point" and len(value) != 3):
            raise UsageError(f"{where}: give {'three numbers, (x, y, z)' if kind == 'point' else 'a list of numbers'}.")
        return f"[{','.join(repr(number(where, c)) for c in value)}]"
    if kind in ("names", "attributes"):
        return f"[{','.join([value] if isinstance(value, str) else value)}]"
    if kind == "file":
        value = _path_of(where, value)
    if not isinstance(value, str):
        raise UsageError(f"{where}: {value!r} is not a text.")
    if re.fullmatch(r"[A-Za-z0-9_]+", value):
        return value
    return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
