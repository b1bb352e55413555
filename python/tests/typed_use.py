# SPDX-License-Identifier: MIT
"""A program of a user, which mypy --strict checks and nobody runs: each type is what it should be, and what is wrong is an error."""

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from typing_extensions import assert_type

import pointsweep as ps


def stages(xyz: npt.NDArray[np.float64]) -> None:
    assert_type(ps.knn(16), ps.Stage)
    pipeline = ps.knn(16) | ps.normals(orient="up") | "sor" | ps.where("outlier == 0")
    assert_type(pipeline, ps.Pipeline)
    assert_type(pipeline(xyz, memory="2G", keep="normal"), ps.Arrays)
    assert_type(pipeline(xyz, to="out.ply", overwrite=True), ps.Report)
    assert_type(ps.features(["planarity"], k=16)(xyz), ps.Arrays)
    assert_type(ps.run(xyz, pipeline, threads=2), ps.Arrays)
    assert_type(ps.run(xyz, "normals", to=Path("out.ply"), provenance=False), ps.Report)
    ps.knn("many")  # type: ignore[arg-type]
    ps.normals(orient="down")  # type: ignore[call-overload]
    ps.run(xyz, "normals", thread=2)  # type: ignore[call-overload]
    ps.run(xyz, "normals", nonfinite="skip")  # type: ignore[call-overload]
    ps.curvature(xyz)  # type: ignore[arg-type, call-arg]


def arrays(xyz: npt.NDArray[np.float64]) -> None:
    normals: npt.NDArray[np.float32] = ps.normals(xyz, k=8, memory="1G")
    assert_type(ps.normals(viewpoint=(0, 0, 1)), ps.Stage)
    assert_type(ps.neighbors(xyz, k=8), ps.Neighbors)
    assert_type(ps.neighbors(xyz, radius=0.5), ps.RadiusNeighbors)
    assert_type(ps.neighbors(xyz, k=8, queries=xyz), ps.Neighbors)
    assert_type(ps.neighbors(xyz, radius=0.5, queries=xyz), ps.RadiusNeighbors)
    ps.normals(xyz, out=normals)


def files(folder: Path) -> None:
    cloud = ps.open([folder / "a.laz", "b.laz"])
    assert_type(cloud, ps.Cloud)
    assert_type(cloud.run("normals", keep=["normal"]), ps.Arrays)
    assert_type(cloud.run(ps.normals(), to=folder, resume=folder / "work"), ps.Report)
    assert_type(cloud.chunks(1000, ps.knn(8) | ps.normals()), ps.Chunks)
    cloud.run("normals", memry="2G")  # type: ignore[call-overload]
    for part in cloud.chunks(1000):
        assert_type(part, ps.Arrays)
    ps.distance_to(cloud)(cloud)
    assert_type(cloud.summary(), ps.PointSummary)
    assert_type(cloud.summary(by="classification", keep=["z"]), ps.GroupedSummary)


@ps.operator(reads=["normal"], makes={"roughness": "f4"})
def roughness(p: ps.Points) -> Any:
    return p.neighbors.xyz.mean((1, 2))


assert_type(roughness, ps.Operator)
assert_type(ps.knn(8) | roughness, ps.Pipeline)
