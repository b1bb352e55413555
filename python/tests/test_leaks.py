# SPDX-License-Identifier: MIT
"""Many runs in one process take no more memory, objects or files than some."""

import ctypes
import gc
import os
import sys

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
    for _ in range(100):  # caches of Python grow for some time
        call()
    rounds = []
    for _ in range(3):  # a leak grows in each round, a cache of the interpreter in one round only
        before = held()
        for _ in range(100):
            call()
        rounds.append({name: after - before[name] for name, after in held().items()})
    grown = {name: min(round[name] for round in rounds) for name in rounds[0]}
    # A kilobyte for each run would be a leak: of malloc, or two blocks of Python's, which have 512 bytes at most.
    assert grown["bytes"] < 100 * 1024 and grown["blocks"] < 200, rounds
    assert grown["objects"] < 50 and grown["files"] <= 0, rounds


class Mallinfo2(ctypes.Structure):
    """Of malloc.h of glibc: bytes in use and bytes of large blocks among others."""

    _fields_ = [(name, ctypes.c_size_t) for name in "arena ordblks smblks hblks hblkhd usmblks fsmblks used free keepcost".split()]


def held():
    """What the process holds: bytes of malloc, small blocks and objects of Python, open files. All are exact counts."""
    gc.collect()
    mallinfo2 = ctypes.CDLL(None).mallinfo2
    mallinfo2.restype = Mallinfo2
    memory = mallinfo2()
    return {
        "bytes": memory.used + memory.hblkhd,
        "blocks": sys.getallocatedblocks(),
        "objects": len(gc.get_objects()),
        "files": len(os.listdir("/proc/self/fd")),
    }
