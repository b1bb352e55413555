# SPDX-License-Identifier: MIT
"""Normals, neighbours and outliers of points in arrays. Checks itself on a sphere, whose normals are known."""

import numpy as np

import pointsweep as ps

cloud = ps.generate("sphere", 100_000, noise=0.0005)
xyz = cloud["xyz"]

normals = ps.normals(xyz, k=12)
cosine = np.abs(np.einsum("ni,ni->n", normals, cloud["normal"]))
print(f"median angle to the sphere's normals: {np.degrees(np.arccos(np.median(cosine))):.2f} degrees")

indices, distances = ps.neighbors(xyz, k=16)
print(f"mean distance to the nearest point: {distances[:, 0].mean():.5f}")

kept = ps.run(xyz, ps.knn(16) | ps.sor() | ps.where("outlier == 0"))
print(f"{len(kept['row'])} of {len(xyz)} points are no outliers")
