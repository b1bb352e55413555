# SPDX-License-Identifier: MIT
"""Writes the table of README.md from committed results: bench/readme.py RESULT.json..."""
import json
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BEGIN, END = "<!-- numbers: made by bench/readme.py from a committed result -->\n", "<!-- end of numbers -->"


def table(results):
    first = results[0]
    counts = [len(row['runs']) for result in results for row in result['rows']]
    runs = "single runs" if max(counts) == 1 else f"medians of {'' if min(counts) == max(counts) else 'up to '}{max(counts)} runs"
    yield (f"Normals, k = 8, whole processes from file to file, points in random file order, {first['threads']} threads, {runs}; "
           f"{first['machine']['cpu']}, {first['machine']['cpus']} cores, {first['compiler'].split(') ')[-1]}, commit {first['commit']}, {first['date']}. "
           "Answers compared before times count.\n\n")
    small = next(r["program"] for r in first["rows"] if r["program"].startswith("pointsweep --memory"))
    yield (f"| cloud | wall s | CPU s | peak MB | `{small.removeprefix('pointsweep ')}`: CPU s | peak MB | nanoflann, points permuted: CPU | "
           "nanoflann, file order: CPU |\n|---|---|---|---|---|---|---|---|\n")
    for result in results:
        clouds = {}
        for row in result["rows"]:
            if (row.get("order", "random"), row.get("format", "ply"), row.get("k", 8)) != ("random", "ply", 8):
                continue
            clouds.setdefault(f"{row['shape']} {row['points'] / 1e6:g}M", {})[row["program"]] = row["median"]
        for cloud, programs in clouds.items():
            ours, in_little = programs["pointsweep"], programs[small]
            times = [f"{programs[name]['cpu_seconds'] / ours['cpu_seconds']:.1f} times" for name in ("nanoflann permuted", "nanoflann")]
            yield (f"| {cloud} | {ours['wall_seconds']:.2f} | {ours['cpu_seconds']:.2f} | {ours['peak_rss_bytes'] / 1e6:.0f} | "
                   f"{in_little['cpu_seconds']:.2f} | {in_little['peak_rss_bytes'] / 1e6:.0f} | {' | '.join(times)} |\n")
    yield f"\nMade by `script/bench`; runs in {', '.join(f'`{name}`' for name in sys.argv[1:])}.\n"


def main():
    results = [json.loads((ROOT / name).read_text()) for name in sys.argv[1:]]
    readme = ROOT / "README.md"
    head, rest = readme.read_text().split(BEGIN)
    readme.write_text(head + BEGIN + "".join(table(results)) + END + rest.split(END)[1])


if __name__ == "__main__":
    main()
