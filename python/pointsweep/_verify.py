# SPDX-License-Identifier: MIT
"""Checks of the outputs of runs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Literal, NamedTuple

from . import _core
from ._errors import UsageError
from ._options import count, flag, kept_names, listed, number, path, run_options, way_of_reading, whole, word
from ._progress import called
from ._stage_list import stages_of
from ._types import Path, PipelineLike, ProgressCallback


class Verdict(NamedTuple):
    """The result of `verify`. True if nothing differs and every requested check was possible."""

    input: str  #: name of the (first) input
    output: str
    same: bool  #: nothing differs
    complete: bool  #: every value and row that had to be checked could be, and none remained undecided
    points: int  #: number of points of the output
    order: str  #: order of its rows: 'input' or 'sweep along x'; empty: neither
    computed: tuple[str, ...]  #: attributes that were recomputed by brute force for a sample of the points
    by_own_operator: tuple[str, ...]  #: attributes of `computed` that were recomputed by the operator itself, since they have no formula
    samples: int  #: points of the sample
    wrong_samples: int  #: samples with a wrong value
    values: int  #: values that were recomputed
    open_values: int  #: recomputed values that can be neither right nor wrong for certain, because of rounding
    different_rows: int  #: rows of the output that differ from the input
    difference_count: int
    differences: tuple[str, ...]  #: a sentence about each of the first few differences
    unknown: tuple[str, ...]  #: attributes of the output that are neither the input's nor computed by known stages
    not_checked: tuple[str, ...]  #: other values that were not checked, with the reasons
    conclusion: str  #: one sentence
    text: str  #: the output of `pointsweep verify`

    def __bool__(self) -> bool:
        return self.same and self.complete

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"<pointsweep.Verdict: {self.output}: {self.conclusion}>"


def verify(
    output: Path,
    inputs: Path | Sequence[Path] | None = None,
    *,
    pipeline: PipelineLike | None = None,
    k: int | None = None,
    radius: float | None = None,
    keep: Sequence[str] | str | None = None,
    sample: int = 10000,
    seed: int = 0,
    rows: Iterable[int] | int = (),
    order: Literal["input", "sweep"] | None = None,
    axis: Literal["x", "y", "z", 0, 1, 2] | None = None,
    prefix: str = "",
    decimals: int | None = None,
    positions: Literal["float32", "float64"] | None = None,
    tile: float | None = None,
    tile_origin: tuple[float, float] | None = None,
    tile_buffer: float | None = None,
    split: str | None = None,
    nonfinite: Literal["keep", "drop", "refuse"] | None = None,
    memory: int | str | None = "1G",
    recursive: bool = False,
    format: str = "",
    columns: Sequence[str] | str | None = None,
    depth: int | None = None,
    resolution: float | None = None,
    ignore_crs: bool = False,
    progress: ProgressCallback | bool | None = None,
) -> Verdict:
    """Checks the output of a run by brute force: ``assert ps.verify("out.ply")``.

    Every point and attribute of the input is compared with the output. For a sample of points, a brute-force search
    finds the neighbours, and the made attributes are recomputed by independent formulas.

    Parameters
    ----------
    output : a file, a folder of files, or a .npy file of neighbours or distances.
    inputs : the inputs of the run: a path or several; folders and patterns stand for their files. None: the inputs in the
        output's record, if they are in the folder of the output, in the current folder, or under their recorded
        paths.
    pipeline : the pipeline of the run, with built-in operators. None: the pipeline in the output's record, or one guessed from the attributes.
    k, radius, keep, order, axis, prefix, decimals, positions, tile, tile_origin, tile_buffer, split, nonfinite : options of the run,
        if the output has no record.
    sample, seed : number of points to recompute, and the seed of their random choice.
    rows : row or rows of further points to recompute.
    memory : memory for the neighbours of the sample; a larger sample takes several passes.
    recursive, format, columns, depth, resolution, ignore_crs : as for `open`.
    progress : as for `run`.
    """
    of_run: dict[str, Any] = {
        "axis": axis, "memory": memory, "nonfinite": nonfinite, "prefix": prefix, "ignore_crs": ignore_crs,
        "decimals": decimals, "positions": positions,
        "tile": tile, "tile_origin": tile_origin, "tile_buffer": tile_buffer, "split": split,
    }
    checked = run_options(**of_run)
    neighborhood: list[tuple[str, int | float]] = []
    if k is not None:
        neighborhood.append(("k", whole("k", k)))
    if radius is not None:
        neighborhood.append(("radius", number("radius", radius)))
    options: dict[str, Any] = {
        **{name: checked[name] for name in of_run},
        "pipeline": "" if pipeline is None else _text_of(pipeline),
        "neighborhood": neighborhood,
        "keep": kept_names(keep),
        "sample": count("sample", sample),
        "seed": count("seed", seed),
        "rows": [count("rows", row) for row in listed(rows)],
        "order": word("order", order),
        "recursive": flag("recursive", recursive),
        "format": way_of_reading(format, columns, depth, resolution),
    }
    named = [] if inputs is None else listed(inputs)
    with called(progress) as shown:
        found = _core.verify([path("inputs", file) for file in named], path("output", output), options, shown)
    values: dict[str, Any] = {name: tuple(v) if isinstance(v, list) else v for name, v in found.items()}
    return Verdict(**values)


def _text_of(pipeline: PipelineLike) -> str:
    stages = stages_of(pipeline)
    for stage in stages:
        if not isinstance(stage, str):
            raise UsageError(f"pipeline: '{stage.name}' is an operator of Python, for which verify has no formula; leave it out.")
    return " | ".join(stage for stage in stages if isinstance(stage, str))
