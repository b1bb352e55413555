# SPDX-License-Identifier: MIT
"""Point files, and copies of points from files to arrays and from arrays to files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from ._chunks import Chunks, chunks
from ._columns import CloudWithColumns
from ._crs import Crs
from ._options import with_run_options
from ._results import Arrays, Report
from ._runs import Workers, performed
from ._sources import every_array, opened
from ._stage_list import stages_of
from ._summary import GroupedSummary, PointSummary, summary
from ._tables import html_table, span_rows
from ._types import Files, Path, PipelineLike, ProgressCallback, RunOptions, SummaryOptions

if TYPE_CHECKING:
    from typing_extensions import Unpack


class Cloud(Files):
    """Point files as one cloud; made with `open`, which reads the headers. Methods such as `run` and `read` read the points."""

    def __len__(self) -> int:
        return int(self._known["count"])

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]] | None:
        """The corners (least, greatest) in the headers; None if a header lacks them."""
        box: tuple[tuple[float, float, float], tuple[float, float, float]] | None = self._known["bounds"]
        return box

    @property
    def crs(self) -> Crs | None:
        """The coordinate reference system; None if no file states one."""
        known = self._known["crs"]
        return None if known is None else Crs(known)

    @property
    def attributes(self) -> dict[str, np.dtype[Any]]:
        """The types of the arrays that `run` returns for the attributes of the files, by their names in the files."""
        return {
            name: np.dtype(kind) if count == 1 else np.dtype((kind, count))
            for name, kind, count in self._known["attributes"]
        }

    @property
    def warnings(self) -> list[str]:
        """Harmless faults of the files, and of their combination."""
        return list(self._known["warnings"])

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        """Returns the positions, (n, 3), and reads all points. Use ``cloud.chunks`` for files larger than memory."""
        if copy is False:
            raise ValueError("the points of files are in no array before they are read; leave copy=False out.")
        xyz: np.ndarray = self.read(keep=["xyz"])["xyz"]
        return xyz if dtype is None else xyz.astype(dtype, copy=False)

    @overload
    def run(
        self,
        pipeline: PipelineLike,
        *,
        to: None = None,
        keep: Sequence[str] | str | None = None,
        out: Mapping[str, np.ndarray] | None = None,
        progress: ProgressCallback | bool | None = None,
        **options: Unpack[RunOptions],
    ) -> Arrays: ...

    @overload
    def run(
        self,
        pipeline: PipelineLike,
        *,
        to: Path | Sequence[Path],
        keep: Sequence[str] | str | None = None,
        client: Any = None,
        scratch: Path | None = None,
        take_over: bool = False,
        progress: ProgressCallback | bool | None = None,
        **options: Unpack[RunOptions],
    ) -> Report: ...

    @with_run_options
    def run(
        self,
        pipeline: PipelineLike,
        *,
        to: Path | Sequence[Path] | None = None,
        keep: Sequence[str] | str | None = None,
        out: Mapping[str, np.ndarray] | None = None,
        client: Any = None,
        scratch: Path | None = None,
        take_over: bool = False,
        progress: ProgressCallback | bool | None = None,
        **options: Unpack[RunOptions],
    ) -> Arrays | Report:
        """Calls `pointsweep.run` on these files: with ``to=`` it writes files, otherwise it returns arrays."""
        workers = Workers(client, scratch, take_over)
        return performed(self, stages_of(pipeline), to, keep, out, None, None, progress, options, workers)

    @with_run_options
    def read(
        self,
        *,
        keep: Sequence[str] | str | None = None,
        progress: ProgressCallback | bool | None = None,
        **options: Unpack[RunOptions],
    ) -> Arrays:
        """Returns all points in a dict of arrays: 'xyz', (n, 3), and every attribute, or those that `keep` names."""
        kept = every_array(self.attributes) if keep is None else keep
        result = performed(self, [], None, kept, None, None, None, progress, options)
        assert isinstance(result, Arrays)
        return result

    @with_run_options
    def write(
        self,
        to: Path | Sequence[Path],
        *,
        keep: Sequence[str] | str | None = None,
        client: Any = None,
        scratch: Path | None = None,
        take_over: bool = False,
        progress: ProgressCallback | bool | None = None,
        **options: Unpack[RunOptions],
    ) -> Report:
        """Writes the points, unchanged, to a file, or to a folder with a file for each input: `pointsweep convert`. With
        ``tile=`` or ``split=`` it divides them among files of a folder: `pointsweep tile`, `pointsweep split`."""
        workers = Workers(client, scratch, take_over)
        result = performed(self, [], to, keep, None, None, None, progress, options, workers)
        assert isinstance(result, Report)
        return result

    @with_run_options
    def chunks(
        self,
        rows: int,
        pipeline: PipelineLike | None = None,
        *,
        keep: Sequence[str] | str | None = None,
        progress: ProgressCallback | bool | None = None,
        **options: Unpack[RunOptions],
    ) -> Chunks:
        """`pointsweep.chunks` of these files: the results of a run, block by block."""
        return chunks(self, rows, pipeline, keep=keep, progress=progress, **options)

    @overload
    def summary(self, *, by: None = None, **options: Unpack[SummaryOptions]) -> PointSummary: ...

    @overload
    def summary(self, *, by: str, **options: Unpack[SummaryOptions]) -> GroupedSummary: ...

    def summary(
        self,
        *,
        by: str | None = None,
        histogram: Sequence[str] | str | None = None,
        bins: int = 20,
        keep: Sequence[str] | str | None = None,
        progress: ProgressCallback | bool | None = None,
    ) -> PointSummary | GroupedSummary:
        """Calls `pointsweep.summary` on these files: exact statistics of all points, or with `by` of the points of each value."""
        return summary(self, by=by, histogram=histogram, bins=bins, keep=keep, progress=progress)

    def with_columns(self, **columns: Any) -> CloudWithColumns:
        """Returns these files with arrays as additional attributes: ``ps.open(f).with_columns(label=labels).write(g)``.

        Each array is (n,) or (n, m), with a row for each point, in the order of the files. It replaces an attribute of the
        files with its name. All other contents of the files stay unchanged.
        """
        return CloudWithColumns(self, self.attributes, columns)

    def __repr__(self) -> str:
        files = self.files[0] if len(self.files) == 1 else f"{len(self.files)} files"
        crs = self.crs
        lines = [f"<pointsweep.Cloud: {files}, {len(self):,} points" + (f", {crs}" if crs else "")]
        if self.bounds is not None:
            lines.append(", ".join(f"{axis} {span}" for axis, span in span_rows(self.bounds)))
        return "\n  ".join([*lines, self._attribute_texts()]) + ">"

    def _repr_html_(self) -> str:
        rows = [("files", self.files[0] if len(self.files) == 1 else f"{len(self.files):,}")]
        rows += [("points", f"{len(self):,}"), *span_rows(self.bounds)]
        crs = self.crs
        if crs is not None:
            rows.append(("coordinate system", str(crs)))
        return html_table("Cloud", None, [*rows, ("attributes", self._attribute_texts())])

    def _attribute_texts(self) -> str:
        return ", ".join(f"{name} {kind}" for name, kind in self.attributes.items())


def open(
    files: Path | Sequence[Path],
    *,
    recursive: bool = False,
    format: str = "",
    columns: Sequence[str] | str | None = None,
    depth: int | None = None,
    resolution: float | None = None,
    ignore_crs: bool = False,
    crs: Any = None,
    replace_crs: bool = False,
) -> Cloud:
    """Opens point files as one cloud: the headers are read, not the points.

    Parameters
    ----------
    files : a path or a URL (docs/urls.md), or several, whose points follow each other. A folder, or a pattern such as
        ``"tiles/*.laz"``, stands for its point files, a .vpc file for the files that it names.
    recursive : folders include the point files of their sub-folders.
    format : format of files without a signature: 'kitti' or 'float32-xyz'.
    columns : names of the columns of text files, in place of a header: ``["x", "y", "z", "intensity", "-", "red"]``; "-"
        skips a column.
    depth : of COPC files, read only the levels of detail up to this depth; 0 is the coarsest level.
    resolution : of COPC files, read only as many levels of detail as give this distance between points, or less.
    ignore_crs : ignore coordinate reference systems: merge files of different systems without a transformation, treat
        degrees as lengths, do not convert default lengths to feet.
    crs : coordinate reference system of the points, as `run` takes it, the path of a file with WKT (.prj, .wkt), or 'none'.
        Coordinates do not change. Default: the systems that the files state.
    replace_crs : `crs` may replace another system that a file states.
    """
    return opened(
        Cloud,
        files,
        recursive=recursive,
        format=format,
        columns=columns,
        depth=depth,
        resolution=resolution,
        ignore_crs=ignore_crs,
        crs=crs,
        replace_crs=replace_crs,
    )


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
    return open(files, ignore_crs=bool(options.get("ignore_crs"))).read(keep=keep, progress=progress, **options)


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

    ``ps.write("a.laz", {"xyz": xyz, "intensity": i}, crs=2154, scale=0.001)``. Takes the options of `run`. LAS and LAZ outputs
    keep the scale and offset of a laspy object, and of arrays read from one LAS or LAZ file, if all coordinates lie on that grid.
    """
    result = performed(points, [], to, keep, None, attributes, crs, progress, options)
    assert isinstance(result, Report)
    return result
