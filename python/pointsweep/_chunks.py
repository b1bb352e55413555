# SPDX-License-Identifier: MIT
"""Results block by block, in bounded memory, and values of the whole cloud that are computed from the blocks."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core
from ._errors import UsageError, warn
from ._function import MadeOfFunction, with_parentheses
from ._operator import Operator, Points, operator
from ._options import kept_names, refuse_options_of_files, run_options, whole, with_run_options
from ._progress import called
from ._results import Arrays, Report, arrays_of
from ._sources import Source, every_array, source_of
from ._stage_list import read_by, refuse_made_xyz, stages_of
from ._types import FilesWithColumns, FunctionStage, PipelineLike, ProgressCallback, RunOptions

if TYPE_CHECKING:
    from typing_extensions import Unpack


def _row() -> Operator:
    """Returns an operator that makes the attribute 'row': the row number of each point."""

    @operator(makes={"row": "i8"}, neighbors=False)
    def row(p: Points) -> np.ndarray:
        return p.rows

    return row


class Chunks(Iterator[Arrays]):
    """The results of a run as blocks of rows; made with `chunks`.

    An unnamed temporary file holds the results. The file is removed with this object, by `close`, or when the process ends.
    """

    def __init__(self, results: Any, has_rows: bool, statistics: str, kept: list[str], rows: int, source: Source) -> None:
        self.report = Report(statistics)  #: statistics of the run
        self._results: Any = results
        self._has_rows = has_rows
        self._kept = kept
        self._rows = rows
        self._crs, self._grid = source.crs, source.grid
        self._next = 0

    def __next__(self) -> Arrays:
        if self._results is None or self._next >= len(self._results):
            self.close()
            raise StopIteration
        known = self._results.read(self._next, self._rows)
        n = min(self._rows, len(self._results) - self._next)
        if not self._has_rows and "row" not in known:
            known["row"] = np.arange(self._next, self._next + n), ["row"]
        self._next += n
        return arrays_of(known, None, self._kept, self._crs, self._grid)

    def close(self) -> None:
        """Removes the temporary file. The iterator ends."""
        self._results = None

    def __enter__(self) -> Chunks:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


@with_run_options
def chunks(
    points: Any,
    rows: int,
    pipeline: PipelineLike | None = None,
    *,
    keep: Sequence[str] | str | None = None,
    attributes: Mapping[str, Any] | None = None,
    crs: Any = None,
    progress: ProgressCallback | bool | None = None,
    **options: Unpack[RunOptions],
) -> Chunks:
    """Runs a pipeline and returns its results as blocks of `rows` rows, in the order of the input.

    Each block is a dict of the arrays that `run` returns, and of 'row', the number of the input row. If an attribute 'row' of
    files, or one that an operator makes, is among the results, 'row' is this attribute. The run ends before the first block.
    Its results are in a temporary file in `temp_folder`, so that only one block is in memory, in addition to the `memory` of
    the run. Without a pipeline the blocks hold the points themselves, with all attributes or those that `keep` names.

    Parameters
    ----------
    points, pipeline, keep, attributes, crs, progress, options : as for `run`.
    rows : number of rows of a block; the last block may have fewer.

    >>> for part in ps.chunks("tiles/*.laz", 1_000_000, "knn(k=8) | normals", keep=["xyz", "normal"]):
    ...     part["xyz"], part["normal"], part["row"]
    """
    block = whole("rows", rows)
    if not 1 <= block < 2**63:
        raise UsageError(f"rows: {block} is not a number of rows; choose 1 or more, below 2**63.")
    kept = kept_names(keep)
    checked = run_options(**options)
    refuse_options_of_files(checked, "leave the option out")
    columns = points if isinstance(points, FilesWithColumns) else None
    if columns is not None:
        columns._checked_options(options, to_files=False)
    stages: list[str | FunctionStage] = [] if pipeline is None else stages_of(pipeline)
    source = source_of(points if columns is None else columns.cloud, attributes, crs, checked, read_by(stages))
    if pipeline is None and not kept:
        kept = source.array_names() if columns is None else every_array(columns.attributes)
    if columns is not None:
        stages.insert(0, columns._stage())
    source.require_clear(kept)
    refuse_made_xyz(stages)
    has_own = "row" in source.fields or any("row" in stage.makes for stage in stages if isinstance(stage, Operator))
    is_numbered = source.is_files and not (has_own and (not kept or "row" in kept))
    asked = [name for name in kept if name != "row"] or kept and ["xyz"] if is_numbered else kept
    numbers = _row() if is_numbered else None
    with called(progress) as shown:
        results, has_rows, statistics = _core.run_to_blocks(
            source.inputs, stages, asked, source.options, source.groups, numbers, shown, warn
        )
    if kept and "row" not in kept:
        kept.append("row")
    return Chunks(results, has_rows, statistics, kept, block, source)


class Reduction(MadeOfFunction):
    """A function that takes a cloud block by block; made with `pointsweep.reduce`. Call it with points."""

    def __init__(self, function: Callable[[Any, Arrays], Any], start: Any, keep: Any) -> None:
        self._takes_the_place_of(function)
        self.start = start
        self.keep = keep

    def __call__(self, points: Any, pipeline: PipelineLike | None = None, *, rows: int = 1 << 20, **options: Any) -> Any:
        """Reduces the results of a pipeline, or the points themselves. `options` are options of `run`."""
        value = copy.deepcopy(self.start)
        with chunks(points, rows, pipeline, **{"keep": self.keep, **options}) as blocks:
            for block in blocks:
                value = self.function(value, block)
        return value

    def __repr__(self) -> str:
        return f"<pointsweep.Reduction {getattr(self.function, '__name__', '')}>"


@with_parentheses("start=0")
def reduce(*, start: Any, keep: Any = None) -> Callable[[Callable[[Any, Arrays], Any]], Reduction]:
    """Turns a function over blocks of rows into a value of the whole cloud, computed in bounded memory.

    Parameters
    ----------
    start : the value before the first block. It is copied for each call.
    keep : the arrays that the function needs, as for `run`.

    The function gets the value so far and a block as `chunks` gives it, and returns the new value. Blocks come in the
    order of the input, `rows` rows each: memory and threads do not change the result.

    >>> @ps.reduce(start=-np.inf, keep=["xyz"])
    ... def highest(z, block):
    ...     return max(z, block["xyz"][:, 2].max())
    >>> highest("tiles/*.laz")
    """
    return lambda function: Reduction(function, start, keep)
