# SPDX-License-Identifier: MIT
"""Exact neighbours, normals and other local attributes of point clouds of any size.

>>> import pointsweep as ps
>>> n = ps.normals(xyz, k=8)                                    # an (n, 3) array
>>> t = ps.run(xyz, "knn(k=16) | normals | sor", keep=["normal", "outlier"])
>>> ps.open("tiles/*.laz").run("knn(k=8) | normals", to="out/", memory="2G")

`run` is the heart: points in arrays or files, through a pipeline, to arrays or files. `normals` and `neighbors` are
short for the two most wanted runs, `operator` makes a stage of a function, `generate` makes points to try things with.
"""

from . import _core
from ._errors import Error, PointsweepWarning, UsageError
from ._files import Cloud, Crs, open
from ._generate import generate
from ._operator import Operator, PointNeighbors, Points, operator
from ._pipeline import Pipeline
from ._results import Arrays, Neighbors, RadiusNeighbors, Report
from ._runs import neighbors, normals, run

__version__: str = _core.version
__all__ = [
    "Arrays", "Cloud", "Crs", "Error", "Neighbors", "Operator", "Pipeline", "PointNeighbors", "Points",
    "PointsweepWarning", "RadiusNeighbors", "Report", "UsageError", "generate", "neighbors", "normals", "open",
    "operator", "run",
]  # fmt: skip
