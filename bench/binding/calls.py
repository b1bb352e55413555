# SPDX-License-Identifier: MIT
"""calls.py normals|neighbors XYZ.f64 OUT K THREADS: the call of array_calls.cpp from Python.
calls.py package|laspy CLOUD OUT K THREADS: positions and normals of a file as arrays, computed by the package, or read with
laspy where the file has them."""
import json
import resource
import sys
import time


def normals(source, k, threads):
    import numpy as np
    import pointsweep as ps

    xyz = np.fromfile(source).reshape(-1, 3)
    ps.normals(xyz[:100], k=k)  # imports are not timed
    return timed(lambda: ps.normals(xyz, k=k, threads=threads))


def neighbors(source, k, threads):
    import numpy as np
    import pointsweep as ps

    xyz = np.fromfile(source).reshape(-1, 3)
    ps.neighbors(xyz[:100], k=k)
    return timed(lambda: ps.neighbors(xyz, k=k, threads=threads)).distances


def package(source, k, threads):
    import pointsweep as ps

    t = ps.run(source, ps.knn(k) | ps.normals(), keep=["xyz", "normal"], threads=threads)
    return t["normal"]


def laspy(source, k, threads):
    import laspy
    import numpy as np

    las = laspy.read(source)
    las.xyz  # laspy makes arrays only on access
    return np.column_stack([las.NormalX, las.NormalY, las.NormalZ]).astype("f4")


def timed(call):
    before, wall = resource.getrusage(resource.RUSAGE_SELF), time.perf_counter()
    answer = call()
    wall, after = time.perf_counter() - wall, resource.getrusage(resource.RUSAGE_SELF)
    user, system = after.ru_utime - before.ru_utime, after.ru_stime - before.ru_stime
    print(json.dumps({"wall_seconds": wall, "user_seconds": user, "cpu_seconds": user + system}))
    return answer


def main(task, source, target, k, threads):
    answer = globals()[task](source, int(k), int(threads))
    if target:
        answer.tofile(target)


main(*sys.argv[1:])
