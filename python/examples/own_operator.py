# SPDX-License-Identifier: MIT
"""An operator of one's own in NumPy, in a chain with built-in ones, on a cloud of any size.

Roughness is the mean distance of the neighbours from the tangent plane of a point.

    python own_operator.py scan.laz out.laz
"""

import sys

import numpy as np

import pointsweep as ps


@ps.operator(reads=["normal"], makes={"roughness": "f4"})
def roughness(p: ps.Points) -> np.ndarray:
    d = p.neighbors_xyz - p.xyz[:, None]  # (n, 16, 3)
    return np.abs(np.einsum("nkj,nj->nk", d, p.normal)).mean(1)


if __name__ == "__main__":
    report = ps.open(sys.argv[1]).run("knn(k=16) | normals" | roughness, to=sys.argv[2], memory="1G")
    print(report)
