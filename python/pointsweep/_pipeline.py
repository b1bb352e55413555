# SPDX-License-Identifier: MIT
"""Pipelines: texts and operators of Python, one after another."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, Union

from . import _core
from ._errors import Error, UsageError
from ._joinable import Joinable
from ._operator import Operator
from ._stage import Stage

#: What `pointsweep.run` takes as a pipeline.
PipelineLike = Union[str, Joinable, os.PathLike[str], Sequence[Any]]


class Pipeline(Joinable):
    """Stages in order, made with ``|``: ``ps.knn(16) | ps.normals() | roughness | "where(roughness < 0.1)"``.

    At least one side of each ``|`` has to be a stage, an operator or a pipeline. Texts are in the language of
    docs/pipelines.md; docs/operators.md lists the operators with their options. Pipelines are equal if their stages are,
    and can be pickled.
    """

    def __init__(self, *stages: PipelineLike) -> None:
        self.stages: tuple[str | Operator, ...] = tuple(stages_of(stages))

    def __repr__(self) -> str:
        return f"<pointsweep.Pipeline: {' | '.join(s if isinstance(s, str) else s.name for s in self.stages)}>"


def stages_of(pipeline: PipelineLike) -> list[str | Operator]:
    """Texts and operators; the content of a file for its path."""
    if isinstance(pipeline, (str, Operator)):
        return [pipeline]
    if isinstance(pipeline, Stage):
        return [str(pipeline)]
    if isinstance(pipeline, Pipeline):
        return list(pipeline.stages)
    if isinstance(pipeline, os.PathLike):
        with open(pipeline, encoding="utf-8") as file:
            return [file.read()]
    if isinstance(pipeline, (list, tuple)):
        if not pipeline:
            raise UsageError("pipeline: is empty; give one such as 'knn(k=8) | normals'.")
        return [stage for part in pipeline for stage in stages_of(part)]
    name = getattr(pipeline, "__name__", None)
    if callable(pipeline) and name is not None:
        raise UsageError(f"pipeline: {name} is a function; write {name}(), or make it an operator with @pointsweep.operator.")
    raise UsageError(
        f"pipeline: {pipeline!r} is neither a text, nor a stage (made with pointsweep.knn() or the like), nor an operator "
        "(made with @pointsweep.operator), nor a list of these."
    )


def canonical_stages(pipeline: PipelineLike) -> tuple[str, ...]:
    """Texts that are equal if the stages are, however they were written; as they were written where they are wrong."""
    stages: list[str | Operator] = []
    for stage in stages_of(pipeline):
        if isinstance(stage, Operator):
            digest, unknown = stage._identity()
            stage = stage.__copy__()
            stage._digest = digest + (f" {id(stage.function)}" if unknown else "")
        stages.append(stage)
    try:
        return tuple(_core.canonical_stages(stages))
    except Error:
        return tuple(stage if isinstance(stage, str) else f"{stage.name}({stage._digest})" for stage in stages)


def identified(stages: list[str | Operator], resumed: bool) -> list[str | Operator]:
    """The stages with the digests of functions. A run to be `resumed` is refused where a function uses what cannot be
    compared with what it used before."""
    result: list[str | Operator] = []
    for stage in stages:
        if isinstance(stage, Operator):
            digest, unknown = stage._identity()
            if resumed and unknown:
                raise UsageError(
                    f"resume: operator '{stage.name}' uses {unknown[0]}, which cannot be compared with that of the run that "
                    "is resumed; make it inside of the function, pass numbers or arrays instead, or leave resume out."
                )
            stage = stage.__copy__()
            stage._digest = digest
        result.append(stage)
    return result
