# SPDX-License-Identifier: MIT
"""The contents of point files."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from . import _core
from ._crs import Crs
from ._errors import UsageError, warn
from ._options import path, way_of_reading
from ._progress import called
from ._tables import html_table, span_rows
from ._types import Path, ProgressCallback

_Point = tuple[float, float, float]


class Attribute(NamedTuple):
    """The values of one attribute of a file."""

    type: np.dtype[Any]  #: type in the file
    components: int  #: number of components
    scale: float  #: a value is scale * stored + offset
    offset: float
    min: float | None  #: least finite value, over all components; None without one
    max: float | None
    nonfinite: int  #: NaN and infinite values


class GpsTimes(NamedTuple):
    """The times of a scan."""

    min: float  #: seconds
    max: float
    clock: str  #: 'week_seconds', 'adjusted_standard' or 'unknown'
    start: str | None  #: date and time of `min` on the GPS scale; None for other clocks, before 1980 and from 2200 on
    end: str | None


class Provenance(NamedTuple):
    """A run of pointsweep that made a file."""

    version: str
    stages: tuple[str, ...]
    settings: dict[str, str]
    inputs: tuple[str, ...]  #: names
    more_inputs: int  #: inputs that are not named


class FileSummary(NamedTuple):
    """The result of `info`. docs/info.md has the definitions."""

    path: str
    format: str  #: e.g. 'LAS 1.4 point format 6'
    bytes: int
    points: int
    nonfinite: int  #: points with a NaN or infinite coordinate
    bounds: tuple[_Point, _Point] | None  #: corners (least, greatest) of the points; None without a finite point
    crs: Crs | None
    scale: _Point  #: scale of x, y and z; 1 if coordinates are stored unscaled
    offset: _Point
    density: float | None  #: finite points for each square unit of x and y in occupied cells; None without an area
    density_cell: float | None  #: side of the square cells of x and y whose occupied ones `density` takes as the area
    spacing: float | None  #: median distance to the nearest other point; None: not measured, or no two finite points
    spacing_sample: int  #: number of points measured
    spacing_duplicates: int  #: points of the sample that have the coordinates of another point
    ascending: tuple[str, ...]  #: axes with coordinates that never decrease and are not all equal
    descending: tuple[str, ...]
    classes: dict[int, int] | None  #: number of points of each class; None: the file has no classification
    returns: dict[int, int] | None  #: number of points of each return number
    gps_time: GpsTimes | None
    attributes: dict[str, Attribute]  #: in the order of the file, coordinates included
    provenance: tuple[Provenance, ...]  #: the runs that made the file, oldest first
    warnings: tuple[str, ...]  #: harmless faults of the file and of its header

    def __repr__(self) -> str:
        lines = [f"{name:<10} {value}" for name, value in self._rows()]
        return "\n  ".join([f"<pointsweep.FileSummary: {self.path}", *lines]) + ">"

    def _repr_html_(self) -> str:
        return html_table(self.path, None, self._rows())

    def _rows(self) -> list[tuple[str, str]]:
        rows = [("format", f"{self.format}, {self.bytes:,} bytes"), ("points", f"{self.points:,}"), *span_rows(self.bounds)]
        if self.nonfinite:
            rows.append(("not finite", f"{self.nonfinite:,} points"))
        if self.crs is not None:
            rows.append(("crs", str(self.crs)))
        if self.density is not None:
            rows.append(("density", f"{self.density:.4g} points per square unit of x and y"))
        if self.spacing is not None:
            rows.append(("spacing", f"{self.spacing:.4g}"))
        rows.append(("attributes", ", ".join(f"{name} {a.type}" for name, a in self.attributes.items())))
        return rows


def info(
    file: Path,
    *,
    spacing: bool = True,
    format: str = "",
    columns: Sequence[str] | str | None = None,
    depth: int | None = None,
    resolution: float | None = None,
    progress: ProgressCallback | bool | None = None,
) -> FileSummary:
    """Reads a whole point file and describes it: bounds, density, spacing, ranges, classes, times, records.

    If the header does not fit the points, a warning is issued, which is also in `warnings` of the result. Memory: about
    10 MB for files of any size.

    Parameters
    ----------
    file : a path. For the files of a folder or pattern: ``[ps.info(f) for f in ps.open("tiles/*.laz").files]``.
    spacing : measure the distance between points, which takes a second reading.
    format : format of a file without a signature: 'kitti' or 'float32-xyz'.
    columns, depth, resolution : as for `open`.
    progress : as for `run`.
    """
    import json

    if not isinstance(file, (str, os.PathLike)):
        raise UsageError(f"info: {file!r} is not a path; name one file.")
    named = path("info", file)
    if os.path.isdir(named):
        raise UsageError(f"info: {named} is a folder; look at its files one by one, those of pointsweep.open(...).files.")
    with called(progress) as shown:
        text, crs = _core.summarize(named, way_of_reading(format, columns, depth, resolution), bool(spacing), shown)
    summary = _summary(json.loads(text), None if crs is None else Crs(crs))
    for sentence in summary.warnings:
        warn(sentence if sentence.startswith(named) else f"{named}: {sentence}")
    return summary


def _summary(known: dict[str, Any], crs: Crs | None) -> FileSummary:
    """Converts the JSON object of a file (docs/info.md) to a FileSummary."""

    def counts(of: dict[str, int] | None) -> dict[int, int] | None:
        return None if of is None else {int(value): points for value, points in of.items()}

    del known["read"]  # always 'points' here, since summarize() reads more than the header
    bounds, times = known.pop("bounds"), known.pop("gps_time")
    attributes = {
        a["name"]: Attribute(np.dtype(a["type"]), a["count"], a["scale"], a["offset"], a["min"], a["max"], a["nonfinite"])
        for a in known.pop("attributes")
    }
    provenance = tuple(
        Provenance(p["version"], tuple(p["stages"]), p["settings"], tuple(i["name"] for i in p["inputs"]), p["more_inputs"])
        for p in known.pop("provenance")
    )
    for name in ("scale", "offset", "ascending", "descending", "warnings"):
        known[name] = tuple(known[name])
    return FileSummary(
        **{
            **known,
            "crs": crs,
            "bounds": None if bounds is None else (tuple(bounds["min"]), tuple(bounds["max"])),
            "classes": counts(known["classes"]),
            "returns": counts(known["returns"]),
            "gps_time": None if times is None else GpsTimes(*(times[key] for key in ("min", "max", "clock", "from", "to"))),
            "attributes": attributes,
            "provenance": provenance,
        }
    )
