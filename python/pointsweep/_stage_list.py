# SPDX-License-Identifier: MIT
"""Pipelines as lists of texts and of functions of Python, as the extension module takes them."""

from __future__ import annotations

import copy
import os
import re

from . import _core
from ._errors import Error, UsageError
from ._types import FunctionStage, Path, PipelineLike, Stages


def stages_of(pipeline: PipelineLike) -> list[str | FunctionStage]:
    """Returns the pipeline as a list of texts and operators. A path becomes the content of its file. A text that ends in .json
    is a path, as for the tool."""
    if isinstance(pipeline, os.PathLike) or (isinstance(pipeline, str) and pipeline.endswith(".json")):
        return [_content_of(pipeline)]
    if isinstance(pipeline, str):
        return [pipeline]
    if isinstance(pipeline, Stages):
        return pipeline._stages()
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


def _content_of(path: Path) -> str:
    name = os.fspath(path)
    try:
        with open(path, encoding="utf-8") as file:
            return file.read()
    except OSError as error:
        raise Error(f"{name}: the pipeline cannot be read ({error.strerror}); check the name and its permissions.") from None
    except UnicodeDecodeError as error:
        raise Error(f"{name}: byte {error.start} of the pipeline is not UTF-8; save the file in UTF-8.") from None


def canonical_stages(pipeline: PipelineLike) -> tuple[str, ...]:
    """Returns texts that are equal for equal stages, in any notation; invalid stages stay unchanged."""
    stages: list[str | FunctionStage] = []
    for stage in stages_of(pipeline):
        if not isinstance(stage, str):
            digest, unknown = stage._identity()
            stage = copy.copy(stage)
            stage._digest = digest + (f" {id(stage.function)}" if unknown else "")
        stages.append(stage)
    try:
        return tuple(_core.canonical_stages(stages))
    except Error:
        return tuple(stage if isinstance(stage, str) else f"{stage.name}({stage._digest})" for stage in stages)


def read_by(stages: list[str | FunctionStage]) -> set[str]:
    """Returns the names of the attributes that operators of Python among the stages read."""
    lists = [getattr(stage, option, ()) for stage in stages for option in ("reads", "reads_neighbors")]
    return {name for names in lists for name in names}


def refuse_made_xyz(stages: list[str | FunctionStage]) -> None:
    """Raises UsageError if a stage `set` makes an attribute 'xyz', which would hide the positions among the results in arrays."""
    named = [stage for stage in stages if isinstance(stage, str) and "xyz" in stage]
    if named and any(re.search(r'(^set\("|, )xyz = ', stage) for stage in canonical_stages(named)):
        raise UsageError("set: 'xyz' is what results call the positions; assign to x, y and z, or to an attribute of another name.")


def identified(stages: list[str | FunctionStage], resumed: bool) -> list[str | FunctionStage]:
    """Returns the stages with digests of their functions. If the run is `resumed`, raises UsageError for a function that uses
    values that cannot be compared with those of the earlier run."""
    result: list[str | FunctionStage] = []
    for stage in stages:
        if not isinstance(stage, str):
            digest, unknown = stage._identity()
            if resumed and unknown:
                raise UsageError(
                    f"resume: operator '{stage.name}' uses {unknown[0]}, which cannot be compared with that of the run that "
                    "is resumed; make it inside of the function, pass numbers or arrays instead, or leave resume out."
                )
            stage = copy.copy(stage)
            stage._digest = digest
        result.append(stage)
    return result
