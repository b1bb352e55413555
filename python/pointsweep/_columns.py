# SPDX-License-Identifier: MIT
"""Arrays in memory as additional attributes of points in files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ._errors import UsageError
from ._operator import Operator, Points, operator
from ._options import with_run_options
from ._results import Arrays, Report
from ._runs import performed
from ._sources import every_array, numbers
from ._stage_list import stages_of
from ._types import Files, FilesWithColumns, FunctionStage, Path, PipelineLike, ProgressCallback, RunOptions

if TYPE_CHECKING:
    from typing_extensions import Unpack


class CloudWithColumns(FilesWithColumns):
    """Point files with additional arrays; made with `Cloud.with_columns`. Arrays are not copied, so an array may be a `numpy.memmap`."""

    def __init__(self, cloud: Files, attributes: Mapping[str, np.dtype[Any]], columns: Mapping[str, Any]) -> None:
        self.cloud = cloud  #: the point files
        self._attributes = dict(attributes)  # types of the attributes of the files
        if "xyz" in columns:
            raise UsageError("with_columns: 'xyz' is what results call the positions; replace them with x=, y= and z=.")
        self.columns = {name: _column(name, values, len(self)) for name, values in columns.items()}
        if not self.columns:
            raise UsageError("with_columns: name at least one array, e.g. with_columns(label=labels).")

    @property
    def attributes(self) -> dict[str, np.dtype[Any]]:
        """The types of the attributes by name, as in `Cloud.attributes`, including the columns."""
        return {**self._attributes, **self._types()}

    def with_columns(self, **columns: Any) -> CloudWithColumns:
        """Returns these files with more arrays. An array replaces a column of the same name."""
        return CloudWithColumns(self.cloud, self._attributes, {**self.columns, **columns})

    @with_run_options
    def run(
        self,
        pipeline: PipelineLike,
        *,
        to: Path | Sequence[Path] | None = None,
        keep: Sequence[str] | str | None = None,
        progress: ProgressCallback | bool | None = None,
        **options: Unpack[RunOptions],
    ) -> Arrays | Report:
        """Calls `pointsweep.run` on these files. Stages read the columns as attributes of the input."""
        return performed(self, stages_of(pipeline), to, keep, None, None, None, progress, options)

    @with_run_options
    def read(
        self,
        *,
        keep: Sequence[str] | str | None = None,
        progress: ProgressCallback | bool | None = None,
        **options: Unpack[RunOptions],
    ) -> Arrays:
        """Returns all points with their attributes and the columns, in a dict of arrays, like `Cloud.read`."""
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
        progress: ProgressCallback | bool | None = None,
        **options: Unpack[RunOptions],
    ) -> Report:
        """Writes the points with the columns and all contents of the files, to a file, or to a folder with a file for each
        input."""
        result = performed(self, [], to, keep, None, None, None, progress, options)
        assert isinstance(result, Report)
        return result

    def __len__(self) -> int:
        return int(self.cloud._known["count"])

    def __repr__(self) -> str:
        return f"<pointsweep.CloudWithColumns: {', '.join(self.columns)} beside {self.cloud!r}>"

    def _checked_options(self, options: RunOptions, to_files: bool) -> RunOptions:
        if options.get("nonfinite") == "drop":
            raise UsageError(
                "nonfinite: points that are dropped would give their rows of the columns to others; leave it out, and "
                "such points with where(x - x == 0 and y - y == 0 and z - z == 0)."
            )
        if not to_files:
            return options
        named = options.get("replace")
        replaced = [name for name in self.columns if name in self._attributes]
        return {**options, "replace": [*([named] if isinstance(named, str) else named or ()), *replaced]}

    def _stage(self) -> Operator:
        columns = self.columns

        @operator(makes=self._types(), neighbors=False)
        def with_columns(p: Points) -> dict[str, np.ndarray]:
            rows = p.rows
            return {name: np.asarray(values[rows]) for name, values in columns.items()}

        return with_columns

    def _types(self) -> dict[str, np.dtype[Any]]:
        return {name: np.dtype((v.dtype, v.shape[1])) if v.ndim == 2 else v.dtype for name, v in self.columns.items()}


def _column(name: str, values: Any, n: int) -> np.ndarray:
    array = numbers(name, values)
    if array.ndim not in (1, 2) or len(array) != n:
        raise UsageError(f"{name}: has the shape {array.shape}, but the files have {n} points; give a row for each.")
    if array.dtype == np.bool_:
        array = array.view(np.uint8)
    return array
