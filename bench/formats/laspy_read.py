# SPDX-License-Identifier: MIT
"""laspy_read.py IN: reads all points of a LAS or LAZ file with laspy, with lazrs on all cores. Prints the number of points,
the times without the start of Python, and the bounds, which are not part of the times, as JSON.
laspy_read.py A B: fails unless both files have the same records."""
import json
import sys
import time

import laspy
import numpy as np


def read(path):
    return laspy.read(path, laz_backend=laspy.LazBackend.LazrsParallel)


def main():
    if len(sys.argv) == 3:
        a, b = (read(path).points.array for path in sys.argv[1:])
        if a.dtype != b.dtype or a.tobytes() != b.tobytes():
            sys.exit(f"{sys.argv[1]} and {sys.argv[2]} have other records")
        return
    begin = time.monotonic(), time.process_time()
    las = read(sys.argv[1])
    took = time.monotonic() - begin[0], time.process_time() - begin[1]
    axes = [np.asarray(las[axis].scaled_array()) for axis in "xyz"]
    bounds = [axis.min() for axis in axes] + [axis.max() for axis in axes]
    print(json.dumps({"points": len(las.points), "wall_seconds": took[0], "cpu_seconds": took[1], "bounds": bounds}))


if __name__ == "__main__":
    main()
