# SPDX-License-Identifier: MIT
"""graphs.py TOOL: `components` against scipy and `dbscan` against scikit-learn, on generated clouds. To be run by hand, in a Python
environment with numpy, scipy, scikit-learn and plyfile.

With scipy 1.17 and scikit-learn 1.9 components, core points, noise and the clusters of core points were equal. Border points may
differ: there they belong to the first cluster that comes to them, here to that of the nearest core point."""
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import plyfile
import scipy.sparse
import scipy.spatial
import sklearn.cluster

TOOL, FOLDER = sys.argv[1], pathlib.Path(tempfile.mkdtemp())


def tool(source, pipeline):
    subprocess.run([TOOL, "run", source, FOLDER / "out.ply", "-f", "-q", "--pipeline", pipeline], check=True)
    return plyfile.PlyData.read(str(FOLDER / "out.ply"))["vertex"].data


def positions(table):
    return np.stack([table[axis] for axis in "xyz"], axis=1).astype(np.float64)


def is_same_partition(a, b):
    """Whether two labellings divide the points alike."""
    pairs = np.unique(np.stack([a, b]), axis=1).shape[1]
    return pairs == len(np.unique(a)) == len(np.unique(b))


def components_of(n, i, j):
    graph = scipy.sparse.coo_array((np.ones(len(i), bool), (i, j)), shape=(n, n))
    return scipy.sparse.csgraph.connected_components(graph, directed=False)


def compare_components(source, radius, k):
    got = tool(source, f"knn(radius={radius}) | components(distance={radius})")
    points = positions(got)
    tree = scipy.spatial.KDTree(points)
    count, theirs = components_of(len(points), *tree.query_pairs(radius, output_type="ndarray").T)
    same = is_same_partition(got["component"], theirs) and (np.bincount(theirs)[theirs] == got["component_size"]).all()
    print(f"scipy, distance {radius}, {source.name}: {count} components, {'equal' if same else 'DIFFERENT'}")
    got = tool(source, f"knn(k={k}) | components")
    _, near = tree.query(points, k + 1)
    count, theirs = components_of(len(points), np.repeat(np.arange(len(points)), k + 1), near.ravel())
    same = is_same_partition(got["component"], theirs)
    print(f"scipy, k {k}, {source.name}: {count} components, {'equal' if same else 'DIFFERENT'}")


def compare_dbscan(source, eps, least):
    got = tool(source, f"knn(radius={eps}) | dbscan(eps={eps}, min_points={least})")
    points = positions(got)
    model = sklearn.cluster.DBSCAN(eps=eps, min_samples=least).fit(points)
    core = np.zeros(len(points), bool)
    core[model.core_sample_indices_] = True
    same = (core == (got["core"] != 0)).all() and ((model.labels_ < 0) == (got["cluster"] < 0)).all()
    same = same and is_same_partition(model.labels_[core], got["cluster"][core])
    cluster_of = dict(zip(model.labels_[core], got["cluster"][core]))
    border = ~core & (model.labels_ >= 0)
    other = sum(cluster_of[theirs] != ours for theirs, ours in zip(model.labels_[border], got["cluster"][border]))
    print(f"scikit-learn, eps {eps}, min_points {least}, {source.name}: {len(cluster_of)} clusters, {(model.labels_ < 0).sum()} noise, "
          f"{'equal' if same else 'DIFFERENT'}; {other} of {border.sum()} border points in another cluster")


def main():
    for shape, radius in (("tls", 0.4), ("statue", 0.02), ("volume", 0.03)):
        source = FOLDER / f"{shape}.ply"
        subprocess.run([TOOL, "generate", shape, source, "-n", "40k", "-q", "--double"], check=True)
        for r in (radius / 2, radius):
            compare_components(source, r, 3)
            for least in (3, 8):
                compare_dbscan(source, r, least)


main()
