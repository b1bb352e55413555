# SPDX-License-Identifier: MIT
"""Copies of points, from files to arrays and from arrays to files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ._files import open as open_files
from ._options import with_run_options
from ._results import Arrays, Report
from ._runs import COPY, performed
from ._types import Path, ProgressCallback, RunOptions

if TYPE_CHECKING:
    from typing_extensions import Unpack


@with_run_options
def read(
    files: Path | Sequence[Path],
    *,
    keep: Sequence[str] | str | None = None,
    progress: ProgressCallback | bool | None = None,
    **options: Unpack[RunOptions],
) -> Arrays:
    """Reads the points of files into a dict of arrays: 'xyz', (n, 3), and every attribute, or those that `keep` names.

    ``ps.open(files).chunks(rows)`` reads files that are larger than memory. Takes the options of `run`.
    """
    return open_files(files, ignore_crs=bool(options.get("ignore_crs"))).read(keep=keep, progress=progress, **options)


@with_run_options
def write(
    to: Path,
    points: Any,
    *,
    keep: Sequence[str] | str | None = None,
    attributes: Mapping[str, Any] | None = None,
    crs: Any = None,
    progress: ProgressCallback | bool | None = None,
    **options: Unpack[RunOptions],
) -> Report:
    """Writes points, in arrays or files as `run` takes them, with all their attributes to the file `to`.

    ``ps.write("a.laz", {"xyz": xyz, "intensity": i}, crs=2154, scale=0.001)``. Takes the options of `run`.
    """
    result = performed(points, COPY, to, keep, None, attributes, crs, progress, options)
    assert isinstance(result, Report)
    return result
