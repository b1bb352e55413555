# SPDX-License-Identifier: MIT
"""The cost per point for growing clouds with the same memory: normals (k = 8) of clouds with and without noise and outliers.

Each run is in a control group with a hard limit of memory, page cache included, so that points that were spilled are read from
the disk again. Compared are CPU seconds and bytes read a point with those of the smallest cloud, the share of the recall in the
time, and the peak of resident memory with the budget."""
import argparse
import json
import pathlib

import control_groups
import processes
from processes import ROOT

CLOUDS = {
    "statue": ["statue"],
    "statue with noise": ["statue", "--noise", "0.0005"],
    "statue with outliers": ["statue", "--outliers", "0.001"],
    "terrain": ["terrain"],
    "tls": ["tls"],
}


def arguments():
    parser = argparse.ArgumentParser(prog="script/bench scale", description=__doc__.split("\n")[0])
    parser.add_argument("--clouds", nargs="+", default=list(CLOUDS), choices=CLOUDS)
    parser.add_argument("--sizes", nargs="+", default=["5M", "20M"], help="100M takes 1.2 GB for the cloud and as much again for the output")
    parser.add_argument("--memory", default="64M", help="the budget of the run")
    parser.add_argument("--limit", default="128M", help="the limit of the control group")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/bench")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--output", type=pathlib.Path, help="where to write the numbers as JSON")
    return parser.parse_args()


def size_of(text):
    return int(text[:-1]) << {"M": 20, "G": 30}[text[-1]]


def measure(options, name, size):
    cloud, output, stats = (options.work / f"scale{end}" for end in ("-in.ply", "-out.ply", ".json"))
    tool = options.build / "cli/pointsweep"
    shape, *more = CLOUDS[name]
    processes.run([tool, "generate", shape, cloud, "-n", size, *more, "--quiet", "--force"])
    words = ["normals", cloud, output, "-k", 8, "--keep", "nx,ny,nz", "--memory", options.memory, "--temp-dir", options.work, "--stats", stats]
    try:
        with control_groups.limited(size_of(options.limit)) as enter:
            figures = processes.run([tool, *words, "--quiet", "--force"], before=enter)
        said = json.loads(stats.read_text())
    finally:
        for file in (cloud, output, stats):
            file.unlink(missing_ok=True)
    return {"cloud": name, "points": processes.points(size), "limited": enter is not None, **figures, "recalled": said["recalled"],
            "recall_seconds": said["seconds"]["recall"], "total_seconds": said["seconds"]["total"], "bytes": said["bytes"]}


def main():
    options = arguments()
    options.work.mkdir(parents=True, exist_ok=True)
    options.work, rows = options.work.resolve(), []
    print(f"{'cloud':<22}{'points':>8}{'wall s':>9}{'CPU us':>8}{'over first':>11}{'read B':>8}{'over first':>11}{'disk B':>8}{'recalled':>10}{'share':>7}{'MiB':>6}   (us and B a point)")
    for name in options.clouds:
        first = None
        for size in options.sizes:
            row = measure(options, name, size)
            first = first or row
            cost = {key: row[key] / row["points"] for key in ("cpu_seconds", "read_bytes", "disk_read_bytes")}
            over = {key: cost[key] / (first[key] / first["points"]) for key in ("cpu_seconds", "read_bytes")}
            print(f"{name:<22}{row['points'] / 1e6:>7g}M{row['wall_seconds']:>9.1f}{cost['cpu_seconds'] * 1e6:>8.2f}{over['cpu_seconds']:>11.2f}"
                  f"{cost['read_bytes']:>8.0f}{over['read_bytes']:>11.2f}{cost['disk_read_bytes']:>8.0f}{row['recalled']:>10}"
                  f"{row['recall_seconds'] / row['total_seconds']:>7.1%}{row['peak_rss_bytes'] / 2**20:>6.0f}", flush=True)
            rows.append(row)
    if options.output:
        options.output.write_text(json.dumps({"commit": processes.commit(), "machine": processes.machine(), "memory": options.memory,
                                              "limit": options.limit, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
