# SPDX-License-Identifier: MIT
"""Folders of many small tiles. The CPU time per tile, as inputs of one output and as outputs in a folder, must be the same for 100 tiles as
for 10,000."""
import json
import resource
import shutil
import struct
import subprocess
import sys

MOST = 1.5  # largest CPU time per tile, in multiples of the smallest
COUNTS = (100, 1000, 10000)
POINTS = 20


def make_tiles(folder, count):
    """Writes tiles of 1 x 1, 100 in a row."""
    folder.mkdir(parents=True)
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {POINTS}\n" + "".join(f"property float {axis}\n" for axis in "xyz") + "end_header\n"
    for tile in range(count):
        places = ((tile % 100 + point * 0.618 % 1, tile // 100 + point * 0.414 % 1, point * 0.732 % 1) for point in range(POINTS))
        (folder / f"{tile:05}.ply").write_bytes(head.encode() + b"".join(struct.pack("<3f", *place) for place in places))


def cpu_seconds(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([str(word) for word in command], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main(bench):
    # No file is removed or replaced before the end, because some file systems are slower for a while after files were removed.
    whole, rows = bench.options.work / "many-tiles", []
    shutil.rmtree(whole, ignore_errors=True)
    for count in COUNTS:
        work = whole / str(count)
        make_tiles(work / "in", count)
        times = max(1, 1000 // count)  # short runs are repeated, so that their CPU time can be measured
        row = {"tiles": count}
        for kind, ending in (("inputs", ".ply"), ("outputs", "/")):
            used = 0
            for run in range(times):
                output = f"{work}/out{run}{ending}"
                used += cpu_seconds([bench.tool, "normals", work / "in", output, "--quiet", "--memory", "256M", "--threads", 2, "--temp-dir", work])
            row[kind] = used / times / count
        rows.append(row)
        print(f"{count:>6} tiles: {1e3 * row['inputs']:.3f} ms of CPU for each as an input, {1e3 * row['outputs']:.3f} ms as an output, too", flush=True)
    shutil.rmtree(whole)
    if bench.options.output:
        bench.options.output.write_text(json.dumps(rows, indent=1) + "\n")
    for kind in ("inputs", "outputs"):
        if rows[-1][kind] > MOST * min(row[kind] for row in rows):
            sys.exit(f"script/hostile: the time for a tile among {COUNTS[-1]} {kind} is more than {MOST} times that among fewer")
