# SPDX-License-Identifier: MIT
"""URLs in place of paths."""

from __future__ import annotations

import os
import re
from typing import Any

from . import _core

_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+://")
_ONE_SLASH = re.compile(r"(https?|s3a?|gs|az|azure|abfss?|adl):/(?=[^/])")


def is_url(name: str) -> bool:
    """Returns whether a name begins with a scheme and '://'."""
    return _SCHEME.match(name) is not None


def known_place(value: Any, name: str) -> str:
    """Returns `name`, the text of `value`, without the password or the signature of a URL, which this process keeps for
    requests. Restores the slash that a URL loses if it is made a Path."""
    if isinstance(value, os.PathLike):
        name = _ONE_SLASH.sub(r"\1://", name, count=1)
    return _core.known_place(name) if is_url(name) else name


def absolute(name: str) -> str:
    """Returns the absolute path; a URL unchanged."""
    return name if is_url(name) else os.path.abspath(name)


def state_of(name: str) -> tuple[int, int | str]:
    """Returns a value that changes with the file: its size, and its time or the ETag of an object. Raises OSError without a file."""
    if is_url(name):
        found = _core.object_state(name)
        if found is None:
            raise FileNotFoundError(2, "no such object", name)
        return found[0], found[2]
    status = os.stat(name)
    return status.st_size, status.st_mtime_ns


def bytes_at(name: str) -> int:
    """Returns the size of a file or an object; 0 if it does not exist."""
    try:
        return state_of(name)[0]
    except FileNotFoundError:
        return 0
