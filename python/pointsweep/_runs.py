# SPDX-License-Identifier: MIT
"""Runs over arrays and files, and descriptions of runs before they run."""

from __future__ import annotations

import importlib
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, overload

import numpy as np

from . import _core
from ._errors import UsageError, warn
from ._options import kept_names, path, refuse_options_of_files, run_options, with_run_options
from ._outputs import on_grid, outputs_of, outputs_to, require_own_memory
from ._progress import called
from ._results import Arrays, Report, arrays_of
from ._sources import source_of
from ._stage_list import identified, read_by, refuse_made_xyz, stages_of
from ._types import FilesWithColumns, FunctionStage, Path, PipelineLike, PointOptions, ProgressCallback, RunOptions

if TYPE_CHECKING:
    from typing_extensions import Unpack


@overload
def run(
    points: Any,
    pipeline: PipelineLike,
    *,
    to: None = None,
    keep: Sequence[str] | str | None = None,
    out: Mapping[str, np.ndarray] | None = None,
    **options: Unpack[PointOptions],
) -> Arrays: ...


@overload
def run(
    points: Any,
    pipeline: PipelineLike,
    *,
    to: Path | Sequence[Path],
    keep: Sequence[str] | str | None = None,
    client: Any = None,
    scratch: Path | None = None,
    take_over: bool = False,
    **options: Unpack[PointOptions],
) -> Report: ...


@with_run_options
def run(
    points: Any,
    pipeline: PipelineLike,
    *,
    to: Path | Sequence[Path] | None = None,
    keep: Sequence[str] | str | None = None,
    out: Mapping[str, np.ndarray] | None = None,
    attributes: Mapping[str, Any] | None = None,
    crs: Any = None,
    client: Any = None,
    scratch: Path | None = None,
    take_over: bool = False,
    progress: ProgressCallback | bool | None = None,
    **options: Unpack[RunOptions],
) -> Arrays | Report:
    """Runs a pipeline over points, in arrays or files, and returns arrays or writes files.

    Parameters
    ----------
    points : an (n, 3) array of any strides, also memory-mapped; a dict of arrays with 'xyz' (or 'x', 'y', 'z') and more
        attributes; a structured array, a table of pandas or pyarrow with columns x, y, z; a laspy.LasData or an open
        reader of laspy; a table of geopandas with points that have heights, or such columns; a point cloud of Open3D; an
        array on the CPU of any library with DLPack; an iterator of blocks of these, which are put in temporary files
        first; the results of another run; a `Cloud`, also with columns; or paths and URLs as `open` takes them.
    pipeline : a text such as ``"knn(k=16) | normals | sor"`` (docs/pipelines.md), stages such as ``ps.knn(16)``, operators
        of your own, or these in a list or joined by ``|``; or the path of a text file.
    to : the file to write, a path or a URL whose name says the format; a folder, with a file for each input file; None:
        arrays.
    keep : names of the attributes wanted. Default for arrays: all made attributes; if the pipeline drops rows or changes
        their order, also all attributes of the input and, for points in arrays, 'row', the number of the input row.
    out : contiguous arrays by name, to which the results of these names are written, of the types and shapes of the
        results, e.g. a `numpy.memmap` for results larger than memory. Their names are the default of `keep`. If the
        pipeline drops rows, they have as many rows as the input, and each result is a view of the first rows. An array of
        the input may be given; other arrays that share memory with the input, or with each other, are refused.
    attributes : more attributes of points in arrays, by name.
    crs : coordinate reference system of points in arrays, or of paths, which outputs state: an EPSG code, WKT, a file with
        WKT (.prj), a `pyproj.CRS`, or the `crs` of a cloud. `open` can also replace the system of files. Default: what a laspy.LasData, a laspy reader or a table of geopandas states.
    client : divides the work on a folder of tiles, with a folder as the output, among the workers of Dask: a
        `distributed.Client`, the address of a scheduler, or 'local' for workers on this machine (docs/cluster.md).
    scratch : with a client, a folder, or a URL in a bucket, that all workers can access, for points that tasks pass to
        later tasks. It is empty after the run; after a crash the same call continues from it.
    take_over : with a client, continues the run in a scratch whose process has ended, without waiting for two minutes.
    order : order of the result's rows: 'input', or 'sweep', ascending along `axis`.
    axis : axis of the sweep: 'x', 'y', 'z' or 'auto', the axis of the largest extent.
    memory : limit for the memory of the run, e.g. '2G', in addition to the interpreter, its arrays and the results; data
        that do not fit go to temporary files. Default: half of the available memory.
    threads : number of threads. Default: one for each core.
    temp_folder : folder for temporary files.
    resume : a folder for checkpoints, from which the same call continues after a crash. For files only.
    nonfinite : what happens to points with NaN or infinite coordinates: 'keep' them without results, 'drop' or 'refuse'.
        Default: 'keep', for LAS outputs 'drop'.
    overwrite : the output may replace an existing file.
    replace : names of input attributes that made attributes of the same name may replace.
    prefix : text before the names of made attributes in files.
    positions : type of x, y and z in the result, 'float32' or 'float64', not for LAS. Default: the type of the input;
        float64 for moved points.
    scale : step, one number or three, to which LAS outputs round coordinates. Default: the steps of the input, or the
        finest with which integers reach all points.
    offset : offset of the integer coordinates of LAS outputs, three numbers, or 'auto', near the middle of the points.
        Default: that of the input if integers then reach all points.
    point_format : point format of LAS outputs, 0 to 10; attributes for which it has no field become extra bytes. Default:
        that of the input, or the shortest that holds all attributes.
    las_version : version of LAS outputs, '1.0' to '1.4'. Default: that of the input, or '1.4'.
    decimals : digits of x, y and z after the decimal point in text outputs. Default: as many as their values need.
    tile : divides the points among square tiles of this edge: files X_Y in the folder `to`, named after their lower
        corners, of the format of the first input; `to` may also name them, e.g. 'out/*.laz'.
    tile_origin : a corner of a tile, two numbers. Default: 0, 0.
    tile_buffer : tiles also hold the points of their neighbours within this width, with an attribute 'buffer' of 1.
    split : name of an attribute; the folder `to` gets a file for each of its values.
    provenance : the processing record of output files names inputs by their 'names' (the default) or by their absolute
        'paths'; False: files get no record.
    ignore_crs : coordinates of different systems are merged and compared without a transformation.
    progress : a function that is called with (phase, points done, points in all) a few times a second. An exception in it
        ends the run. True shows the progress, with tqdm if that is installed.

    Returns
    -------
    `Arrays`, a dict of arrays, or a `Report` where files are written. Raises `UsageError` and `Error`. Ctrl-C ends a run
    within a second, and no output remains. Other Python threads run meanwhile.
    """
    workers = Workers(client, scratch, take_over)
    return performed(points, stages_of(pipeline), to, keep, out, attributes, crs, progress, options, workers)


class Workers(NamedTuple):
    """The arguments of `run` that divide the work among processes."""

    client: Any = None
    scratch: Path | None = None
    take_over: bool = False


def _spread(
    points: Any,
    stages: list[str | FunctionStage],
    to: Path | Sequence[Path],
    keep: Sequence[str] | str | None,
    crs: Any,
    workers: Workers,
    progress: ProgressCallback | bool | None,
    options: RunOptions,
) -> Report:
    """Performs `run` on the workers of a Dask client."""
    if workers.scratch is None:
        raise UsageError("client: needs a folder that all workers see; name it with scratch=.")
    scratch = path("scratch", workers.scratch)
    source = source_of(points, None, crs, run_options(**options))
    if not source.is_files:
        raise UsageError("client: is for files that all workers see; write the arrays to files first.")
    kept = source.kept_fields(kept_names(keep))
    named = outputs_of(to, source)
    if isinstance(named, str) and not source.divides:
        raise UsageError("client: many processes write a file for each input; name a folder with to=.")
    files = [named] if isinstance(named, str) else named
    stages = identified(stages, resumed=True)
    cluster = importlib.import_module("pointsweep._cluster")  # imported here, since it is slow to load and other runs do not need it
    with called(progress) as shown:
        statistics = cluster.run_on_cluster(
            workers.client, scratch, workers.take_over, source.inputs, stages, kept, source.options, files, shown
        )
    return _report_on(statistics, to, files)


def _report_on(statistics: str, to: Path | Sequence[Path], files: str | list[str]) -> Report:
    return Report(statistics, os.fspath(to) if isinstance(to, (str, os.PathLike)) else f"{len(files)} files")


def _may_make_row(stage: str | FunctionStage) -> bool:
    return "row" in (stage if isinstance(stage, str) else getattr(stage, "makes", ()))


def _first_rows(array: np.ndarray, rows: int) -> np.ndarray:
    return array if rows == len(array) else array[:rows]


def performed(
    points: Any,
    stages: list[str | FunctionStage],
    to: Path | Sequence[Path] | None,
    keep: Sequence[str] | str | None,
    out: Mapping[str, np.ndarray] | None,
    attributes: Mapping[str, Any] | None,
    crs: Any,
    progress: ProgressCallback | bool | None,
    options: RunOptions,
    workers: Workers = Workers(),
) -> Arrays | Report:
    """Performs `run` for any `to`. Without stages the points are copied."""
    if isinstance(points, FilesWithColumns):
        if workers.client is not None:
            raise UsageError("client: the columns are in the memory of this process; write them to files with write first.")
        options = points._checked_options(options, to is not None)
        stages, points = [points._stage(), *stages], points.cloud
    if workers.client is not None:
        if to is None or out is not None or attributes is not None:
            raise UsageError("client: many processes write a file for each input; name a folder with to=.")
        return _spread(points, stages, to, keep, crs, workers, progress, options)
    if workers.scratch is not None or workers.take_over:
        raise UsageError("scratch: is for the workers of a client; name one with client=.")
    into = outputs_to(out)
    kept = kept_names(list(out) if keep is None and out else keep)
    source = source_of(points, attributes, crs, run_options(**options), read_by(stages))
    given = source.options
    if to is None:
        refuse_options_of_files(given, "name one with to=, or leave the option out")
        missing = [name for name in into if kept and name not in kept]
        if missing:
            raise UsageError(f"out: '{missing[0]}' is not among what keep names; name it there, too.")
        require_own_memory(into, source)
        source.require_clear(kept)
        refuse_made_xyz(stages)
        if source.is_files and "row" in kept and "row" not in source.fields and not any(_may_make_row(stage) for stage in stages):
            raise UsageError("keep: 'row' is for points in arrays; chunks gives the numbers of the rows of files.")
        with called(progress) as shown:
            known, statistics = _core.run(source.inputs, stages, kept, given, source.groups, None, into, shown, warn)
        filled = {n: (_first_rows(out[n], known[n][0]), known[n][1]) for n in into if known}  # type: ignore[arg-type, index]
        return arrays_of({**(known or {}), **filled}, statistics, kept, source.crs, source.grid)
    if into:
        raise UsageError("out: is for results in arrays; leave it out, or to=.")
    if given["resume"] and not source.is_files:
        raise UsageError("resume: is for files; arrays are gone when this process ends.")
    files = outputs_of(to, source)
    kept = source.kept_fields(kept)
    if not stages:
        given = on_grid(source, files)
    stages = identified(stages, resumed=bool(given["resume"]))
    with called(progress) as shown:
        _, statistics = _core.run(source.inputs, stages, kept, given, source.groups, files, {}, shown, warn)
    return _report_on(statistics, to, files)


class Plan(str):
    """The passes of a run with their stages, columns and memory, in lines for people."""

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        import html

        return f"<pre>{html.escape(self)}</pre>"


@with_run_options
def plan(
    points: Any,
    pipeline: PipelineLike,
    *,
    to: Path | None = None,
    keep: Sequence[str] | str | None = None,
    attributes: Mapping[str, Any] | None = None,
    crs: Any = None,
    **options: Unpack[RunOptions],
) -> Plan:
    """Describes what `run` would do with the same arguments: passes, stages with their buffers, columns, slabs and memory.

    Reads a sample of the cloud and writes nothing. Raises the errors that the run would raise before its work. `to` is a file.
    """
    stages = stages_of(pipeline)
    if isinstance(points, FilesWithColumns):
        options = points._checked_options(options, to is not None)
        stages, points = [points._stage(), *stages], points.cloud
    source = source_of(points, attributes, crs, run_options(**options), read_by(stages))
    file = "" if to is None else path("to", to)
    if not source.divides and (file.endswith(os.sep) or os.path.isdir(file or os.devnull)):
        raise UsageError(f"to: {file} is a folder; a plan is that of a run to one file, or one that divides its output.")
    if file and source.divides:
        file = str(outputs_of(file, source))
    kept = kept_names(keep)
    return Plan(_core.plan(source.inputs, stages, source.kept_fields(kept) if file else kept, source.options, source.groups, file))
