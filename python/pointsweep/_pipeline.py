# SPDX-License-Identifier: MIT
"""Pipelines: stages that are joined, compared and called on points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from ._options import with_run_options
from ._results import Arrays, Report
from ._runs import performed
from ._stage_list import canonical_stages, stages_of
from ._types import FunctionStage, Path, PipelineLike, PointOptions, ProgressCallback, RunOptions, Stages

if TYPE_CHECKING:
    from typing_extensions import Unpack


class Joinable(Stages):
    """Stages that are joined by ``|`` and called on points. They are equal if they stand for the same stages with the same options."""

    @overload
    def __call__(
        self,
        points: Any,
        *,
        to: None = None,
        keep: Sequence[str] | str | None = None,
        out: Mapping[str, np.ndarray] | None = None,
        **options: Unpack[PointOptions],
    ) -> Arrays: ...

    @overload
    def __call__(
        self,
        points: Any,
        *,
        to: Path | Sequence[Path],
        keep: Sequence[str] | str | None = None,
        **options: Unpack[PointOptions],
    ) -> Report: ...

    @with_run_options
    def __call__(
        self,
        points: Any,
        *,
        to: Path | Sequence[Path] | None = None,
        keep: Sequence[str] | str | None = None,
        out: Mapping[str, np.ndarray] | None = None,
        attributes: Mapping[str, Any] | None = None,
        crs: Any = None,
        progress: ProgressCallback | bool | None = None,
        **options: Unpack[RunOptions],
    ) -> Arrays | Report:
        """`pointsweep.run` of these stages over points, in arrays or files, with its options."""
        return performed(points, self._stages(), to, keep, out, attributes, crs, progress, options)

    def __or__(self, other: PipelineLike) -> Pipeline:
        return Pipeline(self, other)

    def __ror__(self, other: PipelineLike) -> Pipeline:
        return Pipeline(other, self)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Joinable):
            return NotImplemented
        return self is other or canonical_stages(self) == canonical_stages(other)

    def __hash__(self) -> int:
        return hash(canonical_stages(self))


class Pipeline(Joinable):
    """Stages in order, made with ``|``: ``ps.knn(16) | ps.normals() | roughness | "where(roughness < 0.1)"``.

    At least one side of each ``|`` must be a stage, an operator or a pipeline. Texts are in the language of
    docs/pipelines.md; docs/operators.md lists the operators with their options. Call a pipeline on points to run it.
    Pipelines are equal if their stages are, and can be pickled.
    """

    def __init__(self, *stages: PipelineLike) -> None:
        self.stages: tuple[str | FunctionStage, ...] = tuple(stages_of(stages))

    def _stages(self) -> list[str | FunctionStage]:
        return list(self.stages)

    def __repr__(self) -> str:
        return f"<pointsweep.Pipeline: {' | '.join(s if isinstance(s, str) else s.name for s in self.stages)}>"
