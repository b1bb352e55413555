# SPDX-License-Identifier: MIT
"""Exact neighbours, normals and other local attributes of point clouds of any size.

>>> import pointsweep as ps
>>> n = ps.normals(xyz, k=8)                                    # an (n, 3) array
>>> t = ps.run(xyz, "knn(k=16) | normals | sor", keep=["normal", "outlier"])
>>> planarity = ps.features(k=16)(xyz)["planarity"]             # every stage and pipeline can be called on points
>>> ps.open("tiles/*.laz").run("knn(k=8) | normals", to="out/", memory="2G")

`run` takes points, in arrays or files, through a pipeline to arrays or files; `chunks` returns the results block by block.
`read` and `write` copy points from files to arrays and back. `normals` and `neighbors` perform the two most frequent runs
in one call. `knn`, `where`, `sor` and the other built-in operators are stages of pipelines; `operator` and `select` make
stages of Python functions. `info` describes a file, `summary` computes statistics of points, `verify` checks the output of
a run, and `generate` makes test clouds of known shape.
"""

from . import _core, _stages
from ._check import Check, check
from ._chunks import Chunks, Reduction, chunks, reduce
from ._columns import CloudWithColumns
from ._crs import Crs
from ._errors import Error, PointsweepWarning, UsageError
from ._files import Cloud, read, write
from ._files import open as open
from ._generate import generate
from ._info import FileSummary, info
from ._operator import Operator, PointNeighbors, Points, Select, operator, select
from ._pipeline import Pipeline
from ._render import Picture, render
from ._results import Arrays, Neighbors, RadiusNeighbors, Report
from ._runs import Plan, plan, run
from ._short_forms import neighbors, normals
from ._stage import Stage, former_name
from ._stages import *  # noqa: F403
from ._summary import AttributeSummary, GroupedSummary, Histogram, PointSummary, summary
from ._verify import Verdict, verify

__version__: str = _core.version
set = former_name("set", _stages.assign)
# The public names without `open` and `set`, so that `from pointsweep import *` keeps the builtins of these names.
__all__ = [
    "Arrays", "AttributeSummary", "Check", "Chunks", "Cloud", "CloudWithColumns", "Crs", "Error", "FileSummary", "GroupedSummary", "Histogram", "Neighbors", "Operator", "Pipeline", "Plan",
    "Picture", "PointNeighbors", "PointSummary", "Points", "PointsweepWarning", "RadiusNeighbors", "Reduction", "Report", "Select", "Stage",
    "UsageError", "Verdict", "check", "chunks", "generate", "info", "neighbors", "normals", "operator", "plan", "read",
    "reduce", "render", "run", "select", "summary", "verify", "write",
]  # fmt: skip
__all__ += _stages.__all__
