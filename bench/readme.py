# SPDX-License-Identifier: MIT
"""Writes tables from committed results: bench/readme.py RESULT.json...

Results of script/compare make the comparison with other programs in docs/performance.md. All others make the table against
nanoflann there, of all clouds, and that of README.md, of the largest clouds. A table that no result is named for stays."""
import json
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
NOTE = ": made by bench/readme.py from a committed result -->\n"


def of_machine(first):
    return (f"{first['machine']['cpu']}, {first['machine']['cpus']} cores, {first['compiler'].split(') ')[-1]}, commit {first['commit']}, "
            f"{first['date']}.")


def times(number, base):
    return f"{number / base:.1f} times"


def comparison(results, names):
    """Returns one row for each cloud and tool: time, CPU and memory relative to pointsweep with the same neighbourhoods."""
    first = results[0]
    most = max(len(row["runs"]) for result in results for row in result["rows"])
    k = sorted({row["k"] for result in results for row in result["rows"]})
    yield (f"Normals from {' and '.join(map(str, k))} neighbours, from file to file, {'single runs' if most == 1 else f'medians of {most} runs'}; "
           f"{of_machine(first)} Angle: median to the true normals.\n\n"
           "| cloud | program | wall s | CPU s | peak MB | angle | CPU over pointsweep | memory over pointsweep |\n|---|---|---|---|---|---|---|---|\n")
    for result in results:
        ours = {}
        for row in result["rows"]:
            cloud = f"{row['shape']} {row['points'] / 1e6:g}M"
            median, key = row["median"], (cloud, row["radius"] is not None)
            if row["program"] in ("pointsweep", "pointsweep --radius"):
                ours[key] = median
            over = [times(median[figure], ours[key][figure]) if "pointsweep" not in row["program"] else "" for figure in ("cpu_seconds", "peak_rss_bytes")]
            program = f"`{row['program']}`" if "--" in row["program"] else f"{row['program']} {row['version']}".strip()
            yield (f"| {cloud} | {program} | {median['wall_seconds']:.1f} | {median['cpu_seconds']:.1f} | {median['peak_rss_bytes'] / 1e6:.0f} | "
                   f"{row['angle_degrees']['median']:.2f}° | {over[0]} | {over[1]} |\n")
    left_out = sorted({name for result in results for name, reason in result["left_out"].items() if reason == "not installed"})
    yield ("\nThe others use all neighbours alike, pointsweep weights them by distance. CloudCompare takes a radius, so it stands against `--radius` with the "
           "same radius; the time of Open3D includes starting Python.")
    if left_out:
        yield f" Not measured, because it could not be installed: {', '.join(left_out)}."
    yield f" Made by `script/compare`; runs in {', '.join(f'`{name}`' for name in names)}.\n"


def caption(results):
    first = results[0]
    counts = [len(row["runs"]) for result in results for row in result["rows"]]
    runs = "single runs" if max(counts) == 1 else f"medians of {'' if min(counts) == max(counts) else 'up to '}{max(counts)} runs"
    return (f"Normals, k = 8, whole processes from file to file, points in random file order, {first['threads']} threads, {runs};\n"
            f"{of_machine(first)} Answers are compared before times count.\n\n")


def table(results, names, smallest=0):
    """Returns one row for each cloud of at least `smallest` points."""
    program = next(r["program"] for r in results[0]["rows"] if r["program"].startswith("pointsweep --memory"))
    little = f"`{program.removeprefix('pointsweep ')}`"
    yield (f"| cloud | wall s | CPU s | peak MB | {little}: CPU s | peak MB | nanoflann, points permuted: CPU | in file order |\n"
           "|---|---|---|---|---|---|---|---|\n")
    clouds = {}
    for result in results:
        for row in result["rows"]:
            if (row.get("order", "random"), row.get("format", "ply"), row.get("k", 8)) == ("random", "ply", 8) and row["points"] >= smallest:
                clouds.setdefault(f"{row['shape']} {row['points'] / 1e6:g}M", {})[row["program"]] = row["median"]
    for cloud, programs in clouds.items():
        ours, in_little = programs["pointsweep"], programs[program]
        over = [times(programs[name]["cpu_seconds"], ours["cpu_seconds"]) for name in ("nanoflann permuted", "nanoflann")]
        yield (f"| {cloud} | {ours['wall_seconds']:.2f} | {ours['cpu_seconds']:.2f} | {ours['peak_rss_bytes'] / 1e6:.0f} | "
               f"{in_little['cpu_seconds']:.2f} | {in_little['peak_rss_bytes'] / 1e6:.0f} | {' | '.join(over)} |\n")
    yield f"\nMade by `script/bench`; runs in {', '.join(f'`{name}`' for name in names)}.\n"


def replace(path, section, lines):
    page = ROOT / path
    begin, end = f"<!-- {section}{NOTE}", f"<!-- end of {section} -->"
    head, rest = page.read_text().split(begin)
    page.write_text(head + begin + "".join(lines) + end + rest.split(end)[1])


def main():
    results = {name: json.loads((ROOT / name).read_text()) for name in sys.argv[1:]}
    compared = [name for name, result in results.items() if result.get("kind") == "compare"]
    benched = [name for name in results if name not in compared]
    if compared:
        replace("docs/performance.md", "comparison", comparison([results[name] for name in compared], compared))
    if benched:
        of = [results[name] for name in benched]
        largest = max(row["points"] for result in of for row in result["rows"])
        with_largest = [name for name in benched if any(row["points"] == largest for row in results[name]["rows"])]
        replace("docs/performance.md", "numbers", [caption(of), *table(of, benched)])
        replace("README.md", "numbers", [caption([results[name] for name in with_largest]), *table(of, with_largest, largest)])


if __name__ == "__main__":
    main()
