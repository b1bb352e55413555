# SPDX-License-Identifier: MIT
"""Many runs in one process take no more memory, objects or files than some."""

import gc
import os

import numpy as np
import pytest

import pointsweep as ps

XYZ = np.random.default_rng(9).random((300, 3))


@ps.operator(reads=["normal"], makes={"tilt": "f4"})
def tilt(p):
    return np.abs(p.normal[:, 2])


@ps.operator(makes={"broken": "f4"})
def broken(p):
    raise KeyError("broken")


@ps.select()
def upper(p):
    return p.xyz[:, 2] > 0.5


@ps.reduce(start=0)
def count(n, block):
    return n + len(block["row"])


def fails(error, *arguments):
    try:
        ps.run(*arguments, threads=1)
    except error:
        return
    raise AssertionError("the run has not failed")


@pytest.mark.parametrize(
    "call",
    [
        lambda: ps.run(XYZ, "knn(k=8) | normals" | tilt, threads=1),
        lambda: ps.neighbors(XYZ, radius=0.05, threads=1),
        lambda: fails(KeyError, XYZ, [broken]),
        lambda: fails(ps.UsageError, XYZ, "nonsense"),
        lambda: ps.run(XYZ, ps.knn(8) | ps.normals() | upper, threads=1).to_structured(),
        lambda: next(ps.chunks(XYZ, 100, "knn(k=8) | normals", threads=1)),
        lambda: count(XYZ, "knn(k=8) | normals", rows=100, threads=1),
        lambda: ps.normals(iter([XYZ, XYZ]), threads=1),
        lambda: ps.generate("plane", 100, threads=1)._repr_html_(),
    ],
    ids=["operator", "radius", "exception", "usage error", "select", "chunks", "reduce", "blocks", "generate"],
)
def test_many_runs_leave_nothing_behind(call):
    def held():
        gc.collect()
        with open("/proc/self/statm") as file:
            pages = int(file.read().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE"), len(gc.get_objects()), len(os.listdir("/proc/self/fd"))

    for _ in range(60):
        call()
    before = held()
    for _ in range(1000):
        call()
    after = held()
    assert after[0] - before[0] < 1000 * 1024  # a kilobyte for each run would be a leak
    assert after[1] - before[1] < 50 and after[2] <= before[2]
