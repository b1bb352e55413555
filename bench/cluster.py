# SPDX-License-Identifier: MIT
"""A run over tiles on two workers with one thread each, compared with one process of two threads: CPU, memory, and bytes in the scratch.

With --limited each worker gets a control group whose hard limit is its --memory, for what it allocates after its start and its page cache.

The CPU time of the workers and of the client is that of the run alone, without the start of their processes. The table for 10^11 points multiplies counted bytes."""
import argparse
import filecmp
import os
import pathlib
import resource
import shutil
import sys
import time

import committed
import control_groups
import processes
from processes import ROOT

CHAINS = {"normals": "knn(k=8) | normals", "two steps and a select": "knn(k=8) | normals | curvature | where(nz > 0.2)"}
CLOUDS = {"terrain": [], "tls": [], "statue": ["--outliers", "0.001"]}


def arguments():
    parser = argparse.ArgumentParser(prog="script/bench cluster", description=__doc__.split("\n")[0])
    parser.add_argument("--size", default="1M", help="points of a tile (default 1M)")
    parser.add_argument("--side", type=int, default=4, help="tiles along x and y (default 4)")
    parser.add_argument("--clouds", nargs="+", default=list(CLOUDS), choices=CLOUDS, help="(default all)")
    parser.add_argument("--formats", nargs="+", default=["ply", "laz"], help="of the tiles (default ply laz)")
    parser.add_argument("--many", nargs="*", default=["1k", "10k"], help="numbers of tiles of 2,000 points (default 1k 10k)")
    parser.add_argument("--memory", default="512M", help="budget of each process (default 512M)")
    parser.add_argument("--limited", action="store_true", help="give each worker a hard limit of memory")
    parser.add_argument("--repeat", type=int, default=3, help="timed runs (default 3)")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/bench", help="folder for clouds and outputs")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--save", type=pathlib.Path, help="where the result goes (default bench/results)")
    parser.add_argument("--table", type=pathlib.Path, nargs="+", help="make the tables of docs/performance.md from these results instead")
    return parser.parse_args()


def cpu_seconds():
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def tiles_of(options, shape, points, side, file_format):
    """A folder with side² tiles of a generated cloud, cut at equal distances along x and y."""
    folder = options.work / f"cluster-{shape}-{points}-{side}-{file_format}"
    if folder.exists():
        return folder
    whole = options.work / "cluster-whole.ply"
    tool = options.build / "cli/pointsweep"
    processes.run([tool, "generate", shape, whole, "-n", points, "--seed", 1, "--quiet", "--force", *CLOUDS[shape]])
    import numpy as np

    import pointsweep as ps

    xyz = ps.open(whole).read(keep="xyz")["xyz"]
    folder.mkdir()
    cut = [np.quantile(xyz[:, axis], np.linspace(0, 1, side + 1)[1:-1]) for axis in (0, 1)]
    number = np.searchsorted(cut[0], xyz[:, 0]) * side + np.searchsorted(cut[1], xyz[:, 1])
    rows = np.argsort(number, kind="stable")
    begin = np.searchsorted(number[rows], np.arange(side * side + 1))
    scale = {"scale": 0.00001} if file_format == "laz" else {}
    for tile in range(side * side):
        ps.write(folder / f"{tile:06d}.{file_format}", {"xyz": xyz[rows[begin[tile] : begin[tile + 1]]]}, **scale)
    whole.unlink()
    return folder


def emptied(folder):
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    return f"{folder}/"


def one_process(options, source, chain, to):
    return processes.run([options.build / "cli/pointsweep", "run", source, emptied(to), "--pipeline", chain, "--threads", 2, "--memory", options.memory,
                          "--temp-dir", options.work, "--quiet"])


def many_processes(options, client, source, chain, to):
    import pointsweep as ps

    used = sum(client.run(cpu_seconds).values()) + cpu_seconds()
    start = time.perf_counter()
    report = ps.open(source).run(chain, to=emptied(to), client=client, scratch=options.work / "cluster-scratch", memory=options.memory, temp_folder=options.work)
    wall = time.perf_counter() - start
    used = sum(client.run(cpu_seconds).values()) + cpu_seconds() - used
    found = report.statistics
    return {"cpu_seconds": used, "wall_seconds": wall, "peak_rss_bytes": max(w["peak_rss_bytes"] for w in found["workers"].values()), "tasks": found["tasks"],
            "scratch_bytes": found["bytes"]["scratch"], "swept_over_own": found["points_swept_over_own"], "points": found["points"]}


def compared(options, client, source, chain):
    one, many = options.work / "cluster-one", options.work / "cluster-many"
    runs = {"one process": [], "two workers": []}
    for _ in range(options.repeat):
        runs["one process"].append(one_process(options, source, chain, one))
        runs["two workers"].append(many_processes(options, client, source, chain, many))
    names = sorted(os.listdir(one))
    wrong = [name for name in names if not filecmp.cmp(one / name, many / name, shallow=False)]
    if wrong:
        sys.exit(f"script/bench cluster: {wrong[0]} of {source} differs from that of one process")
    return runs


def tables(result):
    yield "| 16 tiles | chain | CPU: one process, s | two workers, s | ratio | wall, s | peak MB | swept / own | scratch, bytes a point |\n|---|---|---|---|---|---|---|---|---|\n"
    for row in result["rows"]:
        one, many = row["runs"]["one process"], row["runs"]["two workers"]
        cpu = [committed.median(runs, "cpu_seconds") for runs in (one, many)]
        walls = " / ".join(f"{committed.median(runs, 'wall_seconds'):.1f}" for runs in (one, many))
        peaks = " / ".join(f"{max(run['peak_rss_bytes'] for run in runs) / 2**20:.0f}" for runs in (one, many))
        yield (f"| {row['cloud']}, {row['format']} | {row['chain']} | {cpu[0]:.1f} | {cpu[1]:.1f} | {cpu[1] / cpu[0]:.2f} | {walls} | {peaks} |"
               f" {many[0]['swept_over_own']:.3f} | {many[0]['scratch_bytes'] / many[0]['points']:.0f} |\n")
    if result["many"]:
        yield "\n| tiles of 2,000 points | wall a tile, ms | CPU a tile, ms | catalogue, s |\n|---|---|---|---|\n"
        for row in result["many"]:
            yield f"| {row['tiles']:,} | {1000 * row['wall_seconds'] / row['tiles']:.1f} | {1000 * row['cpu_seconds'] / row['tiles']:.1f} | {row['catalogue_seconds']:.1f} |\n"
    yield "\n| 10^11 points in 10,000 tiles, normals | bytes |\n|---|---|\n"
    row = next(row for row in result["rows"] if row["format"] == "ply" and row["chain"] == "normals")
    run = row["runs"]["two workers"][0]
    each = run["scratch_bytes"] / run["points"]
    yield f"| written to the scratch | {each * 1e11 / 1e12:.1f} TB |\n| read from the scratch | {each * run['swept_over_own'] * 1e11 / 1e12:.1f} TB |\n"
    yield f"| through the scheduler, two tasks a tile of at most 1 kB | {2 * 10_000 * 1000 / 1e6:.0f} MB |\n"


def main():
    options = arguments()
    if options.table:
        text = "".join(f"{committed.where(result)}, `--memory {result['memory']}`, {committed.names([path])}.\n\n{''.join(tables(result))}\n"
                       for result, path in zip(committed.read(options.table), options.table))
        return committed.write_table("cluster", text)
    from dask import config
    from distributed import Client, LocalCluster

    import pointsweep as ps
    from pointsweep._options import bytes_of

    options.work.mkdir(parents=True, exist_ok=True)
    options.work = options.work.resolve()
    result = committed.begun(memory=options.memory, limited=options.limited, rows=[], many=[])
    limit = bytes_of(options.memory) if options.limited else None
    # The contexts of the groups come first, because a group can be removed only when its worker has ended.
    with (
        control_groups.limited(limit, "-0") as first,
        control_groups.limited(limit, "-1") as second,
        config.set({"distributed.worker.profile.enabled": False}),
        LocalCluster(n_workers=2, threads_per_worker=1, memory_limit=None, dashboard_address=":0") as cluster,
        Client(cluster) as client,
    ):
        for enter, pid in zip((first, second), client.run(os.getpid).values()):
            if enter:
                enter(pid)
            elif options.limited:
                sys.exit("script/bench cluster: --limited needs control groups of memory, which this machine does not let make")
        for shape in options.clouds:
            for file_format in options.formats:
                source = tiles_of(options, shape, processes.points(options.size) * options.side**2, options.side, file_format)
                for name, chain in CHAINS.items():
                    result["rows"].append({"cloud": shape, "format": file_format, "chain": name, "runs": compared(options, client, source, chain)})
                    print(shape, file_format, name, flush=True)
        for number in options.many:
            side = round(processes.points(number) ** 0.5)
            source = tiles_of(options, "terrain", 2000 * side**2, side, "ply")
            start = time.perf_counter()
            ps.open(source)
            opened = time.perf_counter() - start
            run = many_processes(options, client, source, "knn(k=8) | normals", options.work / "cluster-many")
            result["many"].append({"tiles": side**2, "catalogue_seconds": opened, **run})
            print(result["many"][-1], flush=True)
    committed.write(committed.file_of(result, "cluster", options.save), result)
    sys.stdout.writelines(tables(result))


if __name__ == "__main__":
    main()
