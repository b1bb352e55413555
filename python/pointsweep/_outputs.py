# SPDX-License-Identifier: MIT
"""Files and arrays of the caller that results are written to."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from . import _core
from ._errors import UsageError
from ._options import path
from ._sources import Source
from ._types import Path


def outputs_to(out: Mapping[str, np.ndarray] | None) -> dict[str, np.ndarray]:
    """Returns the arrays of `out` as (n, m) views, after all checks that are possible before the run."""
    if out is None:
        return {}
    if not isinstance(out, Mapping):
        raise UsageError(f"out: {type(out).__name__} is no dict; give one from names of results to arrays.")
    return {name: _writable(name, array) for name, array in out.items()}


def _writable(name: str, array: np.ndarray) -> np.ndarray:
    if not isinstance(array, np.ndarray):
        raise UsageError(f"out: '{name}' is {type(array).__name__}; give an array of NumPy.")
    if not array.flags.writeable:
        raise UsageError(f"out: '{name}' is read-only; give an array that can be written, or open the file with mode='r+'.")
    if not array.flags.c_contiguous:
        raise UsageError(f"out: '{name}' is not contiguous; give an array whose rows follow one another.")
    if array.dtype.kind not in "fiu" or array.dtype.itemsize > 8 or not array.dtype.isnative or array.ndim not in (1, 2):
        raise UsageError(f"out: '{name}' is {array.dtype} of the shape {array.shape}, which no result is.")
    return array.reshape(len(array), -1) if len(array) else array.reshape(0, array.shape[1] if array.ndim == 2 else 1)


def outputs_of(to: Path | Sequence[Path], source: Source) -> str | list[str]:
    """Returns the file to write, or a list with a file for each input; if the run divides its output, the path has a
    * for the names of the files."""
    if source.divides:
        return _divided(to, source)
    if isinstance(to, Iterable) and not isinstance(to, (str, os.PathLike)):
        files = [path("to", file) for file in to]
        if not files:
            raise UsageError("to: the list is empty; name a file, a folder, or a file for each input.")
        return files
    named = path("to", to)
    if not (named.endswith(os.sep) or os.path.isdir(named)):
        return named
    if not source.is_files:
        raise UsageError(f"to: {named} is a folder, which gets a file for each input file; name a file for arrays.")
    return [os.path.join(named, name) for name in source.names]


def _divided(to: Path | Sequence[Path], source: Source) -> str:
    if not isinstance(to, (str, os.PathLike)):
        raise UsageError("to: tile and split name the files themselves; give their folder.")
    named = path("to", to)
    if "*" in os.path.basename(named):
        return named
    if not source.is_files:
        raise UsageError(f"to: {named} says no format for arrays; name the files, e.g. {os.path.join(named, '*.laz')}.")
    first = source.names[0]
    extension = first[len(first) - len(_core.extension_of(first)) :]  # extension_of() makes it lower case
    return os.path.join(named, "*" + extension)
