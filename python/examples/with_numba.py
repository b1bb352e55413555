# SPDX-License-Identifier: MIT
"""An operator whose loop is compiled by Numba. `nogil` lets the threads of a run call it at the same time.

Prominence is the height of a point above the lowest of its neighbours that lie within a slope of 45 degrees.

    python with_numba.py scan.laz out.laz
"""

import sys

import numba
import numpy as np

import pointsweep as ps


@numba.njit(nogil=True)  # type: ignore[untyped-decorator,unused-ignore]
def lowest_within_slope(xyz: np.ndarray, neighbors: np.ndarray, counts: np.ndarray) -> np.ndarray:
    result = np.zeros(len(xyz), np.float32)
    for i in range(len(xyz)):
        for j in range(counts[i]):
            dx, dy, dz = neighbors[i, j] - xyz[i]
            if dz * dz <= dx * dx + dy * dy:
                result[i] = max(result[i], -dz)
    return result


@ps.operator(makes={"prominence": "f4"})
def prominence(p: ps.Points) -> np.ndarray:
    result: np.ndarray = lowest_within_slope(p.xyz, p.neighbors_xyz, p.neighbors.counts)
    return result


if __name__ == "__main__":
    print(ps.open(sys.argv[1]).run(ps.knn(16) | prominence, to=sys.argv[2], memory="1G"))
