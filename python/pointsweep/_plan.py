# SPDX-License-Identifier: MIT
"""Descriptions of runs before they run."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from . import _core
from ._errors import UsageError
from ._options import names, path, run_options, with_run_options
from ._outputs import outputs_of
from ._sources import source_of
from ._stage_list import stages_of
from ._types import Path, PipelineLike, RunOptions

if TYPE_CHECKING:
    from typing_extensions import Unpack


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
    checked = run_options(**options)
    divides = bool(checked["tile"] or checked["split"])
    file = "" if to is None else path("to", to)
    if not divides and (file.endswith(os.sep) or os.path.isdir(file or os.devnull)):
        raise UsageError(f"to: {file} is a folder; a plan is that of a run to one file, or one that divides its output.")
    source = source_of(points, attributes, crs, checked)
    if file and divides:
        file = str(outputs_of(file, source, divides))
    text = _core.plan(source.inputs, stages, names("keep", keep), {**checked, **source.options}, source.groups, file)
    return Plan(text)
