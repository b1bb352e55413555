# SPDX-License-Identifier: MIT
"""One contender, one task, one cloud, in a separate process: contenders.py NAME TASK XYZ.npy OUT.npy THREADS.

Prints wall and CPU seconds of the call, and by how much the process grew at its peak, as JSON; writes the answer. Arrays
have the type that the contender documents before the call is timed, and it uses all cores as it documents."""
import json
import os
import resource
import sys
import time

import numpy as np

K = 16


def pointsweep(task, xyz, threads):
    import pointsweep as ps

    if task == "neighbors":
        return lambda: ps.neighbors(xyz, k=K, threads=threads).distances
    if task == "normals":
        return lambda: ps.normals(xyz, k=K, threads=threads)
    if task == "operator":
        return lambda: ps.run(xyz, ps.knn(K) | ps.normals() | roughness(ps), threads=threads)["roughness"]
    names = ["linearity", "planarity", "sphericity"]
    if task == "features":
        pipeline = ps.knn(K) | ps.features(names, eigenvalues="sqrt")
    else:
        pipeline = ps.knn(radius=radius_of(xyz)) | ps.features(names)
    return lambda: columns(ps.run(xyz, pipeline, threads=threads))


def radius_of(xyz):
    """Returns a radius within which half of all points have at least K neighbours."""
    import pointsweep as ps

    return float(np.median(ps.neighbors(xyz, k=K).distances[:, -1]))


def columns(t):
    return np.column_stack([t["linearity"], t["planarity"], t["sphericity"]])


def roughness(ps):
    @ps.operator(reads=["normal"], makes={"roughness": "f4"})
    def made(p):
        d = p.neighbors_xyz - p.xyz[:, None]
        return np.abs(np.einsum("nkj,nj->nk", d, p.normal)).mean(1)

    return made


def numpy_in_memory(task, xyz, threads):
    """Computes with the same NumPy code on arrays of all neighbourhoods, which pointsweep finds; only for the task 'operator'."""
    import pointsweep as ps

    if task != "operator":
        return None
    xyz = xyz.astype(float)
    indices, normal = ps.neighbors(xyz, k=K, threads=threads).indices, ps.normals(xyz, k=K, threads=threads)

    def call():
        d = xyz[indices] - xyz[:, None]
        return np.abs(np.einsum("nkj,nj->nk", d, normal)).mean(1).astype("f4")

    return call


def scipy_ckdtree(task, xyz, threads):
    from scipy.spatial import cKDTree

    xyz = xyz.astype(float)
    return (lambda: cKDTree(xyz).query(xyz, K + 1, workers=threads)[0][:, 1:]) if task == "neighbors" else None


def scikit_learn(task, xyz, threads):
    from sklearn.neighbors import NearestNeighbors

    xyz = xyz.astype(float)
    search = NearestNeighbors(n_neighbors=K, algorithm="kd_tree", n_jobs=threads)
    return (lambda: search.fit(xyz).kneighbors()[0]) if task == "neighbors" else None


def pynanoflann(task, xyz, threads):
    from pynanoflann import KDTree

    def call():
        tree = KDTree(n_neighbors=K + 1)
        tree.fit(xyz)
        return tree.kneighbors(xyz, n_jobs=threads)[0][:, 1:]

    return call if task == "neighbors" else None


def pgeof(task, xyz, threads):
    import pgeof

    xyz = np.ascontiguousarray(xyz, np.float32)
    if task == "neighbors":
        return lambda: np.sqrt(pgeof.knn_search(xyz, xyz, K + 1)[1][:, 1:])

    def call():
        rows, _ = pgeof.knn_search(xyz, xyz, K + 1)
        starts = np.arange(0, len(xyz) * (K + 1) + 1, K + 1, dtype=np.uint32)
        made = pgeof.compute_features(xyz, rows.ravel(), starts)
        return made[:, 4:7] if task == "normals" else made[:, :3]

    return call if task in ("normals", "features") else None


def jakteristics(task, xyz, threads):
    from jakteristics import compute_features

    names = ["linearity", "planarity", "sphericity"]
    radius, xyz = radius_of(xyz), np.ascontiguousarray(xyz, float)
    return (lambda: compute_features(xyz, radius, num_threads=threads, feature_names=names)) if task == "features_in_radius" else None


def open3d(task, xyz, threads):
    import open3d as o3d

    if task == "normals":
        cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(xyz.astype(float)))

        def normals():
            cloud.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(K + 1))
            return np.asarray(cloud.normals)

        return normals
    if task != "neighbors":
        return None
    points = o3d.core.Tensor(np.ascontiguousarray(xyz, float))

    def neighbors():
        search = o3d.core.nns.NearestNeighborSearch(points)
        search.knn_index()
        return np.sqrt(search.knn_search(points, K + 1)[1].numpy()[:, 1:])

    return neighbors


def status(name):
    with open("/proc/self/status") as file:
        return next(int(line.split()[1]) * 1024 for line in file if line.startswith(name))


def main(name, task, source, target, threads):
    xyz = np.load(source)
    call = globals()[name](task, xyz, int(threads))
    if call is None:
        return print("null")
    with open("/proc/self/clear_refs", "w") as file:
        file.write("5")  # resets the peak of resident memory
    held, cpu, wall = status("VmRSS"), time.process_time(), time.perf_counter()
    answer = call()
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu += children.ru_utime + children.ru_stime
    np.save(target, answer)
    print(json.dumps({"wall_seconds": wall, "cpu_seconds": cpu, "peak_bytes": status("VmHWM") - held}))


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", sys.argv[5])
    main(*sys.argv[1:])
