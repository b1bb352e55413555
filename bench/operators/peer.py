# SPDX-License-Identifier: MIT
"""One operator by another library: peer.py LIBRARY OPERATOR PIPELINE CLOUD.ply OTHER.ply OUTPUT.ply THREADS.

Prints wall and CPU seconds of the call, the peak of the process, and how its answer agrees with the output of
pointsweep, as JSON. Arrays have the type that the library wants before the call is timed."""
import json
import re
import sys
import time

import numpy as np


def table_of(path):
    with open(path, "rb") as file:
        head = b""
        while not head.endswith(b"end_header\n"):
            head += file.readline()
        types = {"float": "f4", "double": "f8", "uchar": "u1", "char": "i1", "ushort": "u2", "short": "i2", "uint": "u4", "int": "i4",
                 "int64": "i8", "uint64": "u8"}
        names = re.findall(r"property (\w+) (\w+)\n", head.decode())
        return np.fromfile(file, [(name, "<" + types[kind]) for kind, name in names])


def xyz_of(table):
    return np.column_stack([table["x"], table["y"], table["z"]]).astype(float)


def number(pipeline, name):
    return float(re.search(rf"{name}=([0-9.e-]+)", pipeline)[1])


class Task:
    """The call, and the comparison of its answer: the share of equal values, or two numbers."""

    def __init__(self, pipeline, cloud, other, output, threads):
        self.pipeline, self.cloud, self.other, self.output, self.threads = pipeline, cloud, other, output, threads

    def share(self, answer, column, tolerance=0.0, least=0.999):
        got = self.output[column].astype(float)
        share = float(np.mean(np.isclose(got, answer, rtol=0, atol=tolerance, equal_nan=True)))
        return share >= least, f"{share:.4%} equal"

    def numbers(self, theirs, ours, tolerance=0.0):
        return abs(theirs - ours) <= tolerance * max(abs(ours), 1), f"{theirs} and {ours}"


def features(library, task):
    import pgeof
    xyz = np.ascontiguousarray(1000 * xyz_of(task.cloud), np.float32)  # pgeof adds 0.001 to divisors

    def call():
        rows, _ = pgeof.knn_search(xyz, xyz, 17)
        starts = np.arange(0, len(xyz) * 17 + 1, 17, dtype=np.uint32)
        return pgeof.compute_features(xyz, rows.ravel(), starts)
    return call, lambda made: task.share(made[:, 1], "planarity", 0.05, 0.8)


def open3d_cloud(table):
    import open3d
    return open3d.geometry.PointCloud(open3d.utility.Vector3dVector(xyz_of(table)))


def kept(index, n):
    mask = np.ones(n)
    mask[index] = 0
    return mask


def sor(library, task):
    cloud = open3d_cloud(task.cloud)
    return lambda: cloud.remove_statistical_outlier(17, 2.0)[1], lambda index: task.share(kept(index, len(task.cloud)), "outlier")


def ror(library, task):
    cloud, radius = open3d_cloud(task.cloud), number(task.pipeline, "radius")
    return lambda: cloud.remove_radius_outlier(8, radius)[1], lambda index: task.share(kept(index, len(task.cloud)), "outlier")


def lof(library, task):
    from sklearn.neighbors import LocalOutlierFactor
    xyz = xyz_of(task.cloud)
    return (lambda: -LocalOutlierFactor(n_neighbors=16, n_jobs=task.threads).fit(xyz).negative_outlier_factor_,
            lambda answer: task.share(answer, "lof", 1e-4))


def unique(library, task):
    xyz = xyz_of(task.cloud)
    return lambda: np.unique(xyz, axis=0, return_index=True), lambda answer: task.numbers(len(answer[0]), len(task.output))


def voxel(library, task):
    cloud, size = open3d_cloud(task.cloud), float(re.search(r"voxel\(([0-9.e-]+)", task.pipeline)[1])
    # the other library's grid begins at the corner of the cloud
    return lambda: len(cloud.voxel_down_sample(size).points), lambda n: task.numbers(n, len(task.output), 0.02)


def height(library, task):
    from scipy.spatial import cKDTree
    xyz, ground = xyz_of(task.cloud), task.cloud["classification"] == 2

    def call():
        tree = cKDTree(xyz[ground, :2])
        return xyz[:, 2] - xyz[ground, 2][tree.query(xyz[:, :2], workers=task.threads)[1]]
    return call, lambda answer: task.share(answer, "height", 1e-9, 0.99)


def components(library, task):
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree
    xyz, distance = xyz_of(task.cloud), number(task.pipeline, "distance")

    def call():
        pairs = cKDTree(xyz).query_pairs(distance, output_type="ndarray")
        graph = coo_array((np.ones(len(pairs), np.int8), (pairs[:, 0], pairs[:, 1])), (len(xyz), len(xyz)))
        return connected_components(graph, directed=False)[0]
    return call, lambda n: task.numbers(n, int(task.output["component"].max()) + 1)


def dbscan(library, task):
    from sklearn.cluster import DBSCAN
    xyz = xyz_of(task.cloud)
    return (lambda: DBSCAN(eps=number(task.pipeline, "eps"), min_samples=8, n_jobs=task.threads).fit(xyz).labels_,
            lambda labels: task.numbers(int(np.sum(labels < 0)), int(np.sum(task.output["cluster"] < 0))))


def orient(library, task):
    cloud = open3d_cloud(task.cloud)
    truth = np.column_stack([task.cloud[n] for n in ("nx", "ny", "nz")])
    ours = np.column_stack([task.output[n] for n in ("nx", "ny", "nz")])
    import open3d
    cloud.estimate_normals(open3d.geometry.KDTreeSearchParamKNN(9))

    def call():
        cloud.orient_normals_consistent_tangent_plane(8)
        return np.asarray(cloud.normals)

    def compare(answer):
        right = [float(np.mean(np.sum(n * truth, 1) > 0)) for n in (answer, ours)]
        return right[1] > 0.9, f"{right[0]:.2%} point outwards, of pointsweep's {right[1]:.2%}"
    return call, compare


def distance_to(library, task):
    if library == "open3d":
        cloud, other = open3d_cloud(task.cloud), open3d_cloud(task.other)
        return lambda: np.asarray(cloud.compute_point_cloud_distance(other)), lambda d: task.share(d, "cloud_distance", 1e-9)
    from scipy.spatial import cKDTree
    xyz, there = xyz_of(task.cloud), xyz_of(task.other)
    return (lambda: cKDTree(there).query(xyz, workers=task.threads)[0], lambda d: task.share(d, "cloud_distance", 1e-12))


def m3c2(library, task):
    import py4dgeo
    xyz, there = xyz_of(task.cloud), xyz_of(task.other)
    normals = np.column_stack([task.output[n] for n in ("nx", "ny", "nz")]).astype(float)
    radius, depth = number(task.pipeline, "cylinder") / 2, number(task.pipeline, "depth")
    epochs = py4dgeo.Epoch(xyz), py4dgeo.Epoch(there)
    method = py4dgeo.M3C2(epochs=epochs, corepoints=xyz, corepoint_normals=normals, cyl_radius=radius, max_distance=depth)
    return method.run, lambda answer: task.share(answer[1]["num_samples2"], "m3c2_samples2", 0, 0.99)


def peak():
    with open("/proc/self/status") as file:
        return next(int(line.split()[1]) * 1024 for line in file if line.startswith("VmHWM"))


def main(library, operator, pipeline, cloud, other, output, threads):
    task = Task(pipeline, table_of(cloud), table_of(other), None, int(threads))
    if operator == "m3c2":  # m3c2 gets its normals from the output of pointsweep
        task.output = table_of(output)
    elif operator == "orient":
        task.output = table_of(output)
    call, compare = globals()[operator](library, task)
    cpu, wall = time.process_time(), time.perf_counter()
    answer = call()
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    most = peak()
    if task.output is None:
        task.output = table_of(output)
    agrees, agreement = compare(answer)
    print(json.dumps({"wall_seconds": wall, "cpu_seconds": cpu, "peak_rss_bytes": most, "agrees": bool(agrees), "agreement": agreement}))


if __name__ == "__main__":
    main(*sys.argv[1:])
