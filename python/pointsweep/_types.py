# SPDX-License-Identifier: MIT
"""Types that the modules of the package share."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, TypedDict, Union

Path = Union[str, "os.PathLike[str]"]

#: A function that is called with (phase, points done, points in all).
ProgressCallback = Callable[[str, int, int], Any]


class Stages:
    """Stages of a pipeline in order: a `Stage`, an `Operator` or a `Pipeline`."""

    def _stages(self) -> list[str | FunctionStage]:
        """Returns the stages as the extension module takes them: texts, and stages that call functions of Python."""
        raise NotImplementedError


class FunctionStage(Stages):
    """A stage that calls a function of Python: an `Operator`."""

    name: str
    function: Callable[..., Any]
    #: digest of the function for records of files and checkpoints, set in the copy that such a run uses
    _digest = ""

    def _stages(self) -> list[str | FunctionStage]:
        return [self]

    def _identity(self) -> tuple[str, list[str]]:
        """Returns the digest of the function, and the values that the digest excludes since they cannot be compared."""
        raise NotImplementedError


#: The forms of a pipeline that `pointsweep.run` accepts.
PipelineLike = Union[str, Stages, "os.PathLike[str]", Sequence[Any]]


class Files:
    """Point files as one cloud: a `Cloud`."""

    def __init__(self, files: list[str], names: list[str], options: dict[str, Any], known: dict[str, Any]) -> None:
        self.files = files  #: paths, in the order of the rows
        self._names = names  # names of the outputs of these files in a folder of outputs
        self._options = options  # options with which the files were opened
        self._known = known  # facts in the headers, from the extension module


class FilesWithColumns:
    """Point files with additional arrays: a `CloudWithColumns`."""

    cloud: Files

    @property
    def attributes(self) -> dict[str, Any]:
        """The types of the attributes of the files and of the arrays, by name."""
        raise NotImplementedError

    def _stage(self) -> FunctionStage:
        """Returns the stage that makes attributes of the arrays."""
        raise NotImplementedError

    def _checked_options(self, options: RunOptions, to_files: bool) -> RunOptions:
        """Returns the options of a run over the files that begins with `_stage`. Raises UsageError for those that do not fit."""
        raise NotImplementedError


class RunOptions(TypedDict, total=False):
    """The options of `pointsweep.run` that have the same meaning for all kinds of input and output."""

    order: Literal["input", "sweep"]
    axis: Literal["auto", "x", "y", "z", 0, 1, 2] | None
    memory: int | str | None
    threads: int | None
    temp_folder: Path | None
    resume: Path | None
    nonfinite: Literal["keep", "drop", "refuse"] | None
    overwrite: bool
    replace: Sequence[str] | str | None
    prefix: str
    positions: Literal["float32", "float64"] | None
    scale: float | Sequence[float] | None
    offset: Literal["auto"] | Sequence[float] | None
    point_format: int | None
    las_version: Literal["1.0", "1.1", "1.2", "1.3", "1.4"] | None
    decimals: int | None
    tile: float | None
    tile_origin: Sequence[float] | None
    tile_buffer: float | None
    split: str | None
    provenance: Literal["names", "paths"] | bool
    ignore_crs: bool


class PointOptions(RunOptions, total=False):
    """The options of runs over points in arrays or files."""

    attributes: Mapping[str, Any] | None
    crs: Any
    progress: ProgressCallback | bool | None


class SummaryOptions(TypedDict, total=False):
    """The options of `Cloud.summary` that do not decide the type of its result."""

    histogram: Sequence[str] | str | None
    bins: int
    keep: Sequence[str] | str | None
    progress: ProgressCallback | bool | None
