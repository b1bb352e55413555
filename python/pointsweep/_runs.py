# SPDX-License-Identifier: MIT
"""Runs over arrays and files."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from typing import Any, Literal, overload

import numpy as np

from . import _core, _stages
from ._errors import UsageError, warn
from ._files import outputs_of
from ._options import choice, names, number, run_options, whole
from ._pipeline import PipelineLike, identified, stages_of
from ._outputs import outputs_to
from ._progress import ProgressCallback, called
from ._results import Arrays, Neighbors, RadiusNeighbors, Report, arrays_of
from ._sources import Source, source_of
from ._stage import Stage

Path = str | os.PathLike[str]


@overload
def run(
    points: Any,
    pipeline: PipelineLike,
    *,
    to: None = None,
    keep: Sequence[str] | str | None = None,
    out: Mapping[str, np.ndarray] | None = None,
    attributes: Mapping[str, Any] | None = None,
    crs: Any = None,
    order: str = "input",
    axis: int | str | None = None,
    memory: int | str | None = None,
    threads: int | None = None,
    temp_folder: Path | None = None,
    resume: Path | None = None,
    nonfinite: str | None = None,
    overwrite: bool = False,
    replace: Sequence[str] | str | None = None,
    prefix: str = "",
    ignore_crs: bool = False,
    progress: ProgressCallback | bool | None = None,
) -> Arrays: ...


@overload
def run(
    points: Any,
    pipeline: PipelineLike,
    *,
    to: Path | Sequence[Path],
    keep: Sequence[str] | str | None = None,
    attributes: Mapping[str, Any] | None = None,
    crs: Any = None,
    order: str = "input",
    axis: int | str | None = None,
    memory: int | str | None = None,
    threads: int | None = None,
    temp_folder: Path | None = None,
    resume: Path | None = None,
    nonfinite: str | None = None,
    overwrite: bool = False,
    replace: Sequence[str] | str | None = None,
    prefix: str = "",
    ignore_crs: bool = False,
    progress: ProgressCallback | bool | None = None,
) -> Report: ...


def run(
    points: Any,
    pipeline: PipelineLike,
    *,
    to: Path | Sequence[Path] | None = None,
    keep: Sequence[str] | str | None = None,
    out: Mapping[str, np.ndarray] | None = None,
    attributes: Mapping[str, Any] | None = None,
    crs: Any = None,
    progress: ProgressCallback | bool | None = None,
    **options: Any,
) -> Arrays | Report:
    """Runs a pipeline over points, in arrays or files, and returns arrays or writes files.

    Parameters
    ----------
    points : an (n, 3) array of any strides, also memory-mapped; a dict of arrays with 'xyz' (or 'x', 'y', 'z') and more
        attributes; a structured array, a table of pandas or pyarrow with columns x, y, z; a laspy.LasData or an open
        reader of laspy; a table of geopandas with points that have heights, or such columns; a point cloud of Open3D; an
        array on the CPU of any library with DLPack; an iterator of blocks of these, which are put in temporary files
        first; a `Cloud`; or paths as `open` takes them.
    pipeline : a text such as ``"knn(k=16) | normals | sor"`` (docs/pipelines.md), stages such as ``ps.knn(16)``, operators
        of your own, or these in a list or joined by ``|``; or the path of a text file.
    to : the file to write, whose name says the format; a folder, with a file for each input file; None: arrays.
    keep : names of the attributes wanted. Without it arrays are returned of all that is made; where the pipeline leaves
        rows out, or the order is another one, also of everything that the input has, and of 'row', the number of the
        input row (of points in arrays).
    out : arrays that the results of these names are written to, of the type and shape that they have, contiguous, e.g. a
        `numpy.memmap` for what does not fit in memory. They are what is kept where `keep` does not say.
    attributes : more attributes of points in arrays, by name.
    crs : coordinate reference system of points in arrays, which outputs state: an EPSG code, WKT, a `pyproj.CRS`, or the
        `crs` of a cloud. Default: what a laspy.LasData, a laspy reader or a table of geopandas states.
    order : of the result's rows: 'input', or 'sweep', along the axis of the largest extent.
    axis : of the sweep: 'x', 'y' or 'z'.
    memory : what the run may take in addition to the interpreter, its arrays and the results, e.g. '2G'; what does not
        fit goes to temporary files. Default: half of what is available.
    threads : default: one for each core.
    temp_folder : for temporary files.
    resume : a folder for checkpoints: the same call goes on from there after a crash. For files only.
    nonfinite : what happens to points with NaN or infinite coordinates: 'keep' them without results, 'drop' or 'refuse'.
        Default: 'keep', for LAS outputs 'drop'.
    overwrite : the output may replace an existing file.
    replace : attributes of the input that made ones of the same name may replace.
    prefix : before the names of made attributes in files.
    ignore_crs : coordinates of different systems are merged and compared without a transformation.
    progress : called with (phase, points done, points in all), a few times a second. An exception in it ends the run.
        True shows it, by tqdm if that is installed.

    Returns
    -------
    `Arrays`, a dict of arrays, or a `Report` where files are written. Raises `UsageError` and `Error`. Ctrl-C ends a run
    within a second, and nothing of it remains. Other threads run meanwhile.
    """
    stages = stages_of(pipeline)
    into = outputs_to(out)
    kept = names("keep", list(out) if keep is None and out else keep)
    checked = run_options(**options)
    source = source_of(points, attributes, crs, checked)
    given = {**checked, **source.options}
    if to is None:
        for option in ("prefix", "resume"):
            if given[option]:
                raise UsageError(f"{option}: is for outputs in files; name one with to=, or leave the option out.")
        missing = [name for name in into if kept and name not in kept]
        if missing:
            raise UsageError(f"out: '{missing[0]}' is not among what keep names; name it there, too.")
        with called(progress) as shown:
            known, statistics = _core.run(source.inputs, stages, kept, given, source.groups, None, into, shown, warn)
        return arrays_of({**(known or {}), **{n: (out[n], known[n][1]) for n in into if known}}, statistics, kept, source.crs)  # type: ignore[index]
    if into:
        raise UsageError("out: is for results in arrays; leave it out, or to=.")
    if given["resume"] and not source.is_files:
        raise UsageError("resume: is for files; arrays are gone when this process ends.")
    files = outputs_of(to, source, points)
    stages = identified(stages, resumed=bool(given["resume"]))
    with called(progress) as shown:
        _, statistics = _core.run(source.inputs, stages, kept, given, source.groups, files, {}, shown, warn)
    return Report(statistics, os.fspath(to) if isinstance(to, (str, os.PathLike)) else f"{len(files)} files")


@overload
def normals(*, orient: str = ..., viewpoint: Sequence[float] | None = ...) -> Stage: ...


@overload
def normals(
    points: Any,
    k: int | None = ...,
    *,
    radius: float | None = ...,
    orient: str = ...,
    viewpoint: Sequence[float] | None = ...,
    **options: Any,
) -> np.ndarray: ...


def normals(
    points: Any = None,
    k: int | None = None,
    *,
    radius: float | None = None,
    orient: str = "none",
    viewpoint: Sequence[float] | None = None,
    **options: Any,
) -> np.ndarray | Stage:
    """Unit normals of the surface that the points were taken from, (n, 3) float32; without points, a stage that makes
    them: ``ps.knn(16) | ps.normals(orient="up")``.

    Parameters
    ----------
    points : as for `run`.
    k : number of neighbours; where no radius is given either, the 16 of docs/operators.md.
    radius : neighbours lie within it, in the unit of the coordinates; with `k`, at most k of them.
    orient : 'none' (the component of largest magnitude is positive), 'up' (nz >= 0), 'viewpoint', or 'input' (as the
        attribute 'normal' that the points have).
    viewpoint : the position of the scanner, x, y, z; implies orient='viewpoint'.
    options : of `run`: attributes, out (an array), memory, threads, progress, ...
    """
    if viewpoint is not None and orient == "none":
        orient = "viewpoint"
    choice("orient", orient, ("none", "up", "viewpoint", "input"))
    if orient == "viewpoint" and (viewpoint is None or len(viewpoint) != 3):
        raise UsageError("viewpoint: give the position of the scanner, (x, y, z).")
    if orient != "viewpoint" and viewpoint is not None:
        raise UsageError(f"viewpoint: is not used with orient={orient!r}; leave one of them out.")
    stage = _stages.normals(orient, viewpoint=viewpoint)  # type: ignore[arg-type]
    if points is None:
        if k is not None or radius is not None or options:
            raise UsageError("normals: without points it is a stage; give k and radius to knn(), and options to run().")
        return stage
    knn = [] if k is None and radius is None else [_stages.knn(k, radius=radius)]
    if isinstance(options.get("out"), np.ndarray):
        options["out"] = {"normal": options["out"]}
    result: np.ndarray = run(points, [*knn, stage], keep=["normal"], **options)["normal"]
    return result


# What the declaration of the operator says beyond its options.
normals.__doc__ = f"{normals.__doc__ or ''}\n    Makes\n{(_stages.normals.__doc__ or '').partition('Makes')[2].lstrip(chr(10))}"


@overload
def neighbors(points: Any, k: int = ..., *, radius: float | None = None, **options: Any) -> Neighbors: ...


@overload
def neighbors(points: Any, k: None = None, *, radius: float, **options: Any) -> RadiusNeighbors: ...


def neighbors(
    points: Any, k: int | None = None, *, radius: float | None = None, **options: Any
) -> Neighbors | RadiusNeighbors:
    """The exact neighbours of every point among all points, the point itself excluded.

    Parameters
    ----------
    points : as for `run`.
    k : number of neighbours; 16 where no radius is given.
    radius : largest distance, inclusive, in the unit of the coordinates.
    options : of `run`: memory, threads, progress, ...

    Returns
    -------
    With k: `Neighbors`, (indices, distances), both (n, k), nearest first. With a radius alone: `RadiusNeighbors`,
    (offsets, indices, distances); the neighbours of point i are ``indices[offsets[i]:offsets[i + 1]]``, nearest first.
    Their number is not bounded: 16 bytes for each are in memory, whatever the budget.

    Distances are computed in float64; equal ones are ordered by x, y, z, then by row. Points with NaN or infinite
    coordinates have no neighbours and are neighbours of no point.
    """
    progress = options.pop("progress", None)
    attributes, crs = options.pop("attributes", None), options.pop("crs", None)
    checked = run_options(**options)
    source: Source = source_of(points, attributes, crs, checked)
    given = {**checked, **source.options}
    for option, plain in (("order", "input"), ("prefix", ""), ("resume", "")):
        if given[option] != plain:
            raise UsageError(f"{option}: is not an option of neighbors.")
    if k is None and radius is not None:
        with called(progress) as shown:
            lists = _core.radius_neighbors(source.inputs, number("radius", radius), given, shown, warn)
        return RadiusNeighbors(*lists)
    count = _core.default_neighbors if k is None else whole("k", k)
    if not 1 <= count < 2**32:
        raise UsageError(f"k: {count} is not a number of neighbours; choose 1 or more, below 2**32.")
    limit = math.inf if radius is None else number("radius", radius)
    with called(progress) as shown:
        return Neighbors(*_core.neighbors(source.inputs, count, limit, given, shown, warn))
