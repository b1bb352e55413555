# SPDX-License-Identifier: MIT
"""Point files."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core
from ._crs import Crs
from ._errors import UsageError, warn
from ._options import path
from ._results import Arrays, Report
from ._tables import html_table

if TYPE_CHECKING:
    from ._chunks import Chunks

Path = str | os.PathLike[str]


class Cloud:
    """Point files as one cloud; made with `open`. Headers are read, and points only by `run`."""

    def __init__(self, files: list[str], names: list[str], options: dict[str, Any]) -> None:
        self.files = files  #: paths, in the order of the rows
        self._names = names  # in a folder of outputs
        self._options = options
        self._known = _core.describe(files, options)

    def __len__(self) -> int:
        return int(self._known["count"])

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]] | None:
        """The corners (least, greatest) as the headers state them; None where one does not."""
        box: tuple[tuple[float, float, float], tuple[float, float, float]] | None = self._known["bounds"]
        return box

    @property
    def crs(self) -> Crs | None:
        """The coordinate reference system; None where no file states one."""
        known = self._known["crs"]
        return None if known is None else Crs(known)

    @property
    def attributes(self) -> dict[str, np.dtype[Any]]:
        """The types of the arrays that `run` returns of what the files have, by the name in the files."""
        return {
            name: np.dtype(kind) if count == 1 else np.dtype((kind, count))
            for name, kind, count in self._known["attributes"]
        }

    @property
    def warnings(self) -> list[str]:
        """What is wrong but harmless in the files and where they meet."""
        return list(self._known["warnings"])

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        """The positions, (n, 3): all points are read. ``cloud.chunks`` reads files larger than memory."""
        if copy is False:
            raise ValueError("the points of files are in no array before they are read; leave copy=False out.")
        xyz: np.ndarray = self.run("decimate(1)", keep=["xyz"])["xyz"]  # type: ignore[index]
        return xyz if dtype is None else xyz.astype(dtype, copy=False)

    def run(self, pipeline: Any, **options: Any) -> Arrays | Report:
        """`pointsweep.run` on these files: with ``to=`` it writes files, otherwise it returns arrays."""
        from ._runs import run

        result: Arrays | Report = run(self, pipeline, **options)
        return result

    def chunks(self, rows: int, pipeline: Any = None, **options: Any) -> Chunks:
        """`pointsweep.chunks` of these files: the results of a run, block by block."""
        from ._chunks import chunks

        return chunks(self, rows, pipeline, **options)

    def __repr__(self) -> str:
        files = self.files[0] if len(self.files) == 1 else f"{len(self.files)} files"
        crs = self.crs
        lines = [f"<pointsweep.Cloud: {files}, {len(self):,} points" + (f", {crs}" if crs else "")]
        if self.bounds is not None:
            spans = (f"{a} {lo:.10g} to {hi:.10g}" for a, lo, hi in zip("xyz", *self.bounds))
            lines.append("  " + ", ".join(spans))
        lines.append("  " + ", ".join(f"{name} {kind}" for name, kind in self.attributes.items()))
        return "\n".join(lines) + ">"

    def _repr_html_(self) -> str:
        rows = [("files", self.files[0] if len(self.files) == 1 else f"{len(self.files):,}")]
        rows.append(("points", f"{len(self):,}"))
        if self.bounds is not None:
            rows += [(axis, f"{low:.10g} to {high:.10g}") for axis, low, high in zip("xyz", *self.bounds)]
        crs = self.crs
        if crs is not None:
            rows.append(("coordinate system", str(crs)))
        rows.append(("attributes", ", ".join(f"{name} {kind}" for name, kind in self.attributes.items())))
        return html_table("Cloud", None, rows)


def open(
    files: Path | Sequence[Path], *, recursive: bool = False, format: str = "", ignore_crs: bool = False
) -> Cloud:
    """Opens point files as one cloud: the headers are read, not the points.

    Parameters
    ----------
    files : a path, or several, whose points follow each other. A folder, or a pattern such as ``"tiles/*.laz"``, stands
        for its point files, a .vpc file for those that it names.
    recursive : folders stand for the point files in their folders, too.
    format : of files without a signature: 'kitti' or 'float32-xyz'.
    ignore_crs : take coordinates as they are: merge files of different coordinate reference systems without a
        transformation, take degrees for lengths, do not convert defaults to feet.
    """
    named = [files] if isinstance(files, (str, os.PathLike)) else list(files)
    if not named:
        raise UsageError("open: name at least one point file.")
    for file in named:
        if not isinstance(file, (str, os.PathLike)):
            raise UsageError(f"open: {file!r} is not a path; arrays go to pointsweep.run at once.")
    listed, notices = _core.list_files([path("open", file) for file in named], recursive, format)
    for notice in notices:
        warn(notice)
    options = {"ignore_crs": bool(ignore_crs), "format": format}
    return Cloud([file for file, _ in listed], [name for _, name in listed], options)


def outputs_of(to: Path | Sequence[Path], source: Any, points: Any) -> str | list[str]:
    """The file to write, or a list with a file for each input."""
    if not isinstance(to, (str, os.PathLike)):
        files = [path("to", file) for file in to]
        if not files:
            raise UsageError("to: the list is empty; name a file, a folder, or a file for each input.")
        return files
    named = path("to", to)
    if not (named.endswith(os.sep) or os.path.isdir(named)):
        return named
    if not source.is_files:
        raise UsageError(f"to: {named} is a folder, which gets a file for each input file; name a file for arrays.")
    cloud = points if isinstance(points, Cloud) else open(points)
    return [os.path.join(named, _tile_name(name)) for name in cloud._names]


def _tile_name(name: str) -> str:
    """A COPC file is written as LAZ, and programs tell COPC by the name."""
    stem, extension = os.path.splitext(name)
    inner, copc = os.path.splitext(stem)
    return inner + extension if (copc.lower(), extension.lower()) == (".copc", ".laz") else name
