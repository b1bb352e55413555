# SPDX-License-Identifier: MIT
"""graphs.py TOOL: `components` against scipy and `dbscan` against scikit-learn, on generated clouds; the test numpy/graphs, with
what the environment has.

Components, core points, noise and the clusters of core points are equal. Border points may differ: there they belong to the
first cluster that comes to them, here to that of the nearest core point."""
import sys

import numpy as np
from peers import Comparison, has, positions

comparison = Comparison(sys.argv[1])
tool = comparison.tool


def is_same_partition(a, b):
    """Whether two labellings divide the points alike."""
    pairs = np.unique(np.stack([a, b]), axis=1).shape[1]
    return pairs == len(np.unique(a)) == len(np.unique(b))


def components_of(n, i, j):
    import scipy.sparse
    import scipy.sparse.csgraph

    graph = scipy.sparse.coo_array((np.ones(len(i), bool), (i, j)), shape=(n, n))
    return scipy.sparse.csgraph.connected_components(graph, directed=False)


def compare_components(source, radius, k):
    import scipy.spatial

    got = tool(source, f"knn(radius={radius}) | components(distance={radius})")
    points = positions(got)
    tree = scipy.spatial.KDTree(points)
    count, theirs = components_of(len(points), *tree.query_pairs(radius, output_type="ndarray").T)
    same = is_same_partition(got["component"], theirs) and (np.bincount(theirs)[theirs] == got["component_size"]).all()
    comparison.expect(same, f"scipy, distance {radius}, {source.name}, {count} components")
    got = tool(source, f"knn(k={k}) | components")
    _, near = tree.query(points, k + 1)
    count, theirs = components_of(len(points), np.repeat(np.arange(len(points)), k + 1), near.ravel())
    same = is_same_partition(got["component"], theirs)
    comparison.expect(same, f"scipy, k {k}, {source.name}, {count} components")


def compare_dbscan(source, eps, least):
    import sklearn.cluster

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
    comparison.expect(same, f"scikit-learn, eps {eps}, min_points {least}, {source.name}, {len(cluster_of)} clusters, {(model.labels_ < 0).sum()} noise, "
                            f"{other} of {border.sum()} border points in another cluster")


def main():
    for shape, radius in (("tls", 0.4), ("statue", 0.02), ("volume", 0.03)):
        source = comparison.generate(shape, "--double")
        for r in (radius / 2, radius):
            if has("scipy"):
                compare_components(source, r, 3)
            if has("sklearn"):
                for least in (3, 8):
                    compare_dbscan(source, r, least)
    comparison.end()


main()
