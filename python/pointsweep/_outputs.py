# SPDX-License-Identifier: MIT
"""Files and arrays of the caller that results are written to."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from . import _core
from ._errors import UsageError
from ._options import path
from ._results import Grid
from ._sources import Source
from ._types import Path

_BLOCK = 1 << 20  # coordinates that are compared with a grid at once
_MOST_OF_A_STEP = 0.001  # distance from a grid, in steps, that rounding in double precision explains


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


def require_own_memory(into: Mapping[str, np.ndarray], source: Source) -> None:
    """Raises UsageError if an array of `into` shares memory with another one, or with an array of the input that is not the
    very same one: the run would read values that it has overwritten."""
    named = list(into.items())
    for i, (name, array) in enumerate(named):
        for other, earlier in named[:i]:
            if _share_memory(array, earlier):
                raise UsageError(f"out: '{name}' and '{other}' share memory; give a separate array for each result.")
        for fields, column in [] if source.is_files else source.inputs:
            places = [(a.ctypes.data, a.shape, a.itemsize) for a in (array, column)]
            is_same = column.flags.c_contiguous and places[0] == places[1]
            if not is_same and _share_memory(array, column):
                known = next((group for group, parts in source.groups if parts == fields), fields[0])
                raise UsageError(f"out: '{name}' shares memory with '{known}' of the input; give a copy of one of them.")


def _share_memory(a: np.ndarray, b: np.ndarray) -> bool:
    try:
        return np.shares_memory(a, b, max_work=10_000)  # type: ignore[arg-type]
    except RuntimeError:  # TooHardError, whose place depends on the version of NumPy
        return True


def on_grid(source: Source, files: str | list[str]) -> dict[str, Any]:
    """Returns the options of a run that writes the points of the source to `files`, with the grid of the LAS file or object that
    points in arrays come from, if the files are LAS, the caller states no grid, and all coordinates lie on this one."""
    given, grid = source.options, source.grid
    named = [files] if isinstance(files, str) else files
    is_las = all(_core.extension_of(name).endswith((".las", ".laz")) for name in named)
    if source.is_files or grid is None or given["scale"] or given["offset"] or not is_las or not _lies_on(grid, source):
        return given
    texts = {name: ",".join(map(repr, numbers)) for name, numbers in grid._asdict().items()}
    return {**given, **texts}


def _lies_on(grid: Grid, source: Source) -> bool:
    """Returns whether the finite coordinates of points in arrays are whole 32-bit numbers of steps away from the offset."""
    if not min(grid.scale) > 0:
        return False
    columns = {field: values[:, i] for fields, values in source.inputs for i, field in enumerate(fields)}
    for axis, scale, offset in zip("xyz", grid.scale, grid.offset):
        for first in range(0, len(columns[axis]), _BLOCK):
            with np.errstate(invalid="ignore"):
                steps = (columns[axis][first : first + _BLOCK].astype(np.float64) - offset) / scale
                if np.any(np.abs(steps - np.rint(steps)) > _MOST_OF_A_STEP) or np.any(np.abs(steps[np.isfinite(steps)]) >= 2**31):
                    return False
    return True


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
